"""What of a stream is used: samples in order of time, each once; breaks of the clock begin a new run."""

import math
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from seatrial.core.results.online import Counts
from seatrial.onboard.sample import Sample

_FIRST_STEPS = 20
_SAME = 1e-3


@dataclass(frozen=True)
class RunBegins:
    """A new run begins with the sample that follows; time [s] is its own."""

    time: float
    reason: str


Event = Sample | RunBegins


class Gate:
    """Puts a stream in order; its memory does not grow.

    A sample not later than the newest by up to `late_s` is late, one at its very time repeated; both are dropped. One
    further back, or more than `longest_gap_s` ahead, is kept in doubt until the next: if that goes on from it, the
    clock has jumped and a new run begins with it; if that goes on from before, the stamp was wrong and the sample is
    dropped, as late or, if ahead, as garbled. Steps for which nothing came are counted from `dt`, or from the median
    of the first twenty steps. Values that are not finite become NaN.

    Args:
        dt: s, nominal step; None: from the stream.
        longest_gap_s: s; late_s: s by which a stamp may be behind and still belong to the same clock.
    """

    def __init__(self, dt: float | None, longest_gap_s: float, *, late_s: float = 5.0) -> None:
        self._dt = dt
        self._longest_gap, self._late_s = longest_gap_s, late_s
        self._newest = -math.inf
        self._doubt: Sample | None = None
        self._steps: list[float] = []
        self._accepted = self._not_finite = self._missing = 0
        self._trouble = Counts()

    @property
    def dt(self) -> float | None:
        """Nominal step [s]; None until twenty steps have been seen."""
        return self._dt

    @property
    def counts(self) -> Counts:
        """What happened to the samples; one in doubt is not yet counted."""
        return replace(self._trouble, accepted=self._accepted, not_finite=self._not_finite, missing=self._missing)

    def admit(self, sample: Sample) -> list[Event]:
        """What comes of a sample: nothing, the sample, or a new run that begins with it or with the one in doubt."""
        time, doubt = sample.time, self._doubt
        if not math.isfinite(time):
            return self._garbled("a sample without a time")
        step = time - self._newest
        if step == math.inf:
            return self._begun(sample, "the stream begins")
        if doubt is not None and abs(time - doubt.time) < abs(step):
            return self._after_doubt(doubt, sample)
        if abs(step) <= _SAME * (self._dt or 0.0):
            self._trouble = replace(self._trouble, repeated=self._trouble.repeated + 1, last=f"t = {time:g} s twice")
            return []
        if 0.0 < step <= self._longest_gap:
            self._refute()
            return self._next(sample, step)
        if -self._late_s <= step < 0.0:
            return self._late(f"t = {time:g} s came after {self._newest:g} s")
        self._refute()
        self._doubt = sample
        return []

    def finish(self) -> list[Event]:
        """At the end of the stream: a sample still in doubt is dropped and counted."""
        self._refute()
        return []

    def _after_doubt(self, doubt: Sample, sample: Sample) -> list[Event]:
        step = sample.time - doubt.time
        if abs(step) <= _SAME * (self._dt or 0.0):
            self._trouble = replace(
                self._trouble, repeated=self._trouble.repeated + 1, last=f"t = {sample.time:g} s twice"
            )
            return []
        if -self._late_s <= step < 0.0:
            return self._late(f"t = {sample.time:g} s came after {doubt.time:g} s")
        if not 0.0 < step <= self._longest_gap:
            self._refute()
            self._doubt = sample
            return []
        reason = f"the clock jumped from {self._newest:g} s to {doubt.time:g} s"
        self._trouble = replace(self._trouble, jumps=self._trouble.jumps + 1, last=reason)
        self._doubt = None
        return [*self._begun(doubt, reason), *self._next(sample, step)]

    def _begun(self, sample: Sample, reason: str) -> list[Event]:
        return [RunBegins(sample.time, reason), *self._used(sample)]

    def _next(self, sample: Sample, step: float) -> list[Event]:
        if self._dt is not None:
            self._missing += _missed(step, self._dt)
        else:
            self._steps.append(step)
            if len(self._steps) == _FIRST_STEPS:
                self._dt = median(self._steps)
                self._missing += sum(_missed(one, self._dt) for one in self._steps)
                self._steps.clear()
        return self._used(sample)

    def _used(self, sample: Sample) -> list[Event]:
        self._newest = sample.time
        self._accepted += 1
        if np.isfinite(sample.values).all():
            return [sample]
        self._not_finite += 1
        if not np.isinf(sample.values).any():
            return [sample]
        return [Sample(sample.time, np.where(np.isfinite(sample.values), sample.values, np.nan))]

    def _refute(self) -> None:
        if self._doubt is None:
            return
        time, self._doubt = self._doubt.time, None
        if time < self._newest:
            self._late(f"t = {time:g} s came after {self._newest:g} s")
        else:
            self._garbled(f"nothing went on from t = {time:g} s, far ahead of {self._newest:g} s")

    def _late(self, last: str) -> list[Event]:
        self._trouble = replace(self._trouble, late=self._trouble.late + 1, last=last)
        return []

    def _garbled(self, last: str) -> list[Event]:
        self._trouble = replace(self._trouble, garbled=self._trouble.garbled + 1, last=last)
        return []


def combined(source: Counts, gate: Counts) -> Counts:
    """The counts of a source and of the gate behind it as one."""
    return Counts(
        accepted=source.accepted + gate.accepted,
        late=source.late + gate.late,
        repeated=source.repeated + gate.repeated,
        not_finite=source.not_finite + gate.not_finite,
        missing=source.missing + gate.missing,
        jumps=source.jumps + gate.jumps,
        garbled=source.garbled + gate.garbled,
        checksum=source.checksum + gate.checksum,
        dropped=source.dropped + gate.dropped,
        truncated=source.truncated + gate.truncated,
        last="; ".join(text for text in (source.last, gate.last) if text),
    )


def _missed(step: float, dt: float) -> int:
    return max(round(step / dt) - 1, 0)
