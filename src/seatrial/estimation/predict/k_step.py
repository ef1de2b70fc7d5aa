"""Errors some samples ahead: the fit's Kalman filter up to a moment, model and recorded inputs after it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.results.prediction import KStepErrors
from seatrial.core.values import Array, Index, InputError
from seatrial.core.values.notation import channel_unit
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.estimate.criterion_choice import is_coarsely_sampled
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.large_records import choice_runs
from seatrial.estimation.estimate.process_noise import initial_problem, third_difference_noise
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.predict.session_offsets import session_offsets
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError, over_runs
from seatrial.estimation.problem.segments import cut_segments

DEFAULT_STEPS = (1, 3, 10, 30, 100, 300)
"""Horizons where none are required [samples], as far as they last a quarter of the longest run; chosen."""
_MOST_SHARE = 0.25
MOST_ORIGINS = 1000
"""Moments from which predictions start, evenly spread over all runs of a role; chosen."""


@dataclass(frozen=True)
class Horizon:
    """How far ahead: so many samples, or seconds where `is_seconds`."""

    value: float
    is_seconds: bool

    def steps(self, dt: float) -> int:
        """Return the horizon in samples, one at least."""
        return max(1, round(self.value / dt if self.is_seconds else self.value))


def horizon_list(text: str) -> tuple[Horizon, ...]:
    """Return the horizons that a text such as ``1,10,5s`` names: samples, or seconds with s.

    Raises:
        InputError: a part is no positive number, or no whole number of samples.
    """
    parts = [p.strip() for p in text.split(",") if p.strip()]
    matches = [re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*(s?)", p) for p in parts]
    for part, match in zip(parts, matches, strict=True):
        if match is None or not float(match[1]) > 0.0 or (not match[2] and "." in match[1]):
            raise InputError(f"--horizons: '{part}' is no horizon; write samples or seconds, as 1,10,5s")
    return tuple(Horizon(float(m[1]), bool(m[2])) for m in matches if m is not None)


@dataclass(frozen=True, eq=False)
class _Filter:
    """A prediction-error problem over some runs, and its point."""

    problem: PredictionError
    point: Array


def k_step_errors(
    estimation: Estimation, items: Sequence[TrialRecord], required: Sequence[Horizon] = ()
) -> tuple[KStepErrors, ...]:
    """Return the errors of each compared channel ahead of many moments, over training runs and over validation runs.

    The filter has the disturbance of the fit; where the estimate comes from segments, the process noise that suits it
    and sensor noise from third differences. Empty where samples are too far apart for a filter that takes inputs as
    straight between them. Of very long records some stretches stand for all.
    """
    if is_coarsely_sampled(estimation.estimate.problem):
        return ()
    base = _fitted_filter(estimation)
    errors: list[KStepErrors] = []
    for role, name in ((Role.TRAIN, "training"), (Role.VALIDATE, "validation")):
        mine = [i for i in items if i.role is role]
        if mine:
            runs = Runs(tuple(i.record for i in mine), tuple(i.session for i in mine), 0.0)
            errors += _errors(estimation, base, choice_runs(runs) or runs, name, required)
    return tuple(errors)


def _fitted_filter(estimation: Estimation) -> _Filter:
    noise = estimation.process_noise
    if noise is not None:
        return _Filter(noise.problem, noise.optimum.solution.point)
    problem = initial_problem(estimation.estimate, {}, ())
    intensity = np.array([estimation.noise_model.process.get(s, 0.0) for s in problem.process])
    deviation = problem.runs.noise
    if np.any(intensity > 0.0):  # residuals over segments hold more than noise
        deviation = third_difference_noise(problem.runs)
    return _Filter(problem, np.concatenate([estimation.estimate.common_parameters, intensity**2, deviation**2]))


def _errors(
    estimation: Estimation, base: _Filter, runs: Runs, role: str, required: Sequence[Horizon]
) -> list[KStepErrors]:
    over = _over(estimation, base, runs)
    data = over.problem.runs.data
    channels = estimation.estimate.problem.data.outputs
    rows = np.diff(data.offsets)
    wanted = [h.steps(data.dt) for h in required] or [k for k in DEFAULT_STEPS if k <= _MOST_SHARE * np.max(rows)]
    steps = sorted({k for k in wanted if k < np.max(rows) - 1})
    if not steps:
        return []
    shares = MOST_ORIGINS * rows // np.sum(rows)
    runs_ahead = [_run_ahead(over, s, steps, int(most)) for s, most in enumerate(shares)]
    predicted, last, measured = (
        np.concatenate(values) for values in zip(*((r.predicted, r.last, r.measured) for r in runs_ahead), strict=True)
    )
    seconds = tuple(float(k * data.dt) for k in steps)
    result = []
    for j, channel in enumerate(channels):
        target = measured[:, :, j]
        rms, held = _rms(predicted[:, :, j] - target), _rms(last[:, :, j] - target)
        spread = _rms(target - np.nanmean(target, axis=0)) if np.isfinite(rms).all() else np.zeros(1)
        if np.all(spread > 0.0):
            fit, count = 100.0 * (1.0 - rms / spread), np.isfinite(target).sum(axis=0)
            columns = (tuple(values.tolist()) for values in (rms, fit, held, count))
            result.append(KStepErrors(channel, channel_unit(channel), role, tuple(steps), seconds, *columns))
    return result


def _over(estimation: Estimation, base: _Filter, runs: Runs) -> _Filter:
    """The filter over other runs: coefficients and noise as they are, of each session what it has of its own."""
    template = estimation.estimate.problem
    data = cut_segments(template.model, runs.records, template.data.outputs, None, runs.sessions)
    output_error: OutputError = replace(template, data=data, inflation=None)
    old, point = base.problem.runs, base.point
    first = dict(reversed(list(zip(runs.sessions, runs.records, strict=True))))
    nuisances = [session_offsets(estimation, s, first[s]).expected for s in data.sessions]
    shared = np.concatenate([point[: len(old.free)], *nuisances, point[old.size :]])
    return _Filter(over_runs(base.problem, output_error), shared)


@dataclass(frozen=True, eq=False)
class _RunAhead:
    """Outputs at horizons after some moments of a run, (moments, horizons, ny): predicted, last measured, measured."""

    predicted: Array
    last: Array
    measured: Array


def _run_ahead(over: _Filter, segment: int, steps: Sequence[int], most: int) -> _RunAhead:
    """Predictions from so many moments of a run at most; NaN where a horizon reaches beyond the run.

    The first quarter of the run is left to the filter to forget its initial state.
    """
    data = over.problem.runs.data
    measured = data.measured[data.offsets[segment] : data.offsets[segment + 1]]
    rows = len(measured)
    first = rows // 4
    longest = max((k for k in steps if k < rows - first), default=0)
    if not longest or not most:
        return _RunAhead(*(np.full((0, len(steps), measured.shape[1]), np.nan) for _ in range(3)))
    origins: Index = np.unique(np.linspace(first, rows - 1 - longest, most).round().astype(np.int64))
    within = [k for k in steps if k <= longest]
    rest = ((0, 0), (0, len(steps) - len(within)), (0, 0))
    ahead = over.problem.predicted_ahead(over.point, segment, origins, longest)[:, within]
    target = measured[origins[:, None] + np.array(within)]
    last = np.repeat(measured[origins][:, None], len(within), axis=1)
    return _RunAhead(*(np.pad(values, rest, constant_values=np.nan) for values in (ahead, last, target)))


def _rms(errors: Array) -> Array:
    """Root mean square of each column; NaN where a column has no sample."""
    count = np.isfinite(errors).sum(axis=0)
    return np.sqrt(np.nansum(errors**2, axis=0) / np.where(count, count, np.nan))
