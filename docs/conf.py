"""Sphinx configuration: Markdown pages, a notebook and recipes that run, public names from docstrings."""

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import matplotlib as mpl
from sphinx.application import Sphinx
from sphinx_gallery.sorting import FileNameSortKey

import seatrial

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))
from examples_of_names import examples_of_names  # noqa: E402  # a module next to the pages

os.environ["MATPLOTLIBRC"] = str(DOCS / "matplotlibrc")  # the notebook's kernel draws as the pictures are drawn

project = "seatrial"
author = "the seatrial developers"
release = version = seatrial.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "myst_nb",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
templates_path = ["templates"]
exclude_patterns = [
    "templates",
    "name_examples",
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
def package_colours(_gallery: object, _script: str) -> None:
    """Give a recipe's figures the colours of the documentation, which are read on light and dark pages."""
    mpl.rcParams.update(mpl.rc_params_from_file(DOCS / "matplotlibrc", use_default_template=False))


sphinx_gallery_conf = {
    "reset_modules": ("matplotlib", package_colours),
    "examples_dirs": "recipes",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": FileNameSortKey,
    "abort_on_example_error": True,
    "download_all_examples": False,
    "default_thumb_file": str(DOCS / "pictures" / "bad_fit.svg"),  # of a recipe without a figure
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

EXAMPLES = examples_of_names()
PUBLIC = {name: getattr(seatrial, name) for name in seatrial.__all__}
ALIASES = {
    name: f"{value.__module__}.{value.__name__}"
    for name, value in PUBLIC.items()
    if isinstance(value, type) and value.__name__ != name
}
"""Classes that have another name where they are written."""
SHORT_NAMES = {value.__name__: name for name, value in PUBLIC.items() if isinstance(value, ModuleType)}
SHORT_NAMES |= {written: name for name, written in ALIASES.items()}
autosummary_context = {"aliases": ALIASES}


def add_example(_app: Sphinx, kind: str, name: str, value: object, _options: object, lines: list[str]) -> None:
    """Append the example of a public name, and the names that a subpackage offers, to its description."""
    if kind == "module":
        offered = ", ".join(f"``{item}``" for item in getattr(value, "__all__", ()))
        lines += ["", f"As ``st.{SHORT_NAMES.get(name, name)}`` it offers {offered}.", ""] if offered else [""]
    short = SHORT_NAMES.get(name, name.removeprefix("seatrial."))
    if short in EXAMPLES:
        lines += ["", ".. rubric:: Example", "", ".. code-block:: pycon", ""]
        lines += [f"   {line}" for line in EXAMPLES[short].splitlines()] + [""]


def without_schema(
    _app: Sphinx, _kind: str, _name: str, _value: object, _options: object, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Leave out the signature of a result: nobody makes one by hand, and its fields are on the page of keys."""
    return ("", returned) if signature and "FieldInfo" in signature else (signature, returned)


def write_example_report(app: Sphinx, problem: Exception | None) -> None:
    """Write the report that the home page links to, by the command that the home page shows."""
    folder = Path(app.outdir) / "demo"
    if problem is None and app.builder.format == "html" and not (folder / "report.html").exists():
        command = [sys.executable, "-m", "seatrial", "demo", "--out", str(folder), "--quiet"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def setup(app: Sphinx) -> None:
    """Connect what this configuration adds to a build."""
    app.connect("autodoc-process-docstring", add_example)
    app.connect("autodoc-process-signature", without_schema)
    app.connect("build-finished", write_example_report)


html_theme = "pydata_sphinx_theme"
html_title = "seatrial"
html_show_sourcelink = False
# a page without pages below it needs no navigation at its side
html_sidebars = {"ten-minutes": [], "install": []}
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
