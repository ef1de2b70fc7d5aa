"""Which criterion the records call for: the decision table from an estimate over segments onwards."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.values import Array, Progress
from seatrial.estimation.estimate.coloured import coloured
from seatrial.estimation.estimate.estimate import Estimate, colour, residual_spread
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.process_noise import (
    ProcessNoise,
    intensities,
    is_worthwhile,
    prediction_error,
    suited,
)
from seatrial.estimation.estimate.settings import WHITE_INFLATION, Criterion, Settings
from seatrial.estimation.problem.output_error import OutputError

PREDICTION_ERROR, WHOLE_RUNS = "prediction error", "output error over whole runs"
_COLOURED = "coloured residuals mean model error or process noise"
_KEPT_SHORT = "segments keep it from accumulating"
_TOO_COARSE = "samples too far apart for prediction error, which takes inputs as straight between them"
_DECAY = "a free decay, which its initial state explains: whole runs tell what one decay has in common with the next"
_WHITE = "residuals are white within segments and over whole runs: no process noise to guard against"
_NO_LARGER = 1.05
_TURN = 0.3
_EXPLAINED = 0.1


@dataclass(frozen=True, eq=False)
class Found:
    """A criterion's optimum, what it leaves, and why it is used.

    Attributes:
        residuals: simulated minus measured, under prediction error one step ahead, (rows, ny), SI.
        inflation: variance inflation of each channel's residuals, (ny,); rho: their autocorrelations.
        process: intensities of process noise that suit the estimate; noise: the prediction-error optimum, if used.
        beside: what suits an output-error estimate over a few whole runs, where it makes one-step residuals white.
    """

    made: Estimate
    residuals: Array
    inflation: Array
    rho: list[Array]
    criterion: str
    reasons: tuple[str, ...]
    process: dict[str, float] = field(default_factory=dict)
    noise: ProcessNoise | None = None
    beside: ProcessNoise | None = None

    @property
    def is_white(self) -> bool:
        """Whether nothing but noise is left."""
        return bool(np.max(self.inflation) <= WHITE_INFLATION)

    def because(self, *reasons: str) -> "Found":
        """The same with more reasons."""
        return replace(self, reasons=(*self.reasons, *reasons))


def decided(
    shooting: Estimate,
    seconds: float,
    settings: Settings,
    whole_runs: Callable[[], Estimate | None],
    progress: Progress | None,
    *,
    is_undriven: bool = False,
) -> Found:
    """The criterion to use; `shooting` is the estimate over segments of `seconds`, `whole_runs` makes the other one.

    is_undriven: nothing moves the ship but her initial state.
    """
    shot = _left(shooting, _named(seconds))
    match settings.criterion:
        case Criterion.OUTPUT_ERROR | Criterion.MULTIPLE_SHOOTING:
            return _asked_for(shot, settings, "the criterion was asked for")
        case Criterion.PREDICTION_ERROR:
            noise = prediction_error(shooting, settings.noise, thorough=True, progress=progress)
            return _predicted(noise, "it was asked for", noise.gate.text)
        case Criterion.AUTO if is_undriven and _explains(shot):
            return _asked_for(shot, settings, _DECAY)
        case Criterion.AUTO:
            pass
    if settings.segment_seconds is not None:
        return _asked_for(shot, settings, "the length of segments was asked for")
    whole = _fitting(shot, whole_runs()) if shot.is_white else None
    if whole is not None and whole.is_white:
        return whole.because(_WHITE)
    if shot.is_white and whole is None:
        shot = shot.because("whole runs do not fit within the noise of the segments")
    if settings.robust or not is_worthwhile(shooting):
        return shot.because(_COLOURED, _KEPT_SHORT)
    if is_coarse(shooting.problem):
        return shot.because(_COLOURED, _TOO_COARSE)
    noise = prediction_error(shooting, settings.noise, progress=progress)
    if noise.gate.is_needed and not noise.gate.is_white:
        noise = coloured(noise, progress=progress)
    if noise.gate.holds:
        added = (f"added to the model: {noise.colours}",) if noise.colours else ()
        return _predicted(noise, *shot.reasons, noise.gate.text, *added)
    if whole is not None and not noise.gate.is_needed:
        return whole.because(noise.gate.text)
    return replace(shot.because(noise.gate.text, _KEPT_SHORT), process=noise.process)


def is_coarse(problem: OutputError) -> bool:
    """Whether a continuous input of a linear model turns by more than .3 rad from sample to sample.

    Its power lies below that frequency but for 5 %; straight lines between samples then flatten it by (w dt)^2 / 12.
    """
    model, data = problem.model, problem.data
    if not model.is_affine:
        return False
    for j, channel in enumerate(model.inputs):
        values = data.inputs[:, j]
        if not channel.is_held and np.ptp(values) > 0.0:
            power = np.abs(np.fft.rfft(values - np.mean(values))) ** 2
            place = int(np.searchsorted(np.cumsum(power), 0.95 * np.sum(power)))
            if 2.0 * np.pi * place / len(values) > _TURN:
                return True
    return False


def _asked_for(shot: Found, settings: Settings, reason: str) -> Found:
    """The user's own choice; what it leaves coloured is measured as process noise, for the floor of predictions."""
    if shot.is_white or not is_worthwhile(shot.made):
        return shot.because(reason)
    if shot.criterion == WHOLE_RUNS and len(shot.made.problem.data.runs) < RUNS_FOR_JACKKNIFE and not settings.robust:
        noise = suited(shot.made, settings.noise)
        beside = noise if noise.gate.is_white else None
        return replace(shot.because(reason, _COLOURED), process=noise.process, beside=beside)
    told = (_COLOURED,) if shot.criterion == WHOLE_RUNS else (_COLOURED, _KEPT_SHORT)
    return replace(shot.because(reason, *told), process=intensities(shot.made, settings.noise))


def _explains(shot: Found) -> bool:
    """Whether a tenth of each channel's spread or less is left."""
    measured = np.nanstd(shot.made.problem.data.measured, axis=0)
    return bool(np.all(np.nanstd(shot.residuals, axis=0) <= _EXPLAINED * measured))


def _fitting(shot: Found, whole: Estimate | None) -> Found | None:
    """The estimate over whole runs, if its residuals are no larger (5 %) than within segments."""
    if whole is None:
        return None
    left = _left(whole, WHOLE_RUNS)
    within, over = (residual_spread(f.made.problem, f.residuals) for f in (shot, left))
    return replace(left, reasons=(*shot.reasons, *left.reasons)) if np.all(over <= _NO_LARGER * within) else None


def _named(seconds: float) -> str:
    return WHOLE_RUNS if np.isinf(seconds) else f"output error, multiple shooting with segments of {seconds:.3g} s"


def _left(made: Estimate, criterion: str) -> Found:
    residuals = made.residuals()
    rho, inflation = colour(made.problem, residuals)
    where = "over whole runs" if criterion == WHOLE_RUNS else "within segments"
    said = f"the residuals' correlation {where} inflates variances by {np.max(inflation):.3g}"
    if np.max(inflation) > WHITE_INFLATION:
        said += ", and correlated samples count as their effective number, so that priors keep their weight"
    return Found(made, residuals, inflation, rho, criterion, (said,))


def _predicted(noise: ProcessNoise, *reasons: str) -> Found:
    made, innovations = noise.as_estimate(), noise.problem.innovations(noise.optimum.solution.point)
    rho, inflation = colour(made.problem, innovations.normalised)
    return Found(made, -innovations.e, inflation, rho, PREDICTION_ERROR, reasons, noise.process, noise)
