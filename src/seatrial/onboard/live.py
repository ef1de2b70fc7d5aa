"""A live table on a terminal, plain lines everywhere else; an error of the terminal does not stop the estimate."""

import math
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol, Self, TextIO

from seatrial.core.results.online import EstimatorPhase, SampleCounts, Snapshot
from seatrial.core.text.numbers import DASH
from seatrial.core.text.plain import ascii_text
from seatrial.core.text.words import counted, enumeration, printable
from seatrial.onboard.table import (
    MAX_NAMES,
    History,
    RecentHistory,
    TableContent,
    estimate_rows,
    faults_text,
    gains_text,
    render_table,
    time_text,
    watch_sentence,
)

if TYPE_CHECKING:
    from rich.console import Console

# s between drawings; chosen: as fast as figures can be read
REDRAW_INTERVAL_S = 0.5
# s between lines, at least and at most, and as a share of the time followed; chosen: some hundred lines in an hour
MIN_LINE_INTERVAL_S, MAX_LINE_INTERVAL_S, INTERVAL_GROWTH = 1.0, 60.0, 0.05


class _Screen(Protocol):
    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None: ...
    def close(self) -> None: ...


class LiveDisplay:
    """Shows the snapshots it is given: a table that stays in place, or lines where the stream is no terminal.

    with Live(heading="trial.toml") as live: live.show(snapshot, counts)

    stream: standard output by default; heading: what is followed, and the address of its page.
    No threads: it draws when it is given a snapshot, at most twice a second; the last one is always shown.
    """

    def __init__(self, stream: TextIO | None = None, *, heading: str = "") -> None:
        self._stream = sys.stdout if stream is None else stream
        self._heading = heading
        self._screen: _Screen | None = None

    def __enter__(self) -> Self:
        console = _open_console(self._stream)
        self._screen = _Lines(self._stream, self._heading) if console is None else _Table(console, self._heading)
        return self

    def __exit__(self, *raised: object) -> None:
        if self._screen is not None:
            self._screen.close()
        self._screen = None

    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None:
        """Show the snapshot, unless another was shown less than half a second ago."""
        if self._screen is not None:
            self._screen.show(snapshot, counts)


class _Table:
    """A table, redrawn in place."""

    def __init__(self, console: "Console", heading: str) -> None:
        from rich.live import Live as RichLive

        self._console, self._heading = console, heading
        self._history, self._recent = History(limit=4), RecentHistory()
        self._last: tuple[Snapshot, SampleCounts] | None = None
        self._updated_at, self._drawn_at = 0.0, -math.inf
        self._live = RichLive(console=console, auto_refresh=False)
        self._has_failed = not _try_write(self._live.start)

    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None:
        now = time.monotonic()
        if _is_update(self._last, snapshot, counts):
            self._recent.add(self._history.add(snapshot))
            self._updated_at = now
        self._last = snapshot, counts
        if now - self._drawn_at >= REDRAW_INTERVAL_S:
            self._draw(self._console.height)
            self._drawn_at = time.monotonic()

    def close(self) -> None:
        self._draw(None)
        _try_write(self._live.stop)

    def _draw(self, height: int | None) -> None:
        if self._last is None or self._has_failed:
            return
        silence = 0.0 if height is None else time.monotonic() - self._updated_at
        table = render_table(self._console, TableContent(self._heading, *self._last, self._recent, silence), height)
        self._has_failed = not _try_write(lambda: self._live.update(table, refresh=height is not None))


class _Lines:
    """Lines: the first at once, later ones at intervals that grow from a second to a minute."""

    def __init__(self, stream: TextIO, heading: str) -> None:
        self._stream = stream
        self._started_at, self._due_at = math.inf, -math.inf
        self._last: tuple[Snapshot, SampleCounts] | None = None
        self._is_written = True
        self._has_failed = False
        if heading:
            self._write(ascii_text(printable(heading)))

    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None:
        if self._is_written and not _is_update(self._last, snapshot, counts):
            return
        self._last, self._is_written = (snapshot, counts), False
        now = time.monotonic()
        if now >= self._due_at:
            self._started_at = min(self._started_at, now)
            self._due_at = now + min(
                MAX_LINE_INTERVAL_S, max(MIN_LINE_INTERVAL_S, INTERVAL_GROWTH * (now - self._started_at))
            )
            self._write_last()

    def close(self) -> None:
        self._write_last()

    def _write_last(self) -> None:
        if self._last is not None and not self._is_written:
            self._write(log_line(*self._last))
        self._is_written = True

    def _write(self, text: str) -> None:
        if not self._has_failed:
            self._has_failed = not _try_write(lambda: _print_encoded(text, self._stream))


def log_line(snapshot: Snapshot, counts: SampleCounts) -> str:
    """Return moment, phase, coefficients with half of their 95 % intervals, what is not identified, faults, change,
    and the gains proposed; before there is an estimate no coefficients, which would be the start values.
    """
    sizes = f"{counted(snapshot.samples, 'sample')} {counted(snapshot.runs, 'run')}"
    rows = [
        f"{row.name} {row.value}{f' +- {row.half_width}' if row.half_width != DASH else ''} {row.unit}".rstrip()
        for row in estimate_rows(snapshot)
    ]
    names = [printable(name) for name in snapshot.unidentified]
    parts = [
        f"{time_text(snapshot.time)} {snapshot.phase.value} {sizes}",
        "no estimate yet" if rows and snapshot.phase is EstimatorPhase.WAITING else ", ".join(rows),
        f"not identified: {enumeration(names, MAX_NAMES)}" if names else "",
        faults_text(counts),
        watch_sentence(snapshot),
        "" if snapshot.proposal is None else f"proposed gains: {gains_text(snapshot.proposal)}",
    ]
    return ascii_text(" | ".join(part for part in parts if part))


def _open_console(stream: TextIO) -> "Console | None":
    """A console on that stream; None where it is not a terminal, or one that cannot draw a table."""
    try:
        if not stream.isatty():
            return None
        from rich.console import Console

        console = Console(file=stream)
        can_draw = console.is_terminal and not console.is_dumb_terminal and console.encoding.startswith("utf")
    except (OSError, ValueError, LookupError):
        return None
    return console if can_draw else None


def _is_update(last: tuple[Snapshot, SampleCounts] | None, snapshot: Snapshot, counts: SampleCounts) -> bool:
    return last is None or last[0] is not snapshot or last[1] != counts


def _print_encoded(text: str, stream: TextIO) -> None:
    encoding = getattr(stream, "encoding", None) or "utf-8"
    print(text.encode(encoding, "replace").decode(encoding), file=stream, flush=True)


def _try_write(write: Callable[[], object]) -> bool:
    """Write, and return whether that succeeded: a terminal may be closed, too small, or of an unusual encoding."""
    try:
        write()
    except (OSError, ValueError, LookupError):
        return False
    return True
