"""What a run that was not fitted has of its own, and what a fit predicts of it some samples ahead."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import SessionOffset
from seatrial.core.results.prediction import KStepErrors
from seatrial.core.values import Array, Index, InputError, Prior, Record
from seatrial.core.values.notation import channel_unit
from seatrial.data.check import sample_noise
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.criterion_choice import is_coarsely_sampled
from seatrial.estimation.estimate.fit import Estimation, choice_runs
from seatrial.estimation.estimate.point_estimate import PointEstimate, with_steps_of_start
from seatrial.estimation.estimate.process_noise import initial_problem, third_difference_noise
from seatrial.estimation.estimate.settings import INITIAL_STATE_SHIP_LENGTHS, resolved_time
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.predict.open_loop import simulate_open_loop
from seatrial.estimation.predict.windows import EVALUATIONS, Windows
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.population import SessionPopulation
from seatrial.estimation.problem.prediction_error import PredictionError, over_runs
from seatrial.estimation.problem.segments import compared_outputs, cut_segments, segments_between
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.replay import inputs_of

# What a run that was not fitted has of its own: its session's estimate, or what the population of sessions expects.


@dataclass(frozen=True, eq=False)
class SessionOffsets:
    """Offsets with which a run is simulated, (k,), SI, and the covariance of what they may be instead, (k, k)."""

    expected: Array
    covariance: Array


def new_session_offsets(estimate: PointEstimate, record: Record) -> SessionOffsets:
    """Return what a session that no training run belongs to is expected to have: the population's mean and variance.

    Raises:
        InputError: the record lacks an input.
    """
    covariates = estimate.problem.covariates_of(inputs_of(estimate.problem.model, record))
    population = estimate.population
    return SessionOffsets(population.means(covariates), population.new_session_covariance)


def session_offsets(estimation: Estimation, session: str, record: Record) -> SessionOffsets:
    """Return what a run of this session has: the session's own estimate where it was fitted, else as of a new session.

    Raises:
        InputError: the record lacks an input.
    """
    estimate = estimation.estimate
    problem = estimate.problem
    if session not in problem.data.sessions:
        return new_session_offsets(estimate, record)
    index = problem.data.sessions.index(session)
    own = problem.offset_columns(index)
    return SessionOffsets(estimate.session_offsets[index], estimation.interval.covariance[np.ix_(own, own)])


def updated_by_start(
    template: OutputError, model: Model, offsets: SessionOffsets, record: Record, seconds: float
) -> SessionOffsets:
    """Return offsets that the first seconds of a run make likely, with those expected before it as the prior.

    Initial state and offsets are estimated together, the model held, its outputs weighted as in the fit: by the
    residuals it left there and their effective number of samples. On board this much of a run is known when it begins.

    Raises:
        InputError: the record lacks an input.
    """
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    bounds = Windows.of_record(record).beginnings(seconds).bounds
    deviations = np.sqrt(np.diag(offsets.covariance))
    declared = [Prior(float(m), float(d), "population") for m, d in zip(offsets.expected, deviations, strict=True)]
    problem = replace(
        template,
        model=held,
        data=segments_between(held, [record], template.data.outputs, bounds),
        population=SessionPopulation.as_declared(declared, np.zeros((1, len(declared)))),
        extra_terms=(),
        prior_terms=(),
    )
    optimum = levenberg_marquardt(problem, offsets.expected, problem.measured_initial_states(), evaluations=EVALUATIONS)
    return SessionOffsets(optimum.solution.point, inverse(optimum.normal.without_local()[1]))


def offsets_without(template: OutputError, point: Array, session: str, record: Record) -> Array:
    """Return what a run of `session` is expected to have by the other sessions at the shared unknowns `point`, (k,).

    Where there is no other session, the expectation is that of the population.

    Raises:
        InputError: the record lacks an input.
    """
    population = template.population or template.declared_population
    new = template.covariates_of(inputs_of(template.model, record))
    rest = [s != session for s in template.data.sessions]
    if not any(rest):
        return population.means(new)
    offsets = point[len(template.free) :].reshape(len(rest), template.unknowns_per_session)
    return population.of_new_session(offsets[rest], template.session_covariates[rest], new)


# A measured run by a model that was fitted before: start from its first seconds, inputs corrected as in the fit.

_START_SHARE = 0.1  # of a run, whose beginning shows its initial state where the ship's length is not known; chosen
_LEAST_NOISE = 1e-6  # of a channel's largest value: one without noise is no better known; chosen
_ANY_DEVIATION = 1.0  # SI, of an offset that is known: none is estimated, and it counts nothing
_SMALLEST = 1e-12  # SI, noise of a channel that is zero throughout; chosen


def simulate_measured(
    model: Model, record: Record, length: float, offsets: Sequence[SessionOffset] = (), session: str | None = None
) -> tuple[Record, float]:
    """Return the run simulated from its inputs, and the seconds of it that its initial state is estimated from.

    Args:
        length: of the ship, m; 0 where it is not known.
        offsets: of the fit, with which the logged inputs are corrected.
        session: that the run belongs to; None as `SessionOffset.value_in`.

    Raises:
        InputError: an input is missing, the time base is uneven, the session is unknown, or the simulation diverges.
    """
    seconds = _start_seconds(model, record, length)
    values = np.array([offset.value_in(session) for offset in offsets])
    template = _template(model, record, offsets)
    template = with_steps_of_start(template, values, template.measured_initial_states())
    return simulate_open_loop(template, model, record, values, seconds).record, seconds


def _template(model: Model, record: Record, offsets: Sequence[SessionOffset]) -> OutputError:
    """The problem whose unknowns of a session are these offsets, weighted by the noise of the record's samples."""
    outputs = compared_outputs(model, [record])
    noise = [
        np.nanmax(
            [sample_noise(record.channel(name).readings), _LEAST_NOISE * np.nanmax(np.abs(record[name])), _SMALLEST]
        )
        for name in outputs
    ]
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    known = {offset.name: Prior(offset.expected, _ANY_DEVIATION, "of the fit, and held") for offset in offsets}
    own = [offset for offset in offsets if offset.name in model.parameters]
    corrections = [offset for offset in offsets if offset.name not in model.parameters]
    return OutputError(
        held,
        cut_segments(held, [record], outputs, None),
        np.array(noise),
        tuple(
            Nuisance(InputCorrection(*correction.correction), known[correction.name], correction.unit)
            for correction in corrections
        ),
        tuple((one.name, known[one.name]) for one in own),
    )


