"""Waves that the motions contradict as stated: a probe upside down or elsewhere, another speed of encounter."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, InputError, Severity
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate.assemble import output_error_problem, training_runs
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.settings import WEAK_FORM_SHIP_LENGTHS
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.identify.identification import Identification
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.physics.sea.wave_forces import with_wave_forces

_SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8)  # of the ship's length, of the probe to either side; chosen
_SPEEDS = (0.8, 0.9, 1.1, 1.2)  # over the stated one; chosen
# of the residuals, and of the motion's standard deviation, of what the reading that is named leaves at most: beside
# forces of a box for a hull's a wrong one leaves 0.67 of the residuals, and does not follow closely; chosen
_MOST_LEFT, _CLOSE = 0.6, 0.1
_EVALUATIONS, _ROUNDS = 12, 2  # of each short fit; chosen


@dataclass(frozen=True)
class WaveReading:
    """How the waves may have been met other than stated.

    Attributes:
        sign: of the elevation; forward: m, of the probe ahead of its stated place; speed: over that stated.
    """

    sign: float = 1.0
    forward: float = 0.0
    speed: float = 1.0

    @property
    def text(self) -> str:
        """Return what it says, in words."""
        if self.sign < 0.0:
            return "the elevation zeta is positive down"
        if self.forward:
            way = "forward" if self.forward > 0.0 else "aft"
            return f"the probe stands {significant(abs(self.forward), 2)} m {way} of where the trial says"
        return f"the craft meets the waves at {significant(self.speed, 2)} of the speed that the trial says"

    def reread(self, item: TrialRecord) -> TrialRecord:
        """Return a run with the forces of waves that are met so; one without an elevation stays as it is."""
        if item.waves is None or "zeta" not in item.record:
            return item
        zeta = item.record.channel("zeta")
        moved = replace(zeta.with_values(self.sign * zeta.values), reference_point=zeta.reference_point + self.forward)
        channels = {n: c for n, c in item.record.channels.items() if n not in ("F3", "M5")} | {"zeta": moved}
        waves = replace(item.waves, U=self.speed * item.waves.U)
        bare = replace(item.record, channels=channels)
        return replace(item, record=with_wave_forces(bare, waves.excitation, waves.U, waves.beta), waves=waves)


def contradicted_waves(task: Identification) -> Finding | None:
    """Return a warning `sensor-error` with the reading of the waves that explains the motions far better; None: none.

    Each is tried by a short fit of output error; one with a craft that does not come to rest is none.
    """
    if not any(r.waves is not None and "zeta" in r.record for r in task.train):
        return None
    places = [WaveReading(forward=side * share * task.runs.length) for share in _SHARES for side in (-1.0, 1.0)]
    readings = [WaveReading(sign=-1.0), *places, *(WaveReading(speed=share) for share in _SPEEDS)]
    fits = {reading: _short_fit(task, reading) for reading in readings}
    stated = _short_fit(task, WaveReading())
    left = {reading: _unexplained(fit) for reading, fit in fits.items() if fit is not None and _comes_to_rest(fit)}
    if stated is None or not left:
        return None
    best, before = min(left, key=lambda reading: left[reading]), _unexplained(stated)
    return _finding(best, left[best], before) if left[best] <= min(_MOST_LEFT * before, _CLOSE) else None


def _short_fit(task: Identification, reading: WaveReading) -> PointEstimate | None:
    """The fit of a few evaluations; None: no such craft can meet such waves."""
    try:
        runs = training_runs(task.trial, [reading.reread(r) for r in task.train])
        problem = output_error_problem(task.trial.model, runs, np.inf, task.settings)
    except InputError:
        return None
    with np.errstate(all="ignore"):  # a search may pass craft that run away
        start = find_start(problem, runs.records, WEAK_FORM_SHIP_LENGTHS * task.characteristic_time)
        return fit_output_error(
            start.problem, start.common_parameters, start.initial_states, runs.noise,
            rounds=_ROUNDS, evaluations=_EVALUATIONS, further_searches=0,
        )  # fmt: skip


def _unexplained(fit: PointEstimate) -> float:
    """Root mean square of the residuals over the motion's spread."""
    return float(np.sqrt(np.nanmean((fit.residuals() / np.nanstd(fit.problem.data.measured, axis=0)) ** 2)))


def _comes_to_rest(fit: PointEstimate) -> bool:
    """Whether the free motion of a linear model dies out."""
    problem = fit.problem
    model = problem.model.with_values(dict(zip(problem.free, fit.common_parameters.tolist(), strict=False)))
    nx, width = len(model.states), len(model.states) + len(model.inputs) + len(model.parameters)
    out, jacobian = np.empty((1, nx)), np.zeros((1, nx, width))
    at_rest = np.zeros((1, nx)), np.zeros((1, len(model.inputs))), model.parameters.values[None]
    evaluate_tangent(model.compiled.rates_tangent, *at_rest, 1.0, out, jacobian)
    return bool(np.max(np.linalg.eigvals(jacobian[0, :, :nx]).real) < 0.0)


def _finding(reading: WaveReading, least: float, stated: float) -> Finding:
    return Finding(
        Severity.WARNING, "sensor-error", f"the motions contradict the waves as they are stated: {reading.text}",
        f"tried here: read so, they leave {significant(least, 2)} of the motions unexplained, as stated "
        f"{significant(stated, 2)} (standard deviations)",
    )  # fmt: skip
