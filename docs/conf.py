"""Sphinx configuration: Markdown pages, one executed notebook, the public names from their docstrings."""

from importlib.metadata import version as installed_version

project = "seatrial"
author = "the seatrial developers"
release = version = installed_version("seatrial")

extensions = ["sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon", "myst_nb"]
exclude_patterns = ["pictures"]

# pages: MyST Markdown; headings down to this level can be linked to
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]

# the notebook is executed at every build; an error in it fails the build
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 180  # s for one cell; ours, some twenty times what the slowest takes
nb_merge_streams = True

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
html_theme_options = {
    "github_url": "https://github.com/seatrial/seatrial",
    "show_prev_next": False,
    "navigation_with_keys": False,
    "show_toc_level": 2,
}
