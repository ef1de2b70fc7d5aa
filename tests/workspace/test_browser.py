"""A real browser walks the whole way: unknown log, a wrong sign, a held-out run, fit, what-if, gains, report."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from tests.workspace.logs import Opened, opened, write_logs

if TYPE_CHECKING:
    from playwright.sync_api import Browser
    from playwright.sync_api import Page as Window

TIMEOUT_MS = 60_000  # of a step, a fit in it
MOST_BYTES = 400_000  # of the page without data
VIEWS = ("logs", "craft", "fit", "whatif", "gains", "onboard", "file")
# a refusal (409, 422) is an answer, which browsers list as a failed request; so is what a test holds back
ANSWERED = re.compile("status of 4|ERR_FAILED")
SCRIPT = "<script>document.title='owned'</script><img src=x onerror=alert(1)>"
# names that a screen reader has for everything that takes a hand
UNNAMED = """() => [...document.querySelectorAll('button, select, input, textarea, a, iframe, svg[role]')]
  .filter(one => !(one.labels?.length || one.getAttribute('aria-label') || one.title || one.textContent.trim()))
  .map(one => one.outerHTML.slice(0, 120))"""


@contextmanager
def window_on(browser: "Browser", served: Opened, width: int = 1400, *, is_dark: bool = False) -> "Iterator[Window]":
    """A window on the workspace; what its console says, and requests to anybody else, fail the test."""
    scheme = "dark" if is_dark else "light"
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    window = context.new_page()
    window.set_default_timeout(TIMEOUT_MS)
    said: list[str] = []
    window.on("console", lambda m: said.append(m.text) if not ANSWERED.search(m.text) else None)
    window.on("pageerror", lambda error: said.append(str(error)))
    window.on("request", lambda r: None if r.url.startswith((served.origin, "data:")) else said.append(r.url))
    window.goto(served.address)
    window.locator(".content").wait_for()
    yield window
    context.close()
    assert said == []


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walk")
    write_logs(folder)
    return folder


@pytest.fixture(scope="module")
def served(folder: Path) -> Iterator[Opened]:
    with opened(folder) as workspace:
        yield workspace


def go(window: "Window", view: str) -> None:
    window.locator(f"#steps a[data-view='{view}']").click()
    window.locator(f".content.{view}").wait_for()


def test_the_whole_way(browser: "Browser", served: Opened, folder: Path) -> None:
    with window_on(browser, served) as window:
        # an unknown log: nothing is recognised, a person says what the columns are
        window.get_by_label("Length of the craft").fill("20")
        window.get_by_role("button", name="Draft the trial file").click()
        for column, channel in (("A1", "time"), ("B7", "psi"), ("C3", "delta")):
            window.get_by_label(f"what {column} is").select_option(channel)
        window.get_by_role("button", name="Draft the trial file").click()
        window.get_by_role("heading", name="Columns").wait_for()
        window.locator(".plot canvas").first.wait_for()
        # a wrong sign, which the check shows, and which is corrected by hand
        side = window.get_by_label("positive side of delta")
        side.select_option("port")
        window.locator("#finding-list code", has_text="wrong-sign").first.wait_for()
        window.locator("#findings", has_text=re.compile(r"^\d errors")).wait_for()
        window.locator("#edit").get_by_text("Edited:").wait_for()
        side.select_option("starboard")
        window.locator("#findings", has_text="checks pass").wait_for()
        # a stretch is dragged out and held out
        window.get_by_label("Log", exact=True).select_option("log_2")
        curve = window.locator(".plot .u-over").first
        window.wait_for_timeout(500)
        curve.scroll_into_view_if_needed()
        box = curve.bounding_box()
        assert box is not None
        window.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 40)
        window.mouse.down()
        window.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 40, steps=8)
        window.mouse.up()
        assert abs(float(window.get_by_label("from", exact=True).input_value()) - 120.0) < 3.0
        window.get_by_label("called").fill("second half")
        window.locator(".cut select").select_option("validate")
        window.get_by_role("button", name="Make it a run").click()
        window.get_by_label("what second half is for").wait_for()
        window.get_by_label("what log_1 is for").select_option("train")
        window.locator("#edit", has_text="log_1 is fitted").wait_for()
        text = (folder / "trial.toml").read_text(encoding="utf-8")
        assert 'validate = ["second half"]' in text and 'name = "second half"' in text
        # fit
        go(window, "fit")
        window.get_by_role("button", name="Start the fit").click()
        window.get_by_text("Predicts the held-out").first.wait_for()
        window.get_by_role("row", name="K gain").wait_for()
        # what if: a circle with another gain
        window.get_by_role("button", name="What if").click()
        rates = window.locator(".whatif-picture tr", has_text="steady yaw rate")
        rates.wait_for()
        slider = window.get_by_role("slider", name=re.compile("^K "))
        slider.focus()
        slider.press("End")
        window.locator("th", has_text="Moved").wait_for()
        estimate, moved = (float(text) for text in rates.locator("td").all_inner_texts())
        assert moved > estimate > 0.0
        # gains
        go(window, "gains")
        window.get_by_label("speed of the craft").fill("4")
        window.get_by_role("button", name="Begin an autopilot").click()
        window.get_by_text("phase margin").wait_for()
        margin = window.locator(".facts").inner_text()
        gain = window.get_by_role("slider", name=re.compile("^KP "))
        gain.focus()
        gain.press("PageUp")
        window.wait_for_function("before => document.querySelector('.facts').innerText !== before", arg=margin)
        # report
        go(window, "fit")
        window.get_by_role("button", name="Report").click()
        frame = window.frame_locator("iframe.report")
        frame.get_by_text("Predicts the held-out").first.wait_for()
        # everything can be taken back
        go(window, "file")
        window.get_by_role("button", name="Undo the last change").click()
        window.locator("#edit", has_text="undo:").wait_for()
        assert 'validate = ["log_1", "second half"]' in (folder / "trial.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize("is_dark", [False, True])
def test_every_view_fits_and_names_what_takes_a_hand(
    browser: "Browser", served: Opened, width: int, *, is_dark: bool
) -> None:
    with window_on(browser, served, width, is_dark=is_dark) as window:
        for view in VIEWS:
            go(window, view)
            window.wait_for_timeout(300)
            assert window.evaluate("document.documentElement.scrollWidth") <= width, view
            assert window.evaluate(UNNAMED) == [], view
            assert "[object" not in window.locator(".content").inner_text(), view


def test_two_windows_lose_nothing(browser: "Browser", served: Opened, folder: Path) -> None:
    with window_on(browser, served) as first, window_on(browser, served) as second:
        for window in (first, second):
            go(window, "craft")
        second.route("**/api/state", lambda route: route.abort())  # a window that does not hear of the change
        first.get_by_label("ship.name").fill("one")
        first.get_by_label("ship.name").press("Tab")
        first.locator("#edit", has_text="ship.name = one").wait_for()
        second.unroute("**/api/state")
        second.get_by_label("ship.L").fill("22")
        second.get_by_label("ship.L").press("Tab")
        second.get_by_role("button", name="Do mine on the newer file").click()
        second.locator("#edit", has_text="ship.L = 22").wait_for()
        text = (folder / "trial.toml").read_text(encoding="utf-8")
        assert 'name = "one"' in text and "L = 22" in text


def test_the_page_is_small_and_works_by_keys(browser: "Browser", served: Opened) -> None:
    sizes: list[int] = []
    context = browser.new_context()
    window = context.new_page()
    window.on("response", lambda r: sizes.append(len(r.body())) if "/api/" not in r.url and r.status == 200 else None)
    window.goto(served.address)
    window.locator(".content").wait_for()
    assert 0 < sum(sizes) < MOST_BYTES
    window.keyboard.press("Tab")
    assert window.evaluate("document.activeElement.className") == "skip"
    for _ in range(2):
        window.keyboard.press("Tab")
    window.keyboard.press("Enter")
    window.locator(".content.craft").wait_for()
    context.close()


def test_what_a_log_is_called_is_text(browser: "Browser", tmp_path: Path) -> None:
    rows = "".join(f"{0.5 * k},{k % 20},{k % 7}\n" for k in range(200))
    (tmp_path / "log.csv").write_text(f'A1,"{SCRIPT}",heading\n{rows}', encoding="utf-8")
    with opened(tmp_path) as served, window_on(browser, served) as window:
        window.get_by_role("button", name="Look at the columns first").click()
        window.get_by_text("<script>").first.wait_for()
        assert window.title() != "owned"
