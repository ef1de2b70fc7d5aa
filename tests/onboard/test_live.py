"""The table shows what is known; no stream, however odd, makes it raise."""

import io
import os
from dataclasses import replace
from typing import TextIO

import numpy as np
import pytest
from rich.console import Console
from tests.onboard.fabricated import faulty_counts, heave_pitch, mmg

from seatrial.core.results.online import EstimatorPhase, SampleCounts, Snapshot
from seatrial.onboard import live as module
from seatrial.onboard.live import LiveDisplay, log_line
from seatrial.onboard.table import History, RecentHistory, TableContent, render_table


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    encoding = "utf-8"  # pyright: ignore[reportAssignmentType]

    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def _plain_surroundings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "COLUMNS", "LINES"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")


def drawn(
    *, snapshots: list[Snapshot], width: int = 110, height: int | None = None, heading: str = "", silence: float = 0.0
) -> str:
    console = Console(file=io.StringIO(), width=width, height=50, force_terminal=False)
    history, recent = History(), RecentHistory()
    for snapshot in snapshots:
        recent.add(history.add(snapshot))
    console.print(render_table(console, TableContent(heading, snapshots[-1], faulty_counts(), recent, silence), height))
    return console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]


def test_the_table_tells_values_intervals_trends_noise_and_trouble() -> None:
    text = drawn(snapshots=list(mmg(300.0)), heading="trial.toml")
    words = text.split()
    assert all(name in words for name in mmg_names())
    assert "trial.toml" in text and "recursive" in text and "300.0 s" in text
    assert "deg" in words and "rad" not in words
    assert any(bar in text for bar in "▁▂▃▅▆▇█") and ("→" in words or "↘" in words)
    assert "12 missing" in text and "4 wrong checksum" in text and "0 dropped" not in text
    assert "psi 0.19" in text and "coloured" in text and "at 220.0 s" in text


def mmg_names() -> tuple[str, ...]:
    return next(iter(mmg(0.0))).names


def test_intervals_are_the_value_and_1_96_standard_errors_in_degrees() -> None:
    snapshot = Snapshot(1.0, 1, 1, EstimatorPhase.WINDOW, ("delta_0",), ("rad",), np.radians([2.0]), np.radians([0.5]))
    row = drawn(snapshots=[snapshot]).split("delta_0")[1].split()
    assert row[:5] == ["2.00", "1.02", "2.98", "deg", "25"]


def test_before_anything_is_known_there_are_dashes() -> None:
    text = drawn(snapshots=[next(iter(heave_pitch(0.0)))])
    assert "waiting" in text and "–" in text and "nan" not in text and "inf" not in text


def test_a_heading_wraps_so_that_the_address_can_be_read() -> None:
    heading = "a trial with a long name.toml: nmea udp 127.0.0.1:10110; page http://127.0.0.1:45678/"
    assert "http://127.0.0.1:45678/" in drawn(snapshots=list(heave_pitch(10.0)), width=60, heading=heading)


def test_silence_is_said() -> None:
    snapshots = list(heave_pitch(10.0))
    assert "no samples for 7.00 s" in drawn(snapshots=snapshots, silence=7.0)
    assert "no samples for" not in drawn(snapshots=snapshots, silence=1.0)


def test_a_small_terminal_gets_what_fits() -> None:
    snapshots = list(mmg(30.0))
    for width, height in ((80, 24), (40, 24), (110, 20)):
        lines = drawn(snapshots=snapshots, width=width, height=height).splitlines()
        assert all(len(text) <= width for text in lines)
        assert any("and" in text and "more" in text for text in lines)
    assert len(drawn(snapshots=snapshots, width=110, height=24).splitlines()) < 24
    assert "more" not in drawn(snapshots=snapshots, width=110, height=60)


def test_markup_and_escape_sequences_are_text() -> None:
    counts = SampleCounts(garbled=1, last_problem="$GPRMC\x1b]0;owned\x07[red]\u202e")
    snapshot = replace(next(iter(heave_pitch(0.0))), names=tuple("[b]x[/b]" + str(k) for k in range(8)))
    console = Console(file=io.StringIO(), width=100, force_terminal=False)
    recent = RecentHistory()
    recent.add(History().add(snapshot))
    console.print(render_table(console, TableContent("\x1b[2Jheading", snapshot, counts, recent), None))
    text = console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]
    assert "\x1b" not in text and "\x07" not in text and "\u202e" not in text
    assert "[b]x[/b]0" in text and "[red]" in text
    assert "\x1b" not in log_line(snapshot, counts)


