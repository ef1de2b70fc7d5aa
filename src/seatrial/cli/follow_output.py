"""What follow shows while it runs and prints at its end, and how it is stopped."""

import json
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from seatrial.cli.application import requiring_app
from seatrial.cli.finding_output import print_findings
from seatrial.cli.screen import print_lines
from seatrial.numerics.platform import stop_signals

if TYPE_CHECKING:
    from seatrial.core.results.online import SampleCounts, Snapshot
    from seatrial.data.trial import Trial
    from seatrial.onboard.follow import FollowResult, Show


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
def live_display(trial: "Trial", port: int | None) -> "Iterator[Show]":
    """Yield a function that shows a snapshot as table or lines, and in the workspace.

    port: of the workspace that is served meanwhile (None: none, 0: any that is free).

    Raises:
        InputError: the port cannot be opened, or the workspace's packages are missing.
    """
    from seatrial.onboard.live import LiveDisplay

    heading = stream_heading(trial)
    with ExitStack() as held:
        show_on_page = None
        if port is not None and trial.path is not None:
            address, show_on_page = held.enter_context(_shown_in_workspace(trial.path, port, heading))
            heading = f"{heading}; page {address}"
        live = held.enter_context(LiveDisplay(heading=heading))

        def show(snapshot: "Snapshot", counts: "SampleCounts") -> None:
            converted = in_units_of_the_fit(snapshot, trial)
            live.show(converted, counts)
            if show_on_page is not None:
                show_on_page(converted, counts)

        yield show


@contextmanager
def _shown_in_workspace(path: Path, port: int, heading: str) -> "Iterator[tuple[str, Show]]":
    """Serve the workspace of a trial file; yield the address of its view 'On board', and what shows a snapshot there.

    It waits at its end until pages have been given the last one.
    """
    from seatrial.onboard.stream_report import StreamReporter

    with requiring_app():
        from seatrial.workspace import workspace_beside

    with workspace_beside(path, port) as (workspace, address):
        followed, reporter = workspace.follow(), StreamReporter(heading)

        def show(snapshot: "Snapshot", counts: "SampleCounts") -> None:
            if (report := reporter.report(snapshot, counts)) is not None:
                followed.take(report)

        yield f"{address}#onboard", show
        followed.end()


@contextmanager
def reports_as_lines(trial: "Trial") -> "Iterator[Show]":
    """Yield a function that prints a report of each snapshot as a line of JSON: what a workspace reads."""
    from seatrial.onboard.stream_report import StreamReporter

    reporter = StreamReporter(stream_heading(trial))

    def show(snapshot: "Snapshot", counts: "SampleCounts") -> None:
        if (report := reporter.report(in_units_of_the_fit(snapshot, trial), counts)) is not None:
            print(json.dumps(report, allow_nan=False), flush=True)

    yield show


def in_units_of_the_fit(snapshot: "Snapshot", trial: "Trial") -> "Snapshot":
    """Return the snapshot with units over kilograms where no thrust is known in newtons, as `identify` prints them."""
    from seatrial.physics.models.thruster_layout import layout_of
    from seatrial.reporting.model_chapter import mass_specific_unit

    if not trial.model.has_thrusters or layout_of(trial.model).has_bollard:
        return snapshot
    return replace(snapshot, units=tuple(map(mass_specific_unit, snapshot.units)))


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
