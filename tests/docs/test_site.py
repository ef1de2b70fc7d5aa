"""The site builds without a warning: no dead link, no page outside the contents, no error in the notebook."""

import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

import seatrial

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

# whether the page is wider than the window, or a table sticks out of it that nothing around it lets scroll
OVERFLOWS = """() => {
  const width = document.documentElement.clientWidth;
  const scrolls = (e) => e && (["auto", "scroll"].includes(getComputedStyle(e).overflowX) || scrolls(e.parentElement));
  const cut = (t) => t.getBoundingClientRect().right > width + 1 && !scrolls(t.parentElement);
  return document.documentElement.scrollWidth > width || [...document.querySelectorAll("table")].some(cut);
}"""


@pytest.fixture(scope="module", params=[pytest.param("built", marks=pytest.mark.long)])
def site(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site."""
    pytest.importorskip("myst_nb", reason="needs the extra 'dev'")
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "--keep-going",
        "-q",
        "-D",
        "plot_gallery=0",  # `make docs` runs the recipes
        "-d",
        str(folder / "cache"),
        "docs",
        str(folder),
    ]
    run = subprocess.run(command, cwd=repository, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return folder


def test_the_notebook_shows_its_results(site: Path) -> None:
    page = (site / "notebooks" / "first_fit.html").read_text(encoding="utf-8")
    assert "Fit of model waterjet" in page and "True simulated" in page
    assert len(set(re.findall(r'<img [^>]*src="(\.\./_images/[^"]+)"', page))) == 3


def test_every_public_name_has_a_page_with_an_example(site: Path) -> None:
    pages = {name: getattr(seatrial, name) for name in seatrial.__all__}
    for name, value in pages.items():
        address = value.__name__ if isinstance(value, ModuleType) else f"seatrial.{name}"
        page = (site / "api" / f"{address}.html").read_text(encoding="utf-8")
        assert "Example" in page and "&gt;&gt;&gt;" in page, name


def test_the_home_page_leads_to_a_report_with_sliders(site: Path) -> None:
    home, report = ((site / name).read_text(encoding="utf-8") for name in ("index.html", "demo/report.html"))
    assert "demo/report.html#slide-1" in home and 'id="slide-1"' in report


@pytest.fixture(scope="module")
def phone(browser: "Browser") -> "Page":
    """A window as wide as a phone's, 390 pixels."""
    return browser.new_page(viewport={"width": 390, "height": 844})


def test_the_search_answers_from_disk(site: Path, phone: "Page") -> None:
    phone.goto(f"{(site / 'search.html').as_uri()}?q=jackknife")
    phone.wait_for_selector("#search-results ul.search li a", timeout=20_000)  # ms
    phone.wait_for_function("document.body.innerText.includes('Search finished')", timeout=20_000)  # ms
    assert "Intervals" in phone.inner_text("#search-results")


def test_no_page_and_no_table_is_cut_on_a_phone(site: Path, phone: "Page") -> None:
    cut = []
    for path in sorted(site.rglob("*.html")):
        phone.goto(path.as_uri(), wait_until="domcontentloaded")
        if phone.evaluate(OVERFLOWS):
            cut.append(path.relative_to(site).as_posix())
    assert cut == []
