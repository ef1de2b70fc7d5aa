"""Which samples of a stream are used: in order of time, each once; a break of the clock begins a new run."""

import math
from dataclasses import dataclass, fields, replace
from statistics import median
from typing import Literal

import numpy as np

from seatrial.core.results.online import Sample, SampleCounts

# steps whose median is the nominal step where none is given; chosen: a few pauses among them do not move it
_FIRST_STEPS = 20
# share of a step within which two times are the same; chosen: above the rounding of a logger that writes four digits
_SAME_TIME = 1e-3


@dataclass(frozen=True)
class RunStart:
    """A new run begins with the next sample, whose time [s] this is."""

    time: float
    reason: str


StreamEvent = Sample | RunStart


class SampleOrder:
    """Puts a stream in order, in constant memory.

    A sample up to `late_s` older than the newest is late, one of the same time repeated; both are dropped. One older
    still, or more than `longest_gap_s` ahead, is suspect until the next arrives: if that continues from it, the clock
    has jumped and a new run begins with it; if that continues from before, the time stamp was wrong and the sample is
    dropped, as late or, if ahead, as garbled. Missing steps are counted from `dt`, or from the median of the first
    twenty steps. Values that are not finite become NaN.

    Args:
        dt: s, nominal step; None: from the stream.
        longest_gap_s: s; late_s: s by which a stamp may be behind and still belong to the same clock.
    """

    def __init__(self, dt: float | None, longest_gap_s: float, *, late_s: float = 5.0) -> None:  # seconds, chosen
        self._dt = dt
        self._longest_gap, self._late_s = longest_gap_s, late_s
        self._newest_time = -math.inf
        self._suspect: Sample | None = None
        self._steps: list[float] = []
        self._accepted = self._not_finite = self._missing = 0
        self._fault_counts = SampleCounts()

    @property
    def dt(self) -> float | None:
        """Nominal step [s]; None before it is known."""
        return self._dt

    @property
    def counts(self) -> SampleCounts:
        """Counts of the samples; a suspect one is not yet counted."""
        return replace(self._fault_counts, accepted=self._accepted, not_finite=self._not_finite, missing=self._missing)

    def admit(self, sample: Sample) -> list[StreamEvent]:
        """Return what follows from a sample: nothing, the sample, or a new run that begins with it or a suspect one."""
        time, suspect = sample.time, self._suspect
        if not math.isfinite(time):
            return self._dropped("garbled", "a sample without a time")
        step = time - self._newest_time
        if step == math.inf:
            return self._start_run(sample, "the stream begins")
        if suspect is not None and abs(time - suspect.time) < abs(step):
            return self._resolve_suspect(suspect, sample)
        if abs(step) <= _SAME_TIME * (self._dt or 0.0):
            return self._dropped("repeated", f"t = {time:g} s twice")
        if 0.0 < step <= self._longest_gap:
            self.drop_suspect()
            return self._continue_run(sample, step)
        if -self._late_s <= step < 0.0:
            return self._dropped("late", f"t = {time:g} s arrived after {self._newest_time:g} s")
        self.drop_suspect()
        self._suspect = sample
        return []

    def _resolve_suspect(self, suspect: Sample, sample: Sample) -> list[StreamEvent]:
        step = sample.time - suspect.time
        if abs(step) <= _SAME_TIME * (self._dt or 0.0):
            return self._dropped("repeated", f"t = {sample.time:g} s twice")
        if -self._late_s <= step < 0.0:
            return self._dropped("late", f"t = {sample.time:g} s arrived after {suspect.time:g} s")
        if not 0.0 < step <= self._longest_gap:
            self.drop_suspect()
            self._suspect = sample
            return []
        reason = f"the clock jumped from {self._newest_time:g} s to {suspect.time:g} s"
        self._fault_counts = replace(self._fault_counts, jumps=self._fault_counts.jumps + 1, last_problem=reason)
        self._suspect = None
        return [*self._start_run(suspect, reason), *self._continue_run(sample, step)]

    def _start_run(self, sample: Sample, reason: str) -> list[StreamEvent]:
        return [RunStart(sample.time, reason), *self._accept(sample)]

    def _continue_run(self, sample: Sample, step: float) -> list[StreamEvent]:
        if self._dt is not None:
            self._missing += _missing_steps(step, self._dt)
        else:
            self._steps.append(step)
            if len(self._steps) == _FIRST_STEPS:
                self._dt = median(self._steps)
                self._missing += sum(_missing_steps(one, self._dt) for one in self._steps)
                self._steps.clear()
        return self._accept(sample)

    def _accept(self, sample: Sample) -> list[StreamEvent]:
        self._newest_time = sample.time
        self._accepted += 1
        if np.isfinite(sample.values).all():
            return [sample]
        self._not_finite += 1
        if not np.isinf(sample.values).any():
            return [sample]
        return [Sample(sample.time, np.where(np.isfinite(sample.values), sample.values, np.nan))]

    def drop_suspect(self) -> None:
        """Drop and count a sample that is still suspect, as at the end of the stream."""
        if self._suspect is None:
            return
        time, self._suspect = self._suspect.time, None
        if time < self._newest_time:
            self._dropped("late", f"t = {time:g} s arrived after {self._newest_time:g} s")
        else:
            self._dropped("garbled", f"no sample followed t = {time:g} s, far ahead of {self._newest_time:g} s")

    def _dropped(self, fault: Literal["late", "repeated", "garbled"], message: str) -> list[StreamEvent]:
        """Count a sample that is not used; nothing follows from it."""
        count = {fault: getattr(self._fault_counts, fault) + 1}
        self._fault_counts = replace(self._fault_counts, last_problem=message, **count)
        return []


def combined_counts(*parts: SampleCounts) -> SampleCounts:
    """Return the counts of a source and of the orderings behind it as one."""
    names = [field.name for field in fields(SampleCounts) if field.name != "last_problem"]
    sums = {name: sum(getattr(part, name) for part in parts) for name in names}
    return SampleCounts(**sums, last_problem="; ".join(part.last_problem for part in parts if part.last_problem))


def _missing_steps(step: float, dt: float) -> int:
    return max(round(step / dt) - 1, 0)