def _start_seconds(model: Model, record: Record, length: float) -> float:
    try:
        seconds = INITIAL_STATE_SHIP_LENGTHS * resolved_time(model, [record], length)
    except InputError:  # neither speed nor positions were recorded
        seconds = 0.0
    return seconds or _START_SHARE * record.duration


# Errors some samples ahead: the fit's Kalman filter up to a moment, model and recorded inputs after it.

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
    predicted, last, measured = (np.concatenate(values) for values in zip(*runs_ahead, strict=True))
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


def _run_ahead(over: _Filter, segment: int, steps: Sequence[int], most: int) -> tuple[Array, ...]:
    """Outputs at horizons after some moments of a run, (moments, horizons, ny): predicted, last measured, measured.

    So many moments at most; NaN where a horizon reaches beyond the run.

    The first quarter of the run is left to the filter to forget its initial state.
    """
    data = over.problem.runs.data
    measured = data.measured[data.offsets[segment] : data.offsets[segment + 1]]
    rows = len(measured)
    first = rows // 4
    longest = max((k for k in steps if k < rows - first), default=0)
    if not longest or not most:
        return tuple(np.full((0, len(steps), measured.shape[1]), np.nan) for _ in range(3))
    origins: Index = np.unique(np.linspace(first, rows - 1 - longest, most).round().astype(np.int64))
    within = [k for k in steps if k <= longest]
    rest = ((0, 0), (0, len(steps) - len(within)), (0, 0))
    ahead = over.problem.predicted_ahead(over.point, segment, origins, longest)[:, within]
    target = measured[origins[:, None] + np.array(within)]
    last = np.repeat(measured[origins][:, None], len(within), axis=1)
    return tuple(np.pad(values, rest, constant_values=np.nan) for values in (ahead, last, target))


def _rms(errors: Array) -> Array:
    """Root mean square of each column; NaN where a column has no sample."""
    count = np.isfinite(errors).sum(axis=0)
    return np.sqrt(np.nansum(errors**2, axis=0) / np.where(count, count, np.nan))
