"""What is shown of an online estimate: snapshots of warm-up, window and filter."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.online import CoefficientChange, EstimatorPhase, Snapshot
from seatrial.core.values import Array
from seatrial.estimation.estimate.online.window import WindowEstimate
from seatrial.estimation.identify.online.phases import Carried, KeptPhase
from seatrial.estimation.identify.online.recursive_phase import RecursivePhase


@dataclass(frozen=True)
class StreamProgress:
    """What has been received so far: samples, runs, and s of samples, breaks between runs not counted.

    Attributes:
        last_time: s on the stream's clock, of the present run's latest sample; NaN where a run has none yet.
    """

    samples: int = 0
    runs: int = 0
    elapsed: float = 0.0
    last_time: float = np.nan

    def with_run(self) -> "StreamProgress":
        """Return the progress after a run has begun."""
        return replace(self, runs=self.runs + 1, last_time=np.nan)

    def with_sample(self, time: float) -> "StreamProgress":
        """Return the progress after a sample at `time` [s]."""
        step = 0.0 if np.isnan(self.last_time) else time - self.last_time
        return StreamProgress(self.samples + 1, self.runs, self.elapsed + step, time)


def first_snapshot(model: Model) -> Snapshot:
    """Return the snapshot before the first sample: start values, infinite standard errors."""
    free = model.parameters.free
    return Snapshot(
        time=0.0,
        samples=0,
        runs=0,
        phase=EstimatorPhase.WAITING,
        names=tuple(p.name for p in free),
        units=tuple(p.unit for p in free),
        value=np.array([p.value for p in free]),
        standard_error=np.full(len(free), np.inf),
        advice="too few samples yet" if free else "",
    )


def window_snapshot(
    snapshot: Snapshot, model: Model, phase: KeptPhase, estimate: WindowEstimate, change: CoefficientChange | None
) -> Snapshot:
    """Return the snapshot with the window's estimate; `phase` says whether earlier information is part of it."""
    outputs = estimate.estimate.problem.data.outputs
    rms = np.sqrt(np.nanmean(estimate.residuals**2, axis=0)).tolist()
    label = EstimatorPhase.RECURSIVE if isinstance(phase, Carried) else EstimatorPhase.WINDOW
    snapshot = replace(snapshot, phase=label, noise=dict(zip(outputs, rms, strict=True)), change=change)
    return _with_values(snapshot, model, estimate.value, estimate.covariance)


def recursive_snapshot(snapshot: Snapshot, model: Model, phase: RecursivePhase) -> Snapshot:
    """Return the snapshot with the filter's estimate."""
    snapshot = replace(snapshot, phase=EstimatorPhase.RECURSIVE, noise=phase.noise, change=phase.change)
    return _with_values(snapshot, model, phase.value, phase.covariance)


def at_progress(snapshot: Snapshot, progress: StreamProgress) -> Snapshot:
    """Return the snapshot at the moment of the latest sample."""
    return replace(snapshot, time=progress.last_time, samples=progress.samples, runs=progress.runs)


def _with_values(snapshot: Snapshot, model: Model, value: Array, covariance: Array) -> Snapshot:
    """A coefficient is identified where its standard error is below its value or its scale."""
    error = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    free = zip(model.parameters.free, value, error, strict=True)
    unidentified = tuple(p.name for p, v, s in free if s > max(abs(v), p.scale))
    return replace(snapshot, value=value, standard_error=error, unidentified=unidentified, advice="")
