"""One stream on its way to an estimate: ordered, journalled, kept where a fit is made of it at the end."""

from collections.abc import Iterable, Iterator
from typing import Protocol

import numpy as np

from seatrial.core.results.online import Proposal, Sample, SampleCounts, Snapshot
from seatrial.core.text.words import counted
from seatrial.core.values import InputError
from seatrial.data.trial.settings import Stream
from seatrial.onboard.journal import Journal, RunEntry
from seatrial.onboard.proposer import GainProposer
from seatrial.onboard.recent_run import RecentRun
from seatrial.onboard.run_buffer import RunBuffer
from seatrial.onboard.sample_order import RunStart, SampleOrder, StreamEvent, combined_counts

# messages kept; chosen: more would only repeat the same trouble
_MAX_MESSAGES = 20
# written into journals: not to be changed
_RESTART_REASON = "followed again"


class StreamEstimator(Protocol):
    """Makes estimates from samples; it has no thread and no clock of its own."""

    def begin_run(self) -> None:
        """Begin a run with the next sample."""
        ...

    def update(self, sample: Sample) -> Snapshot:
        """Take in a sample and return the snapshot after it."""
        ...


class StreamSession:
    """Takes samples in and holds the newest snapshot.

    Attributes:
        snapshot: the newest; None before the first sample.
        last_journalled: the last sample of the journal, if any.
        recent_run: the run so far, for people.
        messages: errors of the estimator and of the journal, in words, each once.
    """

    def __init__(
        self,
        stream: Stream,
        estimator: StreamEstimator,
        journal: Journal | None,
        buffer: RunBuffer | None,
        proposer: GainProposer | None = None,
    ) -> None:
        self.snapshot: Snapshot | None = None
        self.last_journalled: Sample | None = None
        self.messages: list[str] = []
        self._name, self._estimator, self._journal, self._buffer = stream.name, estimator, journal, buffer
        self._proposer = proposer
        self._stream, self._order, self._earlier_counts = stream, _sample_order(stream), SampleCounts()
        self._run_count, self._restarts = 0, False
        self.recent_run = RecentRun(stream.layout)
        self._estimator_error = ""

    def journal_events(self, journal: Journal, *, continues: bool) -> Iterator[StreamEvent]:
        """Yield the events of the journal, in order; they are not written again.

        continues: whether the samples to come go on where the journal ends; otherwise they may be admitted meanwhile.
        """
        order = self._order if continues else _sample_order(self._stream)
        for entry in journal.entries():
            if isinstance(entry, Sample):
                self.last_journalled = entry
                yield from order.admit(entry)
            elif entry.reason == _RESTART_REASON:
                self._earlier_counts = combined_counts(self._earlier_counts, order.counts)
                order = _sample_order(self._stream)
        if continues:
            self._order = order
        else:
            self._earlier_counts = combined_counts(self._earlier_counts, order.counts)
        if journal.torn_bytes:
            torn = f"the last {journal.torn_bytes} bytes of '{journal.path.name}'"
            self._add_message(f"{torn} were incomplete after a break and were cut off")
        if journal.damaged_places:
            places = counted(journal.damaged_places, "damaged place")
            self._add_message(f"{places} of '{journal.path.name}' cost the samples there and were skipped")

    def admit(self, samples: Iterable[Sample]) -> list[StreamEvent]:
        """Return the events that follow from these samples, written to the journal first."""
        events = [event for sample in samples for event in self._order.admit(sample)]
        if self._journal is not None:
            if events and self._restarts:
                self._journal.append(RunEntry(_RESTART_REASON))
                self._restarts = False
            for event in events:
                self._journal.append(RunEntry(event.reason) if isinstance(event, RunStart) else event)
            self._journal.write_pending()
        return events

    def process(self, event: StreamEvent) -> None:
        """Update the estimate with an event; what the estimator refuses becomes a message, and the next may succeed."""
        try:
            if isinstance(event, RunStart):
                self._start_run()
                return
            if self._buffer is not None:
                self._buffer.add(event)
            self.recent_run.add(event)
            if self._proposer is not None:
                self._proposer.add(event)
            self.snapshot = self._estimator.update(event)
        except (InputError, np.linalg.LinAlgError, ArithmeticError) as error:
            self._estimator_error = f"t = {event.time:g} s: {error}"
            self._add_message(str(error))

    @property
    def proposal(self) -> Proposal | None:
        """Return the newest proposal of gains; None where none is required, or before the first."""
        return None if self._proposer is None else self._proposer.proposal

    def restart(self) -> None:
        """Begin a run with the next sample, whatever its time: its positions may have another origin than before."""
        self._reset_order()
        self._restarts = True

    def finish(self) -> None:
        """End the stream."""
        self._order.drop_suspect()

    def counts(self, source: SampleCounts) -> SampleCounts:
        """Return the counts of the source and the ordering together, with the estimator's latest error in words."""
        estimator_error = SampleCounts(last_problem=self._estimator_error)
        return combined_counts(source, self._earlier_counts, self._order.counts, estimator_error)

    def _reset_order(self) -> None:
        self._earlier_counts = combined_counts(self._earlier_counts, self._order.counts)
        self._order = _sample_order(self._stream)

    def _start_run(self) -> None:
        self._run_count += 1
        if self._buffer is not None:
            self._buffer.start_run(self._name if self._run_count == 1 else f"{self._name}_{self._run_count}")
        self.recent_run.start_run()
        if self._proposer is not None:
            self._proposer.start_run()
        self._estimator.begin_run()

    def _add_message(self, text: str) -> None:
        if text not in self.messages and len(self.messages) < _MAX_MESSAGES:
            self.messages.append(text)


def _sample_order(stream: Stream) -> SampleOrder:
    return SampleOrder(1.0 / stream.rate, stream.longest_gap_s)
