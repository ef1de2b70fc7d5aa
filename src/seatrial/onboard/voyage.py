"""One stream on its way to an estimate: admitted, noted in the journal, kept where a fit is to be made of it."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Protocol

import numpy as np

from seatrial.core.results.online import Counts, Snapshot
from seatrial.core.values import InputError
from seatrial.data.trial.trial import Stream
from seatrial.onboard.gate import Event, Gate, RunBegins, combined
from seatrial.onboard.journal import Begin, Journal
from seatrial.onboard.raw import Kept
from seatrial.onboard.sample import Sample

_NOTES = 20
_RESTARTED = "followed again"


class Estimator(Protocol):
    """What makes estimates of samples; it has no thread and no clock of its own."""

    def begin_run(self) -> None:
        """A run begins with the next sample."""
        ...

    def update(self, sample: Sample) -> Snapshot:
        """What is known with this sample."""
        ...


class Voyage:
    """Samples in, the newest snapshot out.

    Attributes:
        snapshot: the newest; None before the first sample. last: the last sample of the journal, if there was any.
        notes: trouble of the estimator and of the journal, in words, each once.
    """

    def __init__(self, stream: Stream, estimator: Estimator, journal: Journal | None, kept: Kept | None) -> None:
        self.snapshot: Snapshot | None = None
        self.last: Sample | None = None
        self.notes: list[str] = []
        self._name, self._estimator, self._journal, self._kept = stream.name, estimator, journal, kept
        self._stream, self._gate, self._before = stream, _gate(stream), Counts()
        self._runs = 0
        self._trouble = ""

    def recalled(self, journal: Journal) -> Iterator[Event]:
        """What the journal holds, as it came; nothing of it is noted again.

        Raises:
            InputError: the journal is damaged.
        """
        for entry in journal.entries():
            if isinstance(entry, Sample):
                self.last = entry
                yield from self._gate.admit(entry)
            elif entry.reason == _RESTARTED:
                self._begin_anew()
        if journal.torn:
            self._say(f"the last {journal.torn} bytes of '{journal.path.name}' were torn by a break and are cut off")

    def admitted(self, samples: Iterable[Sample]) -> list[Event]:
        """What comes of these samples, in the journal before anything is made of it."""
        events = [event for sample in samples for event in self._gate.admit(sample)]
        if self._journal is not None:
            for event in events:
                self._journal.note(Begin(event.reason) if isinstance(event, RunBegins) else event)
            self._journal.settle()
        return events

    def follow(self, event: Event) -> None:
        """Make of it what can be made; what the estimator refuses is said, and the next may be better."""
        try:
            if isinstance(event, RunBegins):
                self._begin()
                return
            if self._kept is not None:
                self._kept.add(event)
            self.snapshot = self._estimator.update(event)
        except (InputError, np.linalg.LinAlgError, ArithmeticError) as error:
            self._trouble = f"t = {event.time:g} s: {error}"
            self._say(str(error))

    def restarted(self) -> None:
        """What comes begins a run, whatever its time: its positions may be counted from another place than before."""
        self._begin_anew()
        if self._journal is not None:
            self._journal.note(Begin(_RESTARTED))

    def finish(self) -> None:
        """Nothing more comes."""
        self._gate.finish()

    def counts(self, source: Counts) -> Counts:
        """Of the source and the gate together, with the estimator's trouble in words."""
        made = combined(source, combined(self._before, self._gate.counts))
        return replace(made, last="; ".join(text for text in (made.last, self._trouble) if text))

    def _begin_anew(self) -> None:
        self._before, self._gate = combined(self._before, self._gate.counts), _gate(self._stream)

    def _begin(self) -> None:
        self._runs += 1
        if self._kept is not None:
            self._kept.begin(self._name if self._runs == 1 else f"{self._name}_{self._runs}")
        self._estimator.begin_run()

    def _say(self, text: str) -> None:
        if text not in self.notes and len(self.notes) < _NOTES:
            self.notes.append(text)


def _gate(stream: Stream) -> Gate:
    return Gate(1.0 / stream.rate, stream.longest_gap)