def test_on_a_terminal_the_table_stays_in_place_and_ends_whole() -> None:
    stream, snapshot = Terminal(), next(iter(heave_pitch(0.0)))
    with LiveDisplay(stream, heading="trial.toml") as live:
        for snapshot in heave_pitch(60.0):
            live.show(snapshot, faulty_counts())
        assert "waiting" in stream.getvalue()
        shown = len(stream.getvalue())
    ended = stream.getvalue()[shown:]
    assert all(f"{name} " in ended for name in snapshot.names)
    assert "\x1b[1A" in ended and "60.0 s" in ended and ended.count("recursive") == 1


def test_a_real_terminal_that_is_closed_stops_nothing() -> None:
    pty = pytest.importorskip("pty", reason="no pseudo-terminals on this system")
    mine, theirs = pty.openpty()
    stream = os.fdopen(theirs, "w", encoding="utf-8")
    snapshots = list(heave_pitch(5.0))
    with LiveDisplay(stream) as live:
        live.show(snapshots[0], SampleCounts())
        os.read(mine, 1 << 16)
        os.close(mine)
        for snapshot in snapshots:
            live._screen._drawn_at = -1e9  # pyright: ignore
            live.show(snapshot, SampleCounts())


class Broken(io.StringIO):
    """A pipe nobody reads any more."""

    def write(self, text: str, /) -> int:
        raise BrokenPipeError(text)


def closed() -> TextIO:
    stream = io.StringIO()
    stream.close()
    return stream


@pytest.mark.parametrize(
    "stream",
    [Broken(), closed(), io.TextIOWrapper(io.BytesIO(), "ascii"), io.TextIOWrapper(io.BytesIO(), "cp1252")],
    ids=["broken pipe", "closed", "ascii", "cp1252"],
)
def test_odd_streams_do_not_raise(stream: TextIO) -> None:
    with LiveDisplay(stream, heading="versuch – ψ.toml") as live:
        for snapshot in mmg(10.0):
            live.show(snapshot, faulty_counts())


def test_a_dumb_terminal_gets_plain_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    stream = Terminal()
    with LiveDisplay(stream) as live:
        for snapshot in heave_pitch(60.0):
            live.show(snapshot, faulty_counts())
    assert "\x1b" not in stream.getvalue()


def test_lines_come_at_growing_waits_and_the_last_is_never_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: clock[0])
    stream, at = io.StringIO(), []
    with LiveDisplay(stream) as live:
        for k, snapshot in enumerate(heave_pitch(3600.0)):
            clock[0], before = 0.5 * k, stream.tell()
            live.show(snapshot, SampleCounts())
            if stream.tell() > before:
                at.append(clock[0])
    waits = np.diff(at)
    assert at[0] == 0.0 and waits.min() >= 1.0 and waits.max() <= 60.5
    assert np.all(np.diff(waits) >= -0.51)
    assert len(at) < 150
    assert stream.getvalue().splitlines()[-1].startswith("3600.0 s recursive")


def test_the_same_again_is_no_line(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: clock[0])
    stream, snapshot = io.StringIO(), list(heave_pitch(10.0))[-1]
    with LiveDisplay(stream) as live:
        for clock[0] in range(100):
            live.show(snapshot, SampleCounts(late=int(clock[0] > 50)))
    assert len(stream.getvalue().splitlines()) == 2


def test_a_line_has_values_with_half_intervals_and_no_typography() -> None:
    snapshot = list(mmg(20.0))[-1]
    text = log_line(snapshot, faulty_counts())
    assert text.isascii() and "\n" not in text
    assert (
        "X_vv -0.0" in text
        and " +- " in text
        and "not identified: " in text
        and "3 late, 1 repeated, 12 missing" in text
    )
    assert "10^-3" in log_line(list(mmg(300.0))[-1], SampleCounts())


def test_before_an_estimate_a_line_has_no_start_values() -> None:
    snapshot = replace(list(mmg(20.0))[-1], phase=EstimatorPhase.WAITING)
    text = log_line(snapshot, SampleCounts())
    assert "| no estimate yet |" in text and "X_vv -0" not in text
