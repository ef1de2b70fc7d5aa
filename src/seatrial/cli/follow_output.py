"""What follow shows while it runs and prints at its end, and how it is stopped."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_findings
from seatrial.cli.screen import print_lines
from seatrial.numerics.platform import stop_signals

if TYPE_CHECKING:
    from seatrial.core.results.online import SampleCounts, Snapshot
    from seatrial.data.trial import Trial
    from seatrial.onboard.follow import FollowResult


@contextmanager
def stop_on_signal() -> Iterator[Callable[[], bool]]:
    """Yield a function that returns whether a signal to stop has arrived; a second signal interrupts at once."""
    received: list[int] = []

    def note(number: int, _: FrameType | None) -> None:
        if received:
            raise KeyboardInterrupt
        received.append(number)

    before = {number: signal.signal(number, note) for number in stop_signals()}
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def live_display(heading: str, port: int | None) -> "Iterator[Callable[[Snapshot, SampleCounts], None]]":
    """Yield a function that shows a snapshot as table or lines, and on a page at `port` (None: none, 0: any free)."""
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
    """Return what is followed, in a line."""
    from seatrial.data.trial.runs import require_stream

    stream = require_stream(trial)
    name = trial.path.name if trial.path else trial.model.name
    if stream.file is not None and stream.source.value.endswith("file"):
        return f"{name}: {stream.source} {stream.file.name}"
    return f"{name}: {stream.source}" + (f" {stream.host}:{stream.port}" if stream.source.value.endswith("udp") else "")


def print_outcome(outcome: "FollowResult") -> None:
    """Print the counts of samples, the latest fault and the findings; messages go to standard error."""
    from seatrial.core.text.words import printable
    from seatrial.onboard.table import faults_text

    counts = outcome.counts
    print_lines([f"{counts.accepted} samples accepted; {faults_text(counts) or 'no faults'}"])
    if counts.last_problem:
        print_lines([f"latest fault: {printable(counts.last_problem)}"])
    if outcome.snapshot is not None and outcome.snapshot.phase.value == "waiting" and outcome.snapshot.advice:
        print_lines([f"no estimate yet: {printable(outcome.snapshot.advice)}"])
    if outcome.snapshot is not None and outcome.snapshot.findings:
        print_findings(outcome.snapshot.findings, 1)
    for note in outcome.messages:
        print(f"seatrial: {note}", file=sys.stderr)


def journal_path(path: Path | None, trial: "Trial", out: Path | None, *, once: bool) -> Path | None:
    """Return the file of the journal: as given, as in [follow], or in the result folder if the stream has no end."""
    from seatrial.data.trial.runs import require_stream

    named = path or require_stream(trial).journal
    if named is not None or out is None or once:
        return named
    return out / f"{trial.path.stem if trial.path else trial.model.name}.journal"
