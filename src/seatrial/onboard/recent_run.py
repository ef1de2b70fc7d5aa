"""The run so far as a record for people: thinned, so that a day of samples fits a screen."""

import numpy as np

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.read import Layout
from seatrial.data.read.assemble import record_from_values

# samples kept at most; chosen: more than a plot on a screen has columns
MAX_SAMPLES = 600
# a record needs a time step
_MIN_SAMPLES = 2


class RecentRun:
    """Every `stride`-th sample of a run and the newest; the stride doubles when there are too many."""

    def __init__(self, layout: Layout, limit: int = MAX_SAMPLES) -> None:
        self._layout, self._limit = layout, limit
        self.start_run()

    def start_run(self) -> None:
        """Forget the run before."""
        self._kept: list[Sample] = []
        self._newest: Sample | None = None
        self._count, self._stride = 0, 1

    def add(self, sample: Sample) -> None:
        """Append a sample."""
        self._newest = sample
        if self._count % self._stride == 0:
            self._kept.append(sample)
        self._count += 1
        if len(self._kept) > self._limit:
            self._kept, self._stride = self._kept[::2], 2 * self._stride

    def records(self) -> tuple[Record, ...]:
        """Return the run, in canonical frames and signs where the channels allow it; empty for too few samples."""
        newest = [] if self._newest is None or self._kept[-1] is self._newest else [self._newest]
        samples = [*self._kept, *newest]
        if len(samples) < _MIN_SAMPLES:
            return ()
        time = np.array([sample.time for sample in samples])
        try:
            record = record_from_values("run", self._layout, time, np.array([sample.values for sample in samples]))
        except InputError:
            return ()
        try:
            return (canonical_record(record),)
        except InputError:
            return (record,)
