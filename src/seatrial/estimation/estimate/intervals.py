"""Which interval is defensible for a fit, the interval itself, and what it is worth where disturbances act."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array, Index, InputError
from seatrial.estimation.estimate.disturbance_choice import DisturbanceChoice
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import NoiseEvidence, ProcessNoise
from seatrial.estimation.estimate.settings import WHITE_INFLATION, IntervalMethod
from seatrial.estimation.information.covariance import (
    Interval,
    RunScores,
    bootstrap,
    from_information,
    inverse,
    jackknife,
    sandwich,
    with_prior,
)
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import map_in_threads

# What an output-error estimate is worth where disturbances of the states or slow forces act.

# The same estimate from other runs: one left out each, or as many drawn with replacement.

ReportCount = Callable[[int, int], None]

# promised decrease of the cost at which a refit ends, ours
_NEGLIGIBLE = 1e-4


def one_step_jackknife(estimate: PointEstimate, groups: Sequence[Sequence[int]] | None = None) -> Array:
    """Shared unknowns with each group of runs left out by one Gauss-Newton step from stored normal equations.

    groups: positions of runs; None: each run by itself. Returns (groups, k).
    """
    return estimate.common_parameters + run_scores(estimate, groups).left_out_steps


def run_scores(estimate: PointEstimate, groups: Sequence[Sequence[int]] | None = None) -> RunScores:
    """Return what each group of runs says of the shared unknowns at the estimate; None: each run by itself."""
    parts = _normals_of(estimate, groups or [[r] for r in range(len(estimate.problem.data.runs))])
    hessian = estimate.optimum.normal.without_local()[1]
    return RunScores.from_normals(hessian, np.array([g for g, _ in parts]), np.array([h for _, h in parts]))


@dataclass(frozen=True, eq=False)
class RunEstimates:
    """What each run by itself says of the shared unknowns: values and standard deviations, (runs, k); NaN: nothing.

    decreases: of each run's sum of squares over the noise, by values of its own, (runs,).
    """

    values: Array
    deviations: Array
    decreases: Array


def one_step_by_run(estimate: PointEstimate) -> RunEstimates:
    """Return the shared unknowns from each run alone, by one Gauss-Newton step from the joint estimate.

    theta_i - theta = -H_i^-1 g_i, with the covariance H_i^-1; priors are left out.
    """
    runs, size = len(estimate.problem.data.runs), len(estimate.common_parameters)
    values, deviations, decreases = np.full((runs, size), np.nan), np.full((runs, size), np.nan), np.zeros(runs)
    for k, (gradient, hessian) in enumerate(_normals_of(estimate, [[r] for r in range(runs)])):
        seen = np.flatnonzero(np.diag(hessian) > 0.0)
        covariance = inverse(hessian[np.ix_(seen, seen)])
        values[k, seen] = estimate.common_parameters[seen] - covariance @ gradient[seen]
        deviations[k, seen] = np.sqrt(np.diag(covariance))
        decreases[k] = gradient[seen] @ covariance @ gradient[seen]
    return RunEstimates(values, deviations, decreases)


def _normals_of(estimate: PointEstimate, groups: Sequence[Sequence[int]]) -> list[tuple[Array, Array]]:
    """Gradient and Hessian of each group of runs, local unknowns eliminated, priors left out."""
    problem = estimate.problem
    blocks = problem.segment_normals(estimate.common_parameters, estimate.optimum.local)
    return [
        problem.assemble(
            blocks, estimate.common_parameters, _segments_of(estimate, group), with_prior=False
        ).without_local()
        for group in groups
    ]


def full_jackknife(
    estimate: PointEstimate, workers: int | None = None, report_progress: ReportCount | None = None
) -> Array:
    """Shared unknowns with each run left out, fitted again in full, (runs, k)."""
    return fits_without(estimate, [[r] for r in range(len(estimate.problem.data.runs))], workers, report_progress)


def fits_without(
    estimate: PointEstimate,
    groups: Sequence[Sequence[int]],
    workers: int | None = None,
    report_progress: ReportCount | None = None,
) -> Array:
    """Shared unknowns with each group of runs (positions) left out, fitted again in full, (groups, k)."""
    runs = range(len(estimate.problem.data.runs))
    chosen = [_segments_of(estimate, [r for r in runs if r not in out]) for out in groups]
    return np.array(
        map_in_threads(lambda one: _refit(estimate, one), chosen, workers=workers, report_progress=report_progress)
    )


def _segments_of(estimate: PointEstimate, runs: Sequence[int]) -> Index:
    return np.concatenate([estimate.problem.data.run_segments(r) for r in runs])


def bootstrap_fits(
    estimate: PointEstimate,
    count: int,
    rng: np.random.Generator,
    workers: int | None = None,
    report_progress: ReportCount | None = None,
) -> Array:
    """Shared unknowns of `count` fits to runs drawn with replacement, (count, k) (Efron 1979)."""
    runs = len(estimate.problem.data.runs)
    draws = rng.integers(0, runs, (count, runs))
    chosen = [np.concatenate([estimate.problem.data.run_segments(r) for r in draw]) for draw in draws]
    return np.array(
        map_in_threads(lambda one: _refit(estimate, one), chosen, workers=workers, report_progress=report_progress)
    )


def _refit(estimate: PointEstimate, segments: Index) -> Array:
    """Shared unknowns fitted to some segments, begun at the joint optimum."""
    problem = replace(estimate.problem, data=estimate.problem.data.selected(segments), workers=1)
    local = estimate.optimum.local[segments]
    return levenberg_marquardt(problem, estimate.common_parameters, local, negligible=_NEGLIGIBLE).solution.point


# What an output-error estimate over whole runs is worth where white noise in the states disturbs them.

MEANING = {
    NoiseEvidence.ONE_STEP: "covariance of the output-error estimate under the process noise that makes one-step "
    "residuals white, carried through the motion",
    NoiseEvidence.WHOLE_RUNS: "covariance of the output-error estimate under process noise at least as strong as the "
    "residuals of whole runs show, carried through the motion",
}
"""What the interval is, by what shows how strong its process noise is."""


def process_noise_interval(estimate: PointEstimate, process_noise: ProcessNoise) -> Interval:
    """Interval of the shared unknowns of an estimate over whole runs under noise in the states that suits it."""
    problem, hessian = estimate.problem, estimate.optimum.normal.without_local()[1]
    score = problem.prior_score_variance(estimate.common_parameters)
    slopes = problem.slopes(estimate.common_parameters, estimate.optimum.local)
    trust = inverse_variances(problem)
    deviation = np.array(list(process_noise.measurement_noise.values()))
    intensity = np.array([process_noise.process_intensities.get(s, 0.0) for s in problem.model.states])
    for run, (a, b) in enumerate(pairwise(problem.data.offsets)):
        columns = problem.columns_of(int(problem.data.session[run]))
        own = without_initial_state(slopes[a:b], len(columns), trust[a:b])
        moved, observation = process_noise.problem.transitions(run, estimate.common_parameters, estimate.optimum.local)
        carried = own.transpose(0, 2, 1)
        white = np.einsum("tky,y,tly->kl", carried, deviation**2, carried)
        score[np.ix_(columns, columns)] += white + driven_variance(
            carried @ observation, moved, intensity**2 * problem.data.dt
        )
    bread = inverse(hessian)
    return Interval(bread @ score @ bread, np.inf, MEANING[process_noise.evidence])


def inverse_variances(problem: OutputError) -> Array:
    """Return what each sample weighs, (rows, ny): nothing where it is missing."""
    variance = problem.noise**2 if problem.inflation is None else problem.noise**2 * problem.inflation
    return np.where(np.isfinite(problem.data.measured), 1.0 / variance, 0.0)


def without_initial_state(slopes: Array, count: int, weights: Array) -> Array:
    """Return weighted slopes W J, (rows, ny, count), of the first columns, the others (initial state) eliminated."""
    weighted = slopes * weights[:, :, None]
    normal = np.einsum("tyk,tyl->kl", weighted, slopes)
    # rounding of a singular matrix; chosen
    solved = np.linalg.lstsq(normal[count:, count:], normal[count:, :count], rcond=1e-12)[0]
    return weighted[:, :, :count] - weighted[:, :, count:] @ solved


def driven_variance(score: Array, transitions: Array, variance: Array) -> Array:
    """Return the variance (k, k) of sum_t score_t x_t, x driven by white noise, half before and half after each step.

    score (rows, k, nx), moved (rows - 1, nx, nx) transition matrices, variance (nx,) of the noise in one step.
    """
    total, ahead = np.zeros((score.shape[1], score.shape[1])), np.zeros(score.shape[1:])
    for t in range(len(score) - 1, 0, -1):
        after = ahead + score[t]
        ahead = after @ transitions[t - 1]
        total += 0.5 * ((after * variance) @ after.T + (ahead * variance) @ ahead.T)
    return total


# How strong the process noise is that whole runs show, where its memory hides it from one step to the next.

_ROUNDING = 1e-12  # of the largest singular value, below which one is none; chosen


def with_whole_run_intensity(process_noise: ProcessNoise, estimate: PointEstimate, residuals: Array) -> ProcessNoise:
    """Return the process noise at least as strong as the residuals (rows, ny) of an estimate over whole runs show."""
    trust = inverse_variances(estimate.problem)
    sensors = float(np.sum(trust * np.array(list(process_noise.measurement_noise.values())) ** 2))
    found = float(np.sum(trust * np.nan_to_num(residuals) ** 2)) - sensors
    problem, point = process_noise.problem, process_noise.optimum.solution.point.copy()
    driven = slice(problem.runs.size, problem.runs.size + len(problem.process))
    if not np.any(point[driven]):  # SI; any size: it is scaled
        point[driven] = 1.0
    begun = _with_point(process_noise, point)
    share = found / max(_expected(begun, estimate), np.finfo(float).tiny)
    scaled = point.copy()
    scaled[driven] *= share
    by_runs = _with_point(process_noise, np.maximum(scaled, process_noise.optimum.solution.point))
    return replace(by_runs, evidence=NoiseEvidence.WHOLE_RUNS)


def _with_point(process_noise: ProcessNoise, point: Array) -> ProcessNoise:
    optimum = process_noise.optimum
    return replace(process_noise, optimum=replace(optimum, solution=replace(optimum.solution, point=point)))


def _expected(process_noise: ProcessNoise, estimate: PointEstimate) -> float:
    """The weighted sum of squares that the noise in the states leaves of whole runs after the fit."""
    problem = estimate.problem
    slopes, trust = problem.slopes(estimate.common_parameters, estimate.optimum.local), inverse_variances(problem)
    intensity = np.array([process_noise.process_intensities.get(s, 0.0) for s in problem.model.states])
    variance = intensity**2 * problem.data.dt
    count = len(estimate.common_parameters)
    information, score, total = np.zeros((count, count)), np.zeros((count, count)), 0.0
    for run, (a, b) in enumerate(pairwise(problem.data.offsets)):
        columns = problem.columns_of(int(problem.data.session[run]))
        moved, observation = process_noise.problem.transitions(run, estimate.common_parameters, estimate.optimum.local)
        own = without_initial_state(slopes[a:b], len(columns), trust[a:b])
        own_score = driven_variance(own.transpose(0, 2, 1) @ observation, moved, variance)
        information[np.ix_(columns, columns)] += np.einsum("tyk,tyl->kl", own, slopes[a:b, :, : len(columns)])
        score[np.ix_(columns, columns)] += own_score
        begun = slopes[a:b, :, len(columns) :]
        weighted = begun * trust[a:b, :, None]
        by_start = driven_variance(weighted.transpose(0, 2, 1) @ observation, moved, variance)
        total += _driven_spread(observation, moved, variance, trust[a:b])
        total -= _trace_of_ratio(np.einsum("tyk,tyl->kl", weighted, begun), by_start)
    return total - _trace_of_ratio(information, score)


def _trace_of_ratio(normal: Array, score: Array) -> float:
    """The trace of normal^-1 score, where normal may be singular."""
    return float(np.trace(np.linalg.lstsq(normal, score, rcond=_ROUNDING)[0]))


def _driven_spread(observation: Array, transitions: Array, variance: Array, weights: Array) -> float:
    """The weighted sum of the variances of all outputs, x driven by white noise as in `driven_variance`."""
    half = 0.5 * np.diag(variance)
    spread, total = np.zeros_like(half), 0.0
    for t in range(1, len(weights)):
        spread = transitions[t - 1] @ (spread + half) @ transitions[t - 1].T + half
        total += float(weights[t] @ np.einsum("yi,ij,yj->y", observation[t], spread, observation[t]))
    return total


# What slow forces leave open of the angle of rest of roll decays: wind, people who move, a hawser.

ANGLE_OF_REST = "phi_0"
"""Parameter of a roll model for the angle at which the ship comes to rest [rad]."""

COSINES = 2
"""Cosines over a single run that measure slow forces: with one more, memories of a third of a run escape; chosen."""


def with_slow_forces(interval: Interval, estimate: PointEstimate, residuals: Array) -> Interval:
    """Return the interval with that of the angle of rest as wide as the runs' slow forces make it, never narrower.

    Meant for few decays whose residuals (rows, ny) are not white; without a free angle of rest it stays as it is.
    """
    if ANGLE_OF_REST not in estimate.problem.free:
        return interval
    place = estimate.problem.free.index(ANGLE_OF_REST)
    runs = len(estimate.problem.data.runs)
    if runs > 1:
        by_runs = run_scores(estimate).interval("")
        deviation, freedom = float(by_runs.standard_error[place]), by_runs.degrees_of_freedom
    else:
        deviation, freedom = _within_run(_influence(estimate, residuals, place)), float(COSINES)
    quantiles = (two_sided_quantile(STORED_LEVEL, f) for f in (freedom, interval.degrees_of_freedom))
    needed = deviation * next(quantiles) / next(quantiles)  # that gives this half width with the interval's own freedom
    covariance = interval.covariance.copy()
    covariance[place, place] = max(covariance[place, place], needed**2)
    how = f"one-step jackknife over {runs} runs" if runs > 1 else "the slow changes of its only run"
    return replace(interval, covariance=covariance, meaning=f"{interval.meaning}; {ANGLE_OF_REST} by {how}")


def _influence(estimate: PointEstimate, residuals: Array, place: int) -> Array:
    """Return what every sample of the only run adds to the error of a coefficient, rad, (rows,)."""
    problem = estimate.problem
    row = inverse(estimate.optimum.normal.without_local()[1])[place]
    slopes = problem.slopes(estimate.common_parameters, estimate.optimum.local)
    eliminated = without_initial_state(slopes, len(row), inverse_variances(problem))
    return np.einsum("tyk,k,ty->t", eliminated, row, np.nan_to_num(residuals))


def _within_run(part: Array) -> float:
    """Return the standard deviation of the sum of these, (rows,), from the slowest cosines over the run.

    Each cosine's coefficient has the variance of the sum where the parts change more slowly than the cosines.
    """
    phase = np.pi * (np.arange(len(part)) + 0.5) / len(part)
    sums = [np.sqrt(2.0) * part @ np.cos(k * phase) for k in range(1, COSINES + 1)]
    return float(np.sqrt(np.mean(np.square(sums))))


# Which interval is defensible for this fit, and the interval itself.

# fewest runs for a jackknife, ours
RUNS_FOR_JACKKNIFE = 4
# fits of a bootstrap of standard errors, ours
BOOTSTRAP_FITS = 40
# fewest segments for a sandwich covariance, ours
_BLOCKS_FOR_SANDWICH = 10


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """An interval of all shared unknowns, and what it rests on.

    Attributes:
        leave_one_out: estimates with one run left out each, shape (runs, k); None with too few
            runs for a jackknife.
        one_step_ratio: median over coefficients of the one-step jackknife's standard error over that of full refits;
            None unless both were computed.
        information: inverse of the covariance where that is another one than the criterion's, shape (k, k).
    """

    interval: Interval
    leave_one_out: Array | None = None
    one_step_ratio: float | None = None
    information: Array | None = None


def estimate_uncertainty(
    estimate: PointEstimate,
    inflation: Array,
    kind: IntervalMethod = IntervalMethod.AUTO,
    rng: np.random.Generator | None = None,
    report_progress: ReportCount | None = None,
) -> Uncertainty:
    """Information matrix where residuals are white; else one-step jackknife over runs, or a sandwich over segments.

    With few runs and few segments the information matrix is left, of the effective number of samples (the problem's
    `inflation`). A jackknife of full refits or a bootstrap over runs where `kind` asks for it; `rng` draws the runs.

    Raises:
        InputError: fewer runs than the wanted kind needs.
    """
    problem, hessian = estimate.problem, estimate.optimum.normal.without_local()[1]
    runs = len(problem.data.runs)
    refuse_few_runs(kind, runs)
    scores = run_scores(estimate) if runs >= RUNS_FOR_JACKKNIFE else None
    steps = None if scores is None else estimate.common_parameters + scores.left_out_steps

    def over_runs(interval: Interval) -> Interval:
        known = with_prior(interval, hessian, problem.prior_score_variance(estimate.common_parameters))
        return _offsets_by_information(known, hessian, len(problem.free))

    if kind is IntervalMethod.JACKKNIFE:
        points = full_jackknife(estimate, problem.workers, report_progress)
        full, fast = jackknife(points, ""), jackknife(_required(steps), "")
        share = fast.standard_error / np.maximum(full.standard_error, 1e-300)  # above zero, for a division
        agreement = float(np.median(share[: len(problem.free)]))
        meaning = f"jackknife over {runs} runs, each refitted (one step would give {agreement:.2f} of these errors)"
        return Uncertainty(over_runs(replace(full, meaning=meaning)), points, agreement)
    if kind is IntervalMethod.BOOTSTRAP:
        points = bootstrap_fits(
            estimate, BOOTSTRAP_FITS, rng or np.random.default_rng(0), problem.workers, report_progress
        )
        return Uncertainty(
            over_runs(bootstrap(points, runs, f"bootstrap over {runs} runs, {BOOTSTRAP_FITS} draws")), steps
        )
    if np.max(inflation) <= WHITE_INFLATION:
        return Uncertainty(
            _with_refuted_priors(from_information(hessian), hessian, problem, estimate.common_parameters), steps
        )
    if scores is not None:
        return Uncertainty(over_runs(scores.interval(f"one-step jackknife over {runs} runs")), steps)
    if problem.data.count >= _BLOCKS_FOR_SANDWICH:
        return Uncertainty(
            with_prior(
                sandwich(hessian, _segment_gradients(estimate)),
                hessian,
                problem.prior_score_variance(estimate.common_parameters),
            )
        )
    meaning = "information matrix, correlated samples counted as their effective number"
    interval = replace(from_information(hessian), meaning=meaning)
    return Uncertainty(_with_refuted_priors(interval, hessian, problem, estimate.common_parameters))


def innovations_uncertainty(noise: ProcessNoise, disturbances: DisturbanceChoice, kind: IntervalMethod) -> Uncertainty:
    """Intervals of a prediction-error estimate: its information matrix; runs left out where innovations are not white.

    With too few runs for that, the spread between the disturbance models is added. Full refits and a bootstrap would
    cost a search each and are not offered: one step stands for them, and says so.
    """
    runs = len(noise.output_error.data.runs)
    steps = noise.leave_one_out if runs >= RUNS_FOR_JACKKNIFE else None
    wanted = kind in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP)
    if steps is not None and (wanted or not noise.test.is_white):
        made = noise.interval_over_runs(f"one-step jackknife over {runs} runs, prediction error")
        score = noise.output_error.prior_score_variance(noise.common_parameters)
        widened = with_prior(made, noise.information, score)
        count = len(noise.output_error.free)
        return Uncertainty(_offsets_by_information(widened, noise.information, count), steps)
    interval = _with_refuted_priors(noise.interval, noise.information, noise.output_error, noise.common_parameters)
    return Uncertainty(
        interval
        if noise.test.is_white
        else with_spread(interval, disturbances, noise.output_error.free, noise.common_parameters),
        steps,
    )


def _with_refuted_priors(interval: Interval, hessian: Array, problem: OutputError, point: Array) -> Interval:
    """The interval of an information matrix, which takes priors for right, with what those the records refute add."""
    excess = problem.prior_score_variance(point) - problem.prior_precision(point)
    if not np.any(excess):
        return interval
    bread = inverse(hessian)
    meaning = f"{interval.meaning}, priors that the records contradict counted as wrong by as much"
    return replace(interval, covariance=interval.covariance + bread @ excess @ bread, meaning=meaning)


def with_spread(
    interval: Interval, disturbances: DisturbanceChoice, free: Sequence[str], common_parameters: Array
) -> Interval:
    """The interval with the scatter of the disturbance models about the estimate added to that of its coefficients."""
    k = len(free)
    covariance = interval.covariance.copy()
    covariance[:k, :k] += disturbances.spread(common_parameters[:k])
    return replace(
        interval, covariance=covariance, meaning=f"{interval.meaning}, with the spread of disturbance models"
    )


def refuse_few_runs(kind: IntervalMethod, runs: int) -> None:
    """Raises:
    InputError: a jackknife or bootstrap is required and there are too few runs.
    """
    if kind in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP) and runs < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"intervals by {kind} leave whole runs out and need at least {RUNS_FOR_JACKKNIFE} training runs, the trial "
            f"has {runs}; add runs, or leave the choice of intervals to the program"
        )


def _required(steps: Array | None) -> Array:
    assert steps is not None
    return steps


def _segment_gradients(estimate: PointEstimate) -> Array:
    """Gradient of every segment with its initial state eliminated, shape (segments, k)."""
    problem = estimate.problem
    blocks = problem.segment_normals(estimate.common_parameters, estimate.optimum.local)
    return np.array(
        [
            problem.assemble(blocks, estimate.common_parameters, np.array([s]), with_prior=False).without_local()[0]
            for s in range(problem.data.count)
        ]
    )


def _offsets_by_information(interval: Interval, hessian: Array, coefficients: int) -> Interval:
    """Errors of a session's own unknowns from the information matrix: a run left out says nothing about its offset."""
    covariance = interval.covariance.copy()
    covariance[coefficients:, :] = covariance[:, coefficients:] = 0.0
    covariance[coefficients:, coefficients:] = inverse(hessian)[coefficients:, coefficients:]
    return replace(interval, covariance=covariance)
