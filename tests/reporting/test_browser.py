"""A real browser opens the pages, clicks through them and has nothing to complain about."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import pytest
from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_fin
from tests.reporting.test_campaign import fabricated_campaign
from tests.reporting.test_verification import LEGS, TURNS

from seatrial.core.results import Fit, Study
from seatrial.reporting.campaign import html as campaign_html
from seatrial.reporting.comparison import html as comparison_html
from seatrial.reporting.design import html as design_html
from seatrial.reporting.page import html as fit_html
from seatrial.reporting.pages import report_page
from seatrial.reporting.study import html as study_html
from seatrial.reporting.tuning import html as tuning_html

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


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
    assert window.locator("section:has(#identifiability) h3:visible").count() >= 8
    series = window.locator(".series")
    assert window.locator(".series canvas").count() >= series.count() > 0
    assert len(window.pdf(format="A4", prefer_css_page_size=True)) > 50_000


MOST_EMPTY = 0.45  # share of a sheet, but of the last one, that is left empty at most; chosen: a figure that moved on
MARGINS = 17.0 / 297.0, 20.0 / 297.0  # of a sheet, above and below: `@page` in style.css, the page's number in it
INK = 200  # grey level of 255 below which a pixel is printed on


def empty_shares(document: bytes) -> list[float]:
    """The share of each sheet of a PDF below its last line, margins left out."""
    sheets = pytest.importorskip("pypdfium2", reason="pypdfium2 is not installed").PdfDocument(document)
    shares = list[float]()
    for k in range(len(sheets)):
        grey = np.asarray(sheets[k].render(scale=0.5).to_pil().convert("L"))
        top, bottom = round(MARGINS[0] * len(grey)), round((1.0 - MARGINS[1]) * len(grey))
        rows = np.flatnonzero((grey[top:bottom] < INK).any(axis=1))
        shares.append(1.0 - (rows[-1] + 1) / (bottom - top) if len(rows) else 1.0)
    return shares


def pages_of_every_kind(fit: Fit, study: Study) -> "dict[str, str]":
    return {
        "fit": fit_html(fit), "study": study_html(study), "fin": tuning_html(fabricated_fin()),
        "autopilot": tuning_html(fabricated_autopilot()), "design": design_html(fabricated_design()),
        "comparison": comparison_html(fabricated_comparison()), "campaign": campaign_html(fabricated_campaign()),
        "legs": report_page(replace(LEGS, gains=LONG_GAINS)), "turns": report_page(TURNS),
    }  # fmt: skip


RULES = (Path(__file__).parent / "page_rules.js").read_text(encoding="utf-8")
KINDS = ("fit", "study", "fin", "autopilot", "design", "comparison", "campaign", "legs", "turns")
LONG_GAINS = {"KP": 11.053, "KI": 4.3507e-11, "KD": 32.736}  # more than a telephone's line holds


@pytest.fixture(scope="module")
def every_page(fit: Fit, study: Study, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    for name, text in pages_of_every_kind(fit, study).items():
        (folder / f"{name}.html").write_text(text, encoding="utf-8")
    return {name: folder / f"{name}.html" for name in KINDS}


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_answers_first_and_fits_desk_and_telephone(
    browser: "Browser", every_page: dict[str, Path], kind: str
) -> None:
    window, said = opened(browser, every_page[kind], 390)
    assert window.evaluate("document.documentElement.scrollWidth") <= 390
    window.set_viewport_size({"width": 1400, "height": 900})
    assert window.evaluate("document.documentElement.scrollWidth") <= 1400
    box = window.locator(".first > .verdict-line").bounding_box()
    assert box is not None and box["y"] + box["height"] < 400
    assert window.locator(".first .key-facts tr").count() >= 1
    assert window.locator("h2").count() == window.locator("nav.contents a").count()
    window.locator("#unfold").dispatch_event("click")
    for k in range(window.locator(".series").count()):
        series = window.locator(".series").nth(k)
        series.scroll_into_view_if_needed()
        window.wait_for_function("k => document.querySelectorAll('.series')[k].classList.contains('is-drawn')", arg=k)
        assert series.locator("canvas").count() == int(series.get_attribute("data-panels") or 0)
    assert window.locator("figure > svg:visible").count() == window.locator("figure > svg").count()
    assert said == []


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_no_table_is_cut_and_all_is_named(
    browser: "Browser", every_page: dict[str, Path], kind: str, scheme: Literal["light", "dark"]
) -> None:
    window = browser.new_page(viewport={"width": 1400, "height": 900}, color_scheme=scheme)
    window.goto(every_page[kind].as_uri())
    window.evaluate("document.querySelectorAll('details').forEach(fold => { fold.open = true; })")
    assert window.evaluate(f"({RULES}).faint()") == []
    assert window.evaluate(f"({RULES}).cut()") == []
    assert window.evaluate(f"({RULES}).unnamed()") == []


@pytest.mark.parametrize("kind", KINDS)
def test_no_printed_sheet_but_the_last_is_half_empty(
    browser: "Browser", every_page: dict[str, Path], kind: str
) -> None:
    window, _ = opened(browser, every_page[kind])
    shares = empty_shares(window.pdf(format="A4", prefer_css_page_size=True))
    assert [round(share, 2) for share in shares[:-1] if share > MOST_EMPTY] == []
    assert shares[-1] < 1.0, "no empty sheet at the end"


def test_an_empty_half_is_seen(browser: "Browser", tmp_path: Path) -> None:
    path = tmp_path / "two.html"
    path.write_text(
        "<p>one</p><p style='break-before: page; height: 200mm; background: black'>two</p>", encoding="utf-8"
    )
    window, _ = opened(browser, path)
    first, second = empty_shares(window.pdf(format="A4", print_background=True))
    assert first > 0.9 and second < 0.3


def test_what_is_wider_than_a_telephone_is_moved_by_keys(browser: "Browser", page: Path) -> None:
    window, _ = opened(browser, page, 390)
    table = window.locator("section:has(#prediction) .scroll").first
    table.focus()
    before = table.evaluate("box => box.scrollLeft")
    window.keyboard.press("ArrowRight")
    window.wait_for_function("([box, before]) => box.scrollLeft > before", arg=[table.element_handle(), before])
    names = table.locator("tbody tr > :first-child").first.bounding_box()
    assert names is not None and names["x"] >= 0.0


TELEPHONES = (390, 500)


@pytest.mark.parametrize("width", TELEPHONES)
def test_a_telephone_shows_estimates_with_their_intervals_and_says_what_goes_on(
    browser: "Browser", page: Path, width: int
) -> None:
    """Coefficients with both ends of their intervals, and the forest, need not be moved; what is wider says so."""
    window, said = opened(browser, page, width)
    numbers = window.locator("section:has(#coefficients) tbody tr:first-child td.num:visible")
    boxes = [numbers.nth(k).bounding_box() for k in range(3)]  # estimate, and both ends
    assert all(box is not None and box["x"] + box["width"] <= width for box in boxes)
    forest = window.locator("section:has(#coefficients) .narrow-only > svg:visible").first.bounding_box()
    assert forest is not None and forest["x"] >= 0.0 and forest["x"] + forest["width"] <= width
    window.locator("#unfold").dispatch_event("click")
    silent = window.evaluate(
        """() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(
            [...document.querySelectorAll('.scroll, figure')]
              .filter(box => box.checkVisibility() && box.scrollWidth > box.clientWidth + 1)
              .filter(box => !getComputedStyle(box, '::before').content.includes('to the right'))
              .map(box => box.textContent.trim().slice(0, 60))))))"""
    )
    assert silent == [] and window.locator(".is-wide:visible").count() > 0
    assert said == []


@pytest.mark.parametrize("width", [*TELEPHONES, 1400])
def test_the_first_plots_are_drawn_before_the_first_picture(browser: "Browser", page: Path, width: int) -> None:
    window = browser.new_page(viewport={"width": width, "height": 900})
    count = "document.querySelectorAll('.first .is-drawn canvas').length"
    window.add_init_script(f"addEventListener('DOMContentLoaded', () => {{ window.early = {count}; }})")
    window.goto(page.as_uri())
    assert window.evaluate("window.early") == window.locator(".first .series canvas").count() > 0


def test_the_cursor_is_linked_over_channels_and_track(browser: "Browser", page: Path) -> None:
    window, said = opened(browser, page)
    section = window.locator("section:has(#prediction) .run").first
    series = section.locator(".series")
    series.scroll_into_view_if_needed()
    panels = series.locator(".panel")
    panels.first.locator(".u-over").hover()
    texts = [panels.nth(k).locator(".readout").inner_text() for k in range(panels.count())]
    assert len(texts) == 5 and all("measured" in text or "input" in text for text in texts)
    assert section.locator(".track .place").first.get_attribute("r") == "4"
    assert said == []


def test_plots_far_below_the_window_are_drawn_without_being_scrolled_to(browser: "Browser", page: Path) -> None:
    window, said = opened(browser, page)
    window.wait_for_function(
        "() => [...document.querySelectorAll('.series')].every(s => !s.checkVisibility() || s.matches('.is-drawn'))"
    )
    assert window.locator(".series.is-drawn").count() >= 2 and window.evaluate("scrollY") == 0
    assert said == []


def test_keys_move_the_cursor_speak_the_values_and_zoom(browser: "Browser", page: Path) -> None:
    window, said = opened(browser, page)
    panel = window.locator(".first .panel").first
    assert (panel.get_attribute("aria-label") or "").startswith("ψ [deg] over 4 min 00 s")
    panel.focus()
    for key in ("Home", "ArrowRight", "PageDown"):
        window.keyboard.press(key)
    spoken = window.locator(".first [aria-live]")
    assert spoken.inner_text().startswith("t ") and "ψ [deg] measured" in spoken.inner_text()
    plain = panel.locator("canvas").screenshot()
    window.keyboard.press("+")
    window.wait_for_timeout(60)
    zoomed = panel.locator("canvas").screenshot()
    window.keyboard.press("0")
    window.wait_for_timeout(60)
    assert zoomed != plain and panel.locator("canvas").screenshot() != zoomed
    assert said == []


def test_a_dark_screen_has_a_dark_ground_and_light_letters(browser: "Browser", page: Path) -> None:
    window = browser.new_page(color_scheme="dark")
    window.goto(page.as_uri())
    ground, ink, tick = window.evaluate(
        """() => [document.body, document.querySelector('h1'), document.querySelector('.track text')].map((node, k) =>
        getComputedStyle(node)[['backgroundColor', 'color', 'fill'][k]].match(/\\d+/g).slice(0, 3).map(Number))"""
    )
    assert max(ground) < 50 and min(ink) > 180 and min(tick) > 150
