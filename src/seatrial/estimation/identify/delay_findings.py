"""Delays of inputs that are longer than what their sample interval leaves open: the recorder's, or the model's.

A lag of first order between the record and what acts is tried in the place of such a delay: machinery, an order that
was recorded for the angle, or the filter of a compass, which one input and one output do not distinguish.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.text.words import NAMES_SHOWN, enumeration
from seatrial.core.values import Array, Finding, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.timing import UNIFORM
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import join_segments
from seatrial.numerics.optimise import levenberg_marquardt

_CERTAIN = 2.0  # standard errors by which a delay has to exceed a sample, 95 %
_LAGS = np.geomspace(0.5, 4.0, 12)  # times of a lag that are tried, over the delay; chosen
_EVALUATIONS = 40  # of each search with a lag; chosen
_MOST_LEFT = 0.95  # of the residuals' standard deviation that a lag leaves where it is named; chosen


def delay_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning `input-delay` for each input whose estimated delay exceeds its sample interval in a session."""
    problem, error = estimation.estimate.problem, estimation.interval.standard_error
    first, width = len(problem.session_parameters), problem.unknowns_per_session
    found = []
    for j, nuisance in enumerate(problem.nuisances, start=first):
        if nuisance.correction.kind != "delay":
            continue
        sample = UNIFORM * nuisance.prior.standard_deviation if nuisance.is_spread_fixed else problem.data.dt
        delays = estimation.estimate.session_offsets[:, j]
        errors = error[len(problem.free) :].reshape(-1, width)[:, j]
        late = {
            s: float(d)
            for s, d, e in zip(problem.data.sessions, delays, errors, strict=True)
            if abs(d) - _CERTAIN * e > sample
        }
        if late:
            name = nuisance.correction.input
            remedy = _lag_remedy(estimation, name, max(late.values(), key=abs))
            found.append(_finding(name, late, sample, remedy))
    return tuple(found)


@dataclass(frozen=True)
class _Lag:
    """What a lag of an input leaves: its time [s], residuals over those without it, the coefficients with it."""

    time: float
    remainder: float
    values: tuple[tuple[str, float], ...]

    @property
    def sentence(self) -> str:
        """Return that in words."""
        values = enumeration([f"{name} {significant(value, 3)}" for name, value in self.values], NAMES_SHOWN)
        return (
            f"tried here: a lag of {significant(self.time, 2)} s between its record and the craft leaves "
            f"{significant(self.remainder, 2)} of the residuals, with {values}"
        )


def _lag_remedy(estimation: Estimation, name: str, delay: float) -> _Lag | None:
    """The lag of an input that leaves least by output error over whole runs; None where none leaves clearly less."""
    problem, first = join_segments(estimation.estimate.problem)
    if delay <= 0.0 or problem.pinned is not None:
        return None
    problem = replace(problem, data=replace(problem.data, run_inputs=None))
    point, local = estimation.estimate.common_parameters, estimation.estimate.optimum.local[first]
    column = problem.model.input_names.index(name)
    fits = []
    for time in (0.0, *(delay * _LAGS).tolist()):
        lagged = _with_lag(problem, column, time)
        found = levenberg_marquardt(lagged, point, local, evaluations=_EVALUATIONS)
        error = lagged.simulated_outputs(found.solution.point, found.local) - problem.data.measured
        fits.append((time, float(np.sqrt(np.nanmean((error / problem.noise) ** 2))), found.solution.point))
    time, left, values = min(fits, key=lambda fit: fit[1])
    if not left <= _MOST_LEFT * fits[0][1]:
        return None
    return _Lag(time, left / fits[0][1], tuple(zip(problem.free, map(float, values), strict=False)))


def _with_lag(problem: OutputError, column: int, time: float) -> OutputError:
    """The problem with an input that follows its record by a lag of first order, at rest where a run begins."""
    if time == 0.0:
        return problem
    model, inputs = problem.model, problem.data.inputs.copy()
    name = model.input_names[column]
    for a, b in pairwise(problem.data.offsets):
        inputs[a:b, column] = lagged_values(inputs[a:b, column], time / problem.data.dt, is_held=name in model.held)
    return replace(
        problem, model=model.with_held(model.held - {name}), data=replace(problem.data, inputs=inputs)
    )  # fmt: skip


def lagged_values(values: Array, samples: float, *, is_held: bool) -> Array:
    """Return values behind a lag of first order, (n,), exact where they are held or run straight between samples.

    samples: the lag's time constant.
    """
    from scipy.signal import lfilter

    keep = np.exp(-1.0 / samples)
    share = samples * (1.0 - keep)
    weights = np.array([0.0, 1.0 - keep] if is_held else [1.0 - share, share - keep])
    return np.asarray(lfilter(weights, [1.0, -keep], values, zi=[(1.0 - weights[0]) * values[0]])[0])


def _finding(name: str, delays: dict[str, float], sample: float, remedy: _Lag | None) -> Finding:
    longest = max(delays.values(), key=abs)
    sizes = enumeration([f"{significant(d, 2)} s in {s}" for s, d in delays.items()], NAMES_SHOWN)
    way = "after" if longest > 0.0 else "before"
    return Finding(
        Severity.WARNING, "input-delay", f"{name} acts more than a sample {way} its record",
        f"{sizes}; a sample every {significant(sample, 2)} s" + (f"; {remedy.sentence}" if remedy else ""),
        "compare the clocks of the recorders; with one clock, model the lag of the machinery or of a sensor",
        "the recorder's stamps are off, or the model lacks a lag; coefficients absorb the rest of it",
    )  # fmt: skip
