"""A real browser opens the page, sees it move, and runs nothing that somebody put into a name."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from tests.onboard.fabricated import faulty_counts, heave_pitch, mmg
from tests.reporting.fabricated import zigzag
from tests.reporting.test_browser import MOST_EMPTY, RULES, empty_shares

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import Finding, Severity
from seatrial.onboard.page import Page

if TYPE_CHECKING:
    from playwright.sync_api import Browser
    from playwright.sync_api import Page as Window

SCRIPT = "<script>document.title='owned'</script><img src=x onerror=alert(1)>"


@pytest.fixture
def page() -> Iterator[Page]:
    with Page(0, title="trial.toml") as made:
        yield made


@contextmanager
def opened(browser: "Browser", page: Page) -> "Iterator[tuple[Window, list[str]]]":
    """The page in a window, and what its console had to say; requests to anybody else are complaints."""
    window = browser.new_page(viewport={"width": 1100, "height": 900})
    window.set_default_timeout(8000)
    said: list[str] = []
    window.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    window.on("pageerror", lambda error: said.append(str(error)))
    window.on("request", lambda request: None if request.url.startswith(page.address) else said.append(request.url))
    window.goto(page.address)
    yield window, said
    window.close()


def test_opens_with_nothing_moves_with_what_comes_and_says_when_it_ends(browser: "Browser", page: Page) -> None:
    with opened(browser, page) as (window, said):
        window.get_by_text("no samples yet").wait_for()
        assert not window.locator("#body").is_visible()
        snapshots = list(heave_pitch(120.0))
        page.show(snapshots[0], SampleCounts())
        window.get_by_text("waiting: too few samples for an estimate yet").wait_for()
        for snapshot in snapshots[1:100]:
            page.show(snapshot, faulty_counts())
        window.locator("#facts").get_by_text("49.5 s").wait_for()
        first = window.locator("#values path.course").first.get_attribute("d")
        assert window.locator("#values figure").count() == 8 and window.locator("#noise figure").count() == 2
        assert window.locator("#values path.band").first.get_attribute("d")
        for snapshot in snapshots[100:]:
            page.show(snapshot, faulty_counts())
        window.locator("#facts").get_by_text("120.0 s").wait_for()
        assert window.locator("#values path.course").first.get_attribute("d") != first
        assert window.locator("#status").inner_text() == "following"
        page.end("end of trial.csv")
        window.get_by_text("the stream has ended: end of trial.csv").wait_for()
        assert said == []


def test_track_rudder_heading_and_what_to_do_next_stand_on_the_first_screen(browser: "Browser", page: Page) -> None:
    snapshot = replace(list(mmg(40.0))[-1], recent=(zigzag("z", 20.0),))
    page.show(snapshot, SampleCounts())
    with opened(browser, page) as (window, said):
        window.get_by_text("What to do next").wait_for()
        assert [text[:5] for text in window.locator("#recent .name").all_text_contents()] == ["track", "δ [de", "ψ [de"]
        for place in ("#next", "#recent"):
            box = window.locator(place).bounding_box()
            assert box is not None and box["y"] + box["height"] < 900
        window.set_viewport_size({"width": 390, "height": 844})
        assert window.evaluate("document.documentElement.scrollWidth") <= 390
        assert said == []


OUTSIDE = """() => [...document.querySelectorAll('figure svg text')].filter(text => {
    const box = text.getBoundingClientRect(), figure = text.closest('figure').getBoundingClientRect();
    return box.width > 0 && (box.left < figure.left - 1 || box.right > figure.right + 1);
}).map(text => text.textContent)"""


@pytest.mark.parametrize("count", [1, 20])
def test_its_plots_fit_a_telephone_from_the_first_estimate_on_and_its_sheets_are_filled(
    browser: "Browser", page: Page, count: int
) -> None:
    for snapshot in list(mmg(40.0))[-count:]:
        page.show(replace(snapshot, recent=(zigzag("z", 20.0),)), faulty_counts())
    with opened(browser, page) as (window, said):
        window.locator("#values path.course").last.wait_for(state="attached")
        window.set_viewport_size({"width": 390, "height": 844})
        assert window.evaluate("document.documentElement.scrollWidth") <= 390
        assert window.evaluate(OUTSIDE) == []
        assert [window.evaluate(f"({RULES}).{rule}()") for rule in ("faint", "cut", "unnamed")] == [[], [], []]
        ticks = window.locator("#values figure").first.locator(".tick").all_text_contents()
        assert len(set(ticks)) == len(ticks)
        window.set_viewport_size({"width": 1400, "height": 900})
        shares = empty_shares(window.pdf(format="A4", prefer_css_page_size=True))
        assert max(shares[:-1]) <= MOST_EMPTY and shares[-1] < 1.0
        assert said == []


def test_what_somebody_put_into_names_is_text(browser: "Browser", page: Page) -> None:
    base = list(mmg(40.0))[-1]
    names = (SCRIPT, *base.names[1:])
    hostile = Finding(Severity.ERROR, "x", SCRIPT, SCRIPT, SCRIPT)
    noise = {SCRIPT: 0.1, **base.noise}
    page.show(
        replace(base, names=names, noise=noise, unidentified=(SCRIPT,), advice=SCRIPT, findings=(hostile,)),
        SampleCounts(garbled=1, last_problem=SCRIPT),
    )
    with opened(browser, page) as (window, said):
        window.locator("#rows").get_by_text(SCRIPT).wait_for()
        for place in ("#values", "#noise", "#shares", "#unidentified", "#findings", "#last"):
            assert SCRIPT in (window.locator(place).text_content() or "")
        assert window.locator("script").count() == 1 and window.locator("img").count() == 0
        assert window.title() == "trial.toml · seatrial"
        window.set_viewport_size({"width": 420, "height": 800})
        assert window.evaluate("document.documentElement.scrollWidth") <= 420
        assert said == []


def test_a_program_that_ended_is_said_and_its_numbers_stay(browser: "Browser") -> None:
    first = Page(0)
    with first:
        for snapshot in heave_pitch(30.0):
            first.show(snapshot, SampleCounts())
        window = browser.new_page()
        window.set_default_timeout(8000)
        window.goto(first.address)
        window.locator("#facts").get_by_text("30.0 s").wait_for()
    window.get_by_text("seatrial no longer answers").wait_for()
    assert window.locator("#rows tr").count() == 8
    with Page(first.port) as again:
        for snapshot in mmg(30.0):
            again.show(snapshot, SampleCounts())
        window.locator("#rows").get_by_text("X_vvvv").wait_for()
        assert window.locator("#values figure").count() == 15
        assert window.locator("#status").inner_text() == "following"
    window.close()


def test_who_looks_as_the_stream_ends_sees_its_end(browser: "Browser") -> None:
    snapshots = list(heave_pitch(30.0))
    with Page(0) as page:
        page.show(snapshots[-2], SampleCounts())
        window = browser.new_page()
        window.set_default_timeout(8000)
        window.goto(page.address)
        window.locator("#facts").get_by_text("29.5 s").wait_for()
        page.show(snapshots[-1], SampleCounts())
        page.end()
    window.wait_for_timeout(700)
    assert window.locator("#status").inner_text() == "the stream has ended"
    assert window.locator("#facts").get_by_text("30.0 s").is_visible()
    window.close()


def test_silence_is_said(browser: "Browser", page: Page) -> None:
    page.show(list(heave_pitch(30.0))[-1], SampleCounts())
    page._updated_at -= 17.0
    with opened(browser, page) as (window, said):
        window.get_by_text(re.compile(r"no samples for (17|18|19|2\d) s")).wait_for()
        assert said == []
