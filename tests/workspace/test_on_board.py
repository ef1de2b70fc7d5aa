"""A stream in the workspace: what its follower reports is drawn as it comes, in words that survive anything."""

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from tests.onboard.fabricated import CHANGE, faulty_counts, heave_pitch, mmg
from tests.reporting.fabricated import zigzag
from tests.reporting.test_browser import RULES
from tests.workspace.logs import at_address, write_trial

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.values import Finding, Severity
from seatrial.onboard.stream_report import StreamReporter
from seatrial.workspace import workspace_beside
from seatrial.workspace.onboard_view import FollowedStream, with_follow_table
from seatrial.workspace.workspace import Workspace

if TYPE_CHECKING:
    from playwright.sync_api import Browser
    from playwright.sync_api import Page as Window

SCRIPT = "<script>document.title='owned'</script><img src=x onerror=alert(1)>"
STEP_MS = 8000  # of a step


class Follower:
    """A follower whose estimates are fabricated."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.stream, self._reporter = workspace.follow(), StreamReporter("trial.toml: file voyage.csv")

    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None:
        """Report a snapshot."""
        if (report := self._reporter.report(snapshot, counts)) is not None:
            self.stream.take(report)


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = write_trial(tmp_path_factory.mktemp("onboard"))
    path.write_text(with_follow_table(path.read_text("utf-8"), 0, "growing.csv", 2.0), encoding="utf-8")
    return path


@pytest.fixture
def served(trial: Path) -> Iterator[tuple[Follower, str]]:
    with workspace_beside(trial) as (workspace, address):
        yield Follower(workspace), f"{address}#onboard"


@contextmanager
def opened(browser: "Browser", address: str, width: int = 1400) -> "Iterator[tuple[Window, list[str]]]":
    """The view in a window, and what its console had to say; requests to anybody else are complaints."""
    context = browser.new_context(viewport={"width": width, "height": 900})
    window = context.new_page()
    window.set_default_timeout(STEP_MS)
    said: list[str] = []
    window.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    window.on("pageerror", lambda error: said.append(str(error)))
    own = (address.partition("?")[0], "data:")
    window.on("request", lambda request: None if request.url.startswith(own) else said.append(request.url))
    window.goto(address)
    window.locator(".content.onboard").wait_for()
    yield window, said
    context.close()


def numbers_of(window: "Window", place: str) -> list[Any]:
    """What the first panel of a place shows."""
    return window.evaluate(f"[...document.querySelector('{place} > div').plot.data].map(one => [...one])")


def test_opens_with_nothing_moves_with_what_comes_and_says_when_it_ends(
    browser: "Browser", served: tuple[Follower, str]
) -> None:
    follower, address = served
    with opened(browser, address) as (window, said):
        window.get_by_text("no samples yet").wait_for()
        window.get_by_text("The command in the terminal follows").wait_for()
        assert not window.locator(".stream-body").is_visible()
        snapshots = list(heave_pitch(120.0))
        follower.show(snapshots[0], SampleCounts())
        window.get_by_text("waiting: too few samples for an estimate yet").wait_for()
        for snapshot in snapshots[1:100]:
            follower.show(snapshot, faulty_counts())
        window.locator(".facts").get_by_text("49.5 s").wait_for()
        assert window.locator(".values .plot").count() == 8 and window.locator(".noise .plot").count() == 2
        time, high, low, value = numbers_of(window, ".values")
        assert len(time) == 100 and time[-1] == 49.5
        assert value[-1] == pytest.approx(snapshots[99].value[0] / 10.0 ** round(_power(window)), rel=1e-6)
        assert high[-1] - low[-1] == pytest.approx(
            2 * 1.96 * snapshots[99].standard_error[0] / 10.0 ** round(_power(window)), rel=1e-5
        )
        for snapshot in snapshots[100:]:
            follower.show(snapshot, faulty_counts())
        window.locator(".facts").get_by_text("120.0 s").wait_for()
        assert len(numbers_of(window, ".values")[0]) == 241
        assert window.locator(".status").inner_text() == "following"
        assert "error" in (window.locator(".shares .plot").get_attribute("aria-label") or "")
        follower.stream.end("end of trial.csv")
        window.get_by_text("the stream has ended: end of trial.csv").wait_for()
        assert said == []


def _power(window: "Window") -> float:
    """The power of ten in the unit of the first coefficient."""
    unit = window.locator(".rows td.u").first.inner_text()
    digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
    found = re.match(r"10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", unit)
    return float(found[1].translate(digits)) if found else 0.0


def test_track_rudder_heading_and_what_to_do_next_stand_on_the_first_screen(
    browser: "Browser", served: tuple[Follower, str]
) -> None:
    follower, address = served
    follower.show(replace(list(mmg(40.0))[-1], recent=(zigzag("z", 20.0),)), SampleCounts())
    with opened(browser, address) as (window, said):
        window.get_by_text("What to do next").wait_for()
        assert [text[:5] for text in window.locator(".recent .readout b").all_inner_texts()] == ["δ [de", "ψ [de"]
        assert window.locator(".recent .craft").count() == 1
        for place in (".next", ".recent"):
            box = window.locator(place).bounding_box()
            assert box is not None and box["y"] + box["height"] < 900
        assert said == []


@pytest.mark.parametrize("count", [1, 20])
def test_it_fits_a_telephone_from_the_first_estimate_on(
    browser: "Browser", served: tuple[Follower, str], count: int
) -> None:
    follower, address = served
    for snapshot in list(mmg(40.0))[-count:]:
        follower.show(replace(snapshot, recent=(zigzag("z", 20.0),)), faulty_counts())
    with opened(browser, address, 390) as (window, said):
        window.locator(".values .plot").last.wait_for()
        assert window.evaluate("document.documentElement.scrollWidth") <= 390
        assert [window.evaluate(f"({RULES}).{rule}()") for rule in ("faint", "cut", "unnamed")] == [[], [], []]
        assert said == []


def test_what_somebody_put_into_names_is_text(browser: "Browser", served: tuple[Follower, str]) -> None:
    follower, address = served
    base = list(mmg(40.0))[-1]
    hostile = Finding(Severity.ERROR, "x", SCRIPT, SCRIPT, SCRIPT)
    follower.show(
        replace(
            base, names=(SCRIPT, *base.names[1:]), noise={SCRIPT: 0.1, **base.noise}, unidentified=(SCRIPT,),
            advice=SCRIPT, findings=(hostile,),
        ),
        SampleCounts(garbled=1, last_problem=SCRIPT),
    )  # fmt: skip
    with opened(browser, address, 420) as (window, said):
        window.locator(".rows").get_by_text(SCRIPT).wait_for()
        for place in (".values", ".noise", ".next", ".stream-findings", ".last"):
            assert SCRIPT in (window.locator(place).text_content() or "")
        assert SCRIPT in (window.locator(".shares .plot").get_attribute("aria-label") or "")
        assert window.locator(".content script").count() == 0 and window.locator("img").count() == 0
        assert window.title() == "trial.toml – seatrial"
        assert window.evaluate("document.documentElement.scrollWidth") <= 420
        assert said == []


def test_a_changed_ship_and_a_gap_are_said(browser: "Browser", served: tuple[Follower, str]) -> None:
    follower, address = served
    snapshot = list(heave_pitch(30.0))[-1]
    follower.show(replace(snapshot, change=CHANGE), replace(faulty_counts(), jumps=1))
    with opened(browser, address) as (window, _):
        window.locator(".change").get_by_text("coefficients changed at 220.0 s, b33 most clearly").wait_for()
        assert "clock jumps\t1" in window.locator(".counts").inner_text()
        assert "missing\t12" in window.locator(".counts").inner_text()
        follower.show(replace(snapshot, time=31.0), faulty_counts())
        window.locator(".change").wait_for(state="hidden")


def test_what_was_missed_while_the_line_was_down_is_fetched(browser: "Browser", served: tuple[Follower, str]) -> None:
    follower, address = served
    snapshots = list(heave_pitch(30.0))
    for snapshot in snapshots[:20]:
        follower.show(snapshot, SampleCounts())
    with opened(browser, address) as (window, _):
        window.locator(".facts").get_by_text("9.5 s").wait_for()
        follower.show(snapshots[20], SampleCounts())
        window.locator(".facts").get_by_text("10.0 s").wait_for()  # what comes after the first answer: the page listens
        follower.workspace.events._send("")  # as to a page that does not read fast enough
        window.get_by_text("seatrial no longer answers").wait_for()
        for snapshot in snapshots[21:]:
            follower.show(snapshot, SampleCounts())
        window.locator(".facts").get_by_text("30.0 s").wait_for()
        assert len(numbers_of(window, ".values")[0]) == 61
        assert window.locator(".status").inner_text() == "following"


def test_a_program_that_ended_is_said_and_its_numbers_stay(browser: "Browser", trial: Path) -> None:
    with workspace_beside(trial) as (workspace, address):
        follower = Follower(workspace)
        for snapshot in heave_pitch(30.0):
            follower.show(snapshot, SampleCounts())
        window = browser.new_page()
        window.set_default_timeout(STEP_MS)
        window.goto(f"{address}#onboard")
        window.locator(".facts").get_by_text("30.0 s").wait_for()
    window.get_by_text("seatrial no longer answers; these are its last numbers").wait_for()
    assert window.locator(".rows tr").count() == 8
    with workspace_beside(trial, at_address(address).port) as (workspace, other):
        window.get_by_text("seatrial was started again: open the address that the terminal shows").wait_for()
        follower = Follower(workspace)
        for snapshot in mmg(30.0):
            follower.show(snapshot, SampleCounts())
        window.goto(f"{other}#onboard")
        window.locator(".rows").get_by_text("X_vvvv").wait_for()
        assert window.locator(".values .plot").count() == 15
        assert window.locator(".status").inner_text() == "following"
    window.close()


def test_who_looks_as_the_stream_ends_sees_its_end(browser: "Browser", trial: Path) -> None:
    snapshots = list(heave_pitch(30.0))
    with workspace_beside(trial) as (workspace, address):
        follower = Follower(workspace)
        follower.show(snapshots[-2], SampleCounts())
        window = browser.new_page()
        window.set_default_timeout(STEP_MS)
        window.goto(f"{address}#onboard")
        window.locator(".facts").get_by_text("29.5 s").wait_for()
        follower.show(snapshots[-1], SampleCounts())
        follower.stream.end()
    window.wait_for_timeout(700)
    assert window.locator(".status").inner_text() == "the stream has ended"
    assert window.locator(".facts").get_by_text("30.0 s").is_visible()
    window.close()


def test_silence_is_said(browser: "Browser", served: tuple[Follower, str]) -> None:
    follower, address = served
    follower.show(list(heave_pitch(30.0))[-1], SampleCounts())
    follower.stream._taken_at -= 17.0
    with opened(browser, address) as (window, said):
        window.get_by_text(re.compile(r"no samples for (17|18|19|2\d) s")).wait_for()
        assert said == []


def test_the_workspace_keeps_the_points_that_the_follower_keeps() -> None:
    published: list[dict[str, Any]] = []
    stream, reporter = FollowedStream(published.append, ""), StreamReporter()
    snapshots = list(heave_pitch(2600.0))
    for snapshot in snapshots:
        report = reporter.report(snapshot, SampleCounts())
        assert report is not None
        stream.take(report)
    kept = [point[0] for point in stream.view()["points"]]
    assert kept == [*range(0, len(snapshots) - 1, 4), len(snapshots) - 1]
    assert kept == [point.sequence for point in reporter._history.since(-1)] and len(published) == len(snapshots)


def test_without_the_workspaces_packages_a_page_is_refused_before_anything_is_computed(
    trial: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith(("seatrial.workspace", "starlette", "uvicorn"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    (trial.parent / "growing.csv").write_text("A1,B7,C3\n", encoding="utf-8")
    assert run_command("follow", trial, "--once", "--page", "0") == 2
    said = capsys.readouterr()
    assert said.err.strip().endswith("pip install 'seatrial[app]'") and "\n" not in said.err.strip()
    assert said.out == ""
