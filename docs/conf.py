"""Sphinx configuration: Markdown pages, a notebook and recipes that run, public names from docstrings."""

from importlib.metadata import version as installed_version

from sphinx_gallery.sorting import FileNameSortKey

project = "seatrial"
author = "the seatrial developers"
release = version = installed_version("seatrial")

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "myst_nb",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "pictures",
    "static",
    "recipes",
    "gallery/*.ipynb",
    "gallery/*.py",
    "gallery/*.md5",
    "gallery/*.json",
]
suppress_warnings = ["config.cache"]  # the sorting of recipes is a class, which no cache of the configuration can hold

# pages: MyST Markdown; headings down to this level can be linked to
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "dollarmath"]

# the notebook is executed at every build; an error in it fails the build
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 180  # s for one cell; ours, some twenty times what the slowest takes
nb_merge_streams = True

# recipes: every script is executed, an error in one fails the build; `-D plot_gallery=0` leaves them unexecuted
sphinx_gallery_conf = {
    "examples_dirs": "recipes",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": FileNameSortKey,
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "min_reported_time": 15,  # s; what a recipe may take, and so a longer one is named
    "run_stale_examples": True,
    "remove_config_comments": True,
}

# a copied command is without its prompt and without what it printed
copybutton_prompt_text = "$ "

# public names: Google-style docstrings, signatures as they are written
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "show-inheritance": False}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True

html_theme = "pydata_sphinx_theme"
html_title = "seatrial"
html_show_sourcelink = False
# a page without pages below it needs no navigation at its side
html_sidebars = {"ten-minutes": []}
html_static_path = ["static"]
html_css_files = ["pages.css"]
# a browser that reads the pages from disk may not fetch them for excerpts; titles and links are found without
html_show_search_summary = False
html_context = {"default_mode": "auto"}  # light or dark as the reader's screen is; without it the theme complains
html_theme_options = {
    "github_url": "https://github.com/seatrial/seatrial",
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "navbar_persistent": ["search-button"],
    "show_prev_next": False,
    "navigation_with_keys": False,
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
}
