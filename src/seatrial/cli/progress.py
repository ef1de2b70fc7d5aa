"""Progress on standard error: a line for each phase, and how far a long one is."""

import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from seatrial.cli.screen import is_quiet, is_verbose
from seatrial.core.text.plain import ascii_text
from seatrial.core.text.progress import ProgressReport, read_report

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

# s of a phase below which a terminal keeps no line of it; letters of what a phase says of itself; both chosen
SHORT_PHASE_S, DETAIL_LETTERS = 0.3, 40
LONG_PHASE_S = 20.0  # s of a phase after which, and after each doubling, a line says how far it is; chosen
BAR_LETTERS = 20  # of the bar; chosen
WHOLE_SECONDS_S = 120.0  # s: less is shown in whole seconds; chosen


@contextmanager
def progress_reporter(*, has_live_table: bool = False) -> Iterator[Callable[[str], None]]:
    """Give a function that takes reports: nothing is printed with --quiet, every report with --verbose.

    has_live_table: whether the command draws a table of its own on a terminal, which lines between would tear.
    """
    if is_quiet() or (has_live_table and sys.stdout.isatty()):
        yield lambda _: None
    elif is_verbose() or not sys.stderr.isatty():
        yield _print if is_verbose() else _Lines().report
    else:
        with _bar() as bar:
            phases = _Phases(bar)
            yield phases.report
            phases.end()


@contextmanager
def notices() -> Iterator[None]:
    """Print what the package logs of its own work, such as compiling: on a terminal, or with --verbose."""
    log, handler = logging.getLogger("seatrial"), _Notices()
    if is_quiet() or not (is_verbose() or sys.stderr.isatty()):
        yield
        return
    level = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.setLevel(level)
        log.removeHandler(handler)


class _Notices(logging.Handler):
    """Prints a message as a line of progress."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print the message on standard error as it is now."""
        _print(record.getMessage())


def _print(line: str) -> None:
    print(ascii_text(line), file=sys.stderr, flush=True)


class _Lines:
    """A line for each phase, once, and for a long one how far it is: after 20 s, 40 s, 80 s and so on."""

    def __init__(self) -> None:
        self._printed = set[str]()
        self._phase = ""
        self._began, self._next_s = 0.0, LONG_PHASE_S

    def report(self, text: str) -> None:
        """Print what this report adds."""
        one, now = read_report(text), time.monotonic()
        if one.phase != self._phase:
            self._phase, self._began, self._next_s = one.phase, now, LONG_PHASE_S
        if one.phase not in self._printed:
            self._printed.add(one.phase)
            _print(one.phase)
        elapsed = now - self._began
        if elapsed >= self._next_s:
            while self._next_s <= elapsed:
                self._next_s *= 2.0  # each doubling: few lines, however long it takes
            left = _time_left(elapsed, one) or one.detail[:DETAIL_LETTERS]
            _print(f"  {one.phase}: {elapsed:.0f} s so far{f', {left}' if left else ''}")


def _bar() -> "Progress":
    """Phase, what it says of itself, a bar that fills where parts are counted, time spent and time left."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    return Progress(
        SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(bar_width=BAR_LETTERS),
        TimeElapsedColumn(), TextColumn("{task.fields[left]}", markup=False),
        console=Console(stderr=True), transient=True,
    )  # fmt: skip


class _Phases:
    """The present phase on a terminal, and a line for each one that has ended."""

    def __init__(self, bar: "Progress") -> None:
        self._bar = bar
        self._task: TaskID | None = None
        self._phase = ""
        self._ended: set[str] = set()

    def report(self, text: str) -> None:
        """Show a report; a new phase ends the one before."""
        one = read_report(ascii_text(text))
        if one.phase != self._phase:
            self.end()
            self._phase = one.phase
            self._task = self._bar.add_task(one.phase, total=None, left="")
        self._show(one)

    def end(self) -> None:
        """End the present phase: a line with its time, unless it was short or there is one already."""
        from seatrial.core.text.numbers import duration

        if self._task is None:
            return
        elapsed = self._bar.tasks[-1].elapsed or 0.0
        self._bar.remove_task(self._task)
        self._task = None
        if elapsed > SHORT_PHASE_S and self._phase not in self._ended:
            self._ended.add(self._phase)
            self._bar.console.print(f"  {self._phase}  {ascii_text(duration(elapsed))}", markup=False, highlight=False)

    def _show(self, one: ProgressReport) -> None:
        if self._task is None:
            return
        detail = f": {one.detail[:DETAIL_LETTERS]}" if one.detail else ""
        self._bar.update(
            self._task, description=f"{one.phase}{detail}", total=one.total or None, completed=one.done,
            left=_time_left(self._bar.tasks[-1].elapsed or 0.0, one),
        )  # fmt: skip


def _time_left(elapsed: float, one: ProgressReport) -> str:
    """The time left [s] if the rest takes as long as what is done; empty where nothing is counted or done."""
    from seatrial.core.text.numbers import duration

    if not 0 < one.done <= one.total:
        return ""
    left = elapsed / one.done * (one.total - one.done)
    if left < 1.0:
        return ""
    return f"about {ascii_text(duration(left)) if left > WHOLE_SECONDS_S else f'{left:.0f} s'} left"
