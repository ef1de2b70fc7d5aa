"""A real browser opens the pages, clicks through them and has nothing to complain about."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from tests.reporting.fabricated_tuning import fabricated_fin

from seatrial.core.results import Study
from seatrial.reporting.tuning import html

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed; pip install playwright")
QUIET = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip


@pytest.fixture(scope="module")
def browser(browser_path: str) -> "Iterator[Browser]":
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=browser_path, args=QUIET)
        yield opened
        opened.close()


def opened(browser: "Browser", path: Path, width: int = 1100) -> "tuple[Page, list[str]]":
    """The page in a window, and what its console and network had to say."""
    page = browser.new_page(viewport={"width": width, "height": 900}, reduced_motion="reduce")
    said: list[str] = []
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: said.append(request.url) if request.url.startswith("http") else None)
    page.goto(path.as_uri())
    return page, said


def test_contents_lead_to_their_sections(browser: "Browser", page: Path) -> None:
    window, said = opened(browser, page)
    links = window.locator("nav.contents a")
    for k in range(links.count()):
        links.nth(k).click()
        target = window.locator((links.nth(k).get_attribute("href") or "") + ":visible")
        assert target.count() == 1
    assert links.count() >= 8
    assert said == []


def test_folds_open_and_show_their_figures(browser: "Browser", page: Path) -> None:
    window, said = opened(browser, page)
    closed = window.locator("details:not([open]) > summary:visible")
    before = closed.count()
    assert before > 0
    closed.first.click()
    assert closed.count() == before - 1
    window.locator("#unfold").click()
    assert window.locator("details:not([open])").count() == 0
    assert window.locator("figure > svg:visible").count() == window.locator("figure > svg").count()
    window.locator("#unfold").click()
    assert window.locator("details[open]").count() == 0
    assert said == []


def test_formulas_are_drawn_and_nothing_is_wider_than_the_window(browser: "Browser", page: Path) -> None:
    window, _ = opened(browser, page)
    box = window.locator("math").first.bounding_box()
    assert box is not None and box["height"] > 8
    for width in (1100, 1400, 420):
        window.set_viewport_size({"width": width, "height": 800})
        assert window.evaluate("document.documentElement.scrollWidth") <= width


def test_printing_unfolds_everything(browser: "Browser", page: Path) -> None:
    window, _ = opened(browser, page)
    assert window.locator("details:not([open])").count() > 0
    window.evaluate("void dispatchEvent(new Event('beforeprint'))")
    assert window.locator("details:not([open])").count() == 0
    assert window.locator("#identifiability ~ h3:visible").count() >= 8
    series = window.locator(".series")
    assert window.locator(".series canvas").count() >= series.count() > 0
    assert len(window.pdf(format="A4", prefer_css_page_size=True)) > 50_000


def test_a_study_opens(browser: "Browser", study: Study, study_page: Path) -> None:
    window, said = opened(browser, study_page)
    assert window.locator("h2").count() == window.locator("nav.contents a").count()
    assert window.locator(".verdict").count() == len(study.claims)
    assert said == []


def test_a_tuning_opens_and_fits_the_window(browser: "Browser", tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text(html(fabricated_fin()), encoding="utf-8")
    window, said = opened(browser, path)
    assert window.locator("h2").count() == window.locator("nav.contents a").count()
    assert window.locator("figure > svg:visible").count() == window.locator("figure > svg").count()
    for width in (1100, 420):
        window.set_viewport_size({"width": width, "height": 800})
        assert window.evaluate("document.documentElement.scrollWidth") <= width
    assert said == []
