"""What follow shows while it runs and says at its end; how it is stopped."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from seatrial.cli.output import SEVERITY_MARK
from seatrial.numerics.platform import stop_signals

if TYPE_CHECKING:
    from seatrial.core.results.online import SampleCounts, Snapshot
    from seatrial.data.trial import Trial
    from seatrial.onboard.follow import FollowResult


@contextmanager
def stop_on_signal() -> Iterator[Callable[[], bool]]:
    """Whether somebody asked for the end (Ctrl-C, or a polite kill); asked twice, it is cut short."""
    asked: list[int] = []

    def note(number: int, _: FrameType | None) -> None:
        if asked:
            raise KeyboardInterrupt
        asked.append(number)

    before = {number: signal.signal(number, note) for number in stop_signals()}
    try:
        yield lambda: bool(asked)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def live_display(heading: str, port: int | None) -> "Iterator[Callable[[Snapshot, SampleCounts], None]]":
    """A live table or lines, and a page at that port where one is wanted (0: any that is free)."""
    from seatrial.onboard.live import LiveDisplay

    with ExitStack() as held:
        page = None
        if port is not None:
            from seatrial.onboard.page import Page

            page = held.enter_context(Page(port, title=heading))
            heading = f"{heading}; page {page.address}"
        live = held.enter_context(LiveDisplay(heading=heading))

        def show(snapshot: "Snapshot", counts: "SampleCounts") -> None:
            live.show(snapshot, counts)
            if page is not None:
                page.show(snapshot, counts)

        yield show
        if page is not None:
            page.end()


def stream_heading(trial: "Trial") -> str:
    """What is followed, in a line."""
    from seatrial.data.trial.follow_table import require_stream

    stream = require_stream(trial)
    name = trial.path.name if trial.path else trial.model.name
    if stream.file is not None and stream.source.value.endswith("file"):
        return f"{name}: {stream.source} {stream.file.name}"
    return f"{name}: {stream.source}" + (f" {stream.host}:{stream.port}" if stream.source.value.endswith("udp") else "")


def print_outcome(outcome: "FollowResult") -> None:
    """What happened to the samples, then what is to be said besides; trouble on standard error."""
    from seatrial.core.text.words import printable
    from seatrial.onboard.snapshot_text import fault_counts

    counts = outcome.counts
    wrong = [f"{count} {words}" for words, count in fault_counts(counts) if count]
    print(f"{counts.accepted} samples accepted" + (f"; {', '.join(wrong)}" if wrong else "; nothing amiss"))
    if counts.last_problem:
        print(f"the latest: {printable(counts.last_problem)}")
    if outcome.snapshot is not None and outcome.snapshot.phase.value == "waiting" and outcome.snapshot.advice:
        print(f"no estimate yet: {printable(outcome.snapshot.advice)}")
    for finding in () if outcome.snapshot is None else outcome.snapshot.findings:
        print(f"{SEVERITY_MARK[finding.severity.value]} [{finding.code}] {finding.text}")
    for note in outcome.messages:
        print(f"seatrial: {note}", file=sys.stderr)


def journal_path(path: Path | None, trial: "Trial", out: Path | None, *, once: bool) -> Path | None:
    """Where the journal goes: as given, as [follow] says, or in the result folder where no end is in sight."""
    from seatrial.data.trial.follow_table import require_stream

    named = path or require_stream(trial).journal
    if named is not None or out is None or once:
        return named
    return out / f"{trial.path.stem if trial.path else trial.model.name}.journal"
