"""Intervals that follow bends a covariance takes for straight: draws from the posterior, and profile likelihood."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.equations.augment import MEMORY_PREFIX
from seatrial.core.results import Profile
from seatrial.core.results.fit import CredibleInterval, Posterior
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, Index, InputError, ProgressReporter, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.newton_refinement import approach_by_gradient
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.estimation.problem.output_error import EliminatedStates, OutputError
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import map_in_threads

if TYPE_CHECKING:
    from seatrial.numerics.sampling import Chains, ChainSettings

# What records and priors leave open, by draws: credible intervals that follow bends a covariance takes for straight.

_QUANTILES = (0.025, 0.975)
"""Probabilities below the ends of a 95 % interval."""
_SMALLEST = 1e-300
"""Variance whose logarithm stands for that of none; chosen: far below any."""


@dataclass(frozen=True, eq=False)
class _Target:
    """What is drawn from.

    Attributes:
        cost: unknowns (n,) -> minus the logarithm of the density, up to a constant.
        point, hessian: its minimum (n,) and its second derivatives there (n, n).
        common: positions among the unknowns of those that all strategies share: coefficients, then sessions' own.
    """

    cost: Callable[[Array], float]
    point: Array
    hessian: Array
    lower: Array
    upper: Array
    common: Index
    tempering: dict[str, float]


def sample_posterior(
    estimation: Estimation,
    seed: int,
    report_progress: ProgressReporter | None = None,
    settings: "ChainSettings | None" = None,
) -> tuple[Estimation, Posterior]:
    """Return the estimate with the covariance of draws from its posterior, and the draws.

    Raises:
        InputError: emcee is not installed.
    """
    from seatrial.numerics.sampling import sample_chains

    target = _innovation_target(estimation) if estimation.has_process_noise else _output_error_target(estimation)
    moving = np.flatnonzero(target.upper > target.lower)

    def log_density(points: Array) -> Array:
        full = np.tile(target.point, (len(points), 1))
        full[:, moving] = points
        return np.array(map_in_threads(lambda p: -_bounded_cost(target, p), list(full), workers=_workers(estimation)))

    covariance = inverse(target.hessian[np.ix_(moving, moving)])
    report = report_progress or (lambda _: None)
    try:
        chains = sample_chains(log_density, target.point[moving], covariance, seed, settings, report)
    except ImportError as error:
        raise InputError("sampling needs the package emcee: pip install 'seatrial[sampling]'") from error
    place = {int(column): i for i, column in enumerate(moving)}
    common = np.array([place[int(column)] for column in target.common])
    return _with_draws(estimation, chains, common), _posterior(estimation, chains, common, target)


def sampling_findings(posterior: Posterior) -> list[Finding]:
    """Return a warning where the chains do not agree, or were ended before they did."""
    if posterior.is_converged:
        return []
    worst = max(posterior.coefficients, key=lambda c: c.r_hat)
    cause = "were interrupted before they agreed" if posterior.is_interrupted else "do not agree"
    return [Finding(
        Severity.WARNING, "not-sampled-enough", f"the chains of the sampling {cause}",
        f"R-hat up to {worst.r_hat:.3f}, of {worst.name}; at least "
        f"{min(c.effective_size for c in posterior.coefficients):.0f} independent draws",
    )]  # fmt: skip


def _workers(estimation: Estimation) -> int | None:
    return estimation.estimate.problem.workers


def _bounded_cost(target: _Target, point: Array) -> float:
    if np.any(point < target.lower) or np.any(point > target.upper):
        return np.inf
    return target.cost(point)


def _output_error_target(estimation: Estimation) -> _Target:
    """Output error: the problem counts correlated samples as fewer already."""
    optimum = estimation.estimate.optimum
    problem = replace(estimation.estimate.problem, workers=1)
    point = estimation.estimate.common_parameters
    density = EliminatedStates.about(problem, point, optimum.local, optimum.normal)
    tempering = {} if problem.inflation is None else dict(zip(problem.data.outputs, problem.inflation, strict=True))
    return _Target(
        density.cost, point, optimum.normal.without_local()[1], problem.lower, problem.upper, np.arange(problem.size),
        {channel: float(inflation) for channel, inflation in tempering.items()},
    )  # fmt: skip


def _innovation_target(estimation: Estimation) -> _Target:
    """Prediction error; innovations that no disturbance makes white count as their effective number.

    Of variances the logarithm is drawn, as their densities are skewed; their prior stays flat.
    """
    noise = estimation.process_noise
    assert noise is not None
    problem = replace(noise.problem, runs=replace(noise.problem.runs, workers=1), steps=None)
    point, size = noise.optimum.solution.point, problem.runs.size
    is_white = estimation.whiteness.is_white
    inflation = 1.0 if is_white else max(float(np.max(estimation.inflation)), 1.0)
    prior = np.zeros((problem.size, problem.size))
    prior[:size, :size] = problem.runs.prior_precision(point[:size])

    is_log = (np.arange(problem.size) >= size) & (point > 0.0)
    scale = np.where(is_log, point, 1.0)

    def to_log(values: Array) -> Array:
        return np.where(is_log, np.log(np.where(is_log, np.maximum(values, _SMALLEST), 1.0)), values)

    def cost(point: Array) -> float:
        unknowns = np.where(is_log, np.exp(np.where(is_log, point, 0.0)), point)
        of_priors = problem.runs.prior_cost(unknowns[:size])
        of_data = (problem.cost(unknowns, np.zeros((0, 0))) - of_priors) / inflation
        return of_data + of_priors - float(np.sum(point[is_log]))  # d variance = variance d logarithm

    hessian = (noise.optimum.normal.hessian - prior) / inflation + prior
    return _Target(
        cost, to_log(point), scale[:, None] * hessian * scale, to_log(problem.lower), to_log(problem.upper),
        noise.common_indices, {} if is_white else dict.fromkeys(problem.runs.data.outputs, inflation),
    )  # fmt: skip


def _with_draws(estimation: Estimation, chains: "Chains", common: Index) -> Estimation:
    draws = chains.points[:, :, common].reshape(-1, len(common))
    count, total = chains.points.shape[0], len(draws)
    meaning = f"posterior sampled by {count} chains, {total} draws"
    interval = Interval(np.atleast_2d(np.cov(draws, rowvar=False)), np.inf, meaning)
    return replace(estimation, uncertainty=replace(estimation.uncertainty, interval=interval, information=None))


def _posterior(estimation: Estimation, chains: "Chains", common: Index, target: _Target) -> Posterior:
    problem, other = estimation.estimate.problem, estimation.interval
    columns = common[: len(problem.free)]
    points = np.ascontiguousarray(chains.points[:, :, columns])
    draws = points.reshape(-1, len(columns))
    lower, upper = np.quantile(draws, _QUANTILES, axis=0)
    centre, half = estimation.estimate.common_parameters, other.half_width
    rows = tuple(
        CredibleInterval(
            name, problem.model.parameters[name].unit, float(draws[:, i].mean()), float(draws[:, i].std(ddof=1)),
            float(lower[i]), float(upper[i]), float(centre[i] - half[i]), float(centre[i] + half[i]),
            float(chains.r_hat[columns[i]]), float(chains.effective_size[columns[i]]),
        )
        for i, name in enumerate(problem.free)
    )  # fmt: skip
    return Posterior(
        rows, points, chains.log_density, target.tempering, other.meaning, chains.acceptance, chains.is_converged,
        chains.is_interrupted,
    )  # fmt: skip


# Profile likelihood: one coefficient held at a value, all others fitted again; and records too short for less.

# Profile likelihood: one coefficient held at a value, all others fitted again.

CHI_SQUARED_LIMIT = 3.841
"""95 % quantile of chi squared with one degree of freedom."""

# standard errors from an estimate at which refits are made, ours: of a parabola the limit is passed at 1.96
_REACHES = (1.0, 2.0, 2.5, 3.75, 5.0)
# promised decrease of the cost at which a refit ends, ours
_NEGLIGIBLE = 1e-4
# most steps of a refit by prediction error, ours: it starts at its neighbour
_MOST_STEPS = 10
# relative difference of costs that count as one, ours
_COST_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class _Refit:
    """Twice the loss with one coefficient held, and the optimum of the others, from which the next one starts."""

    twice_loss: float
    common_parameters: Array
    local: Array


_Hold = Callable[[float, _Refit, Array], _Refit]


@dataclass(frozen=True, eq=False)
class _ProfiledFit:
    """An optimum whose coefficients can be held.

    Attributes:
        own_errors: standard errors of the free coefficients by its information, (free,).
        hessian: second derivatives of the loss by all unknowns that are shared, (n, n).
        hold: column -> (value, neighbour, where the information expects the others) -> refit.
    """

    free: Sequence[str]
    optimum: _Refit
    lower: Array
    upper: Array
    own_errors: Array
    hessian: Array
    hold: Callable[[int], _Hold]
    workers: int | None

    def others_by(self, column: int) -> Array:
        """Return derivatives of the other unknowns at their optimum by the one that is held, (n - 1,): -H_oo^-1 h_o.

        Unknowns on a bound stay there.
        """
        point = self.optimum.common_parameters
        is_moving = (self.lower < point) & (point < self.upper)
        is_moving[column] = False
        others, slopes = np.flatnonzero(is_moving), np.zeros(len(point))
        slopes[others] = -inverse(self.hessian[np.ix_(others, others)]) @ self.hessian[others, column]
        return np.delete(slopes, column)


def profiles(
    estimate: PointEstimate, deviations: Array, names: Sequence[str], report_progress: ProgressReporter | None = None
) -> tuple[Profile, ...]:
    """Return the profile of each named coefficient; none where the estimate minimises another criterion.

    deviations: standard errors of all free ones, (free,); steps are in them or in the information's, if those are
    smaller.
    """
    if not _is_minimum_of_its_problem(estimate):
        return ()
    problem, solution = estimate.problem, estimate.optimum.solution
    hessian = estimate.optimum.normal.without_local()[1]
    fit = _ProfiledFit(
        problem.free, _Refit(2.0 * solution.value, solution.point, estimate.optimum.local),
        problem.lower, problem.upper, np.sqrt(np.diag(inverse(hessian))), hessian,
        lambda column: _hold_in_output_error(problem, column), problem.workers,
    )  # fmt: skip
    return _profiles(fit, deviations, names, report_progress)


def innovation_profiles(
    noise: ProcessNoise, deviations: Array, names: Sequence[str], report_progress: ProgressReporter | None = None
) -> tuple[Profile, ...]:
    """Return the same for prediction error: disturbance and sensor noise are fitted again at each value."""
    problem, solution = noise.problem, noise.optimum.solution
    fit = _ProfiledFit(
        noise.output_error.free, _Refit(2.0 * solution.value, solution.point, np.zeros((0, 0))), problem.lower,
        problem.upper, noise.interval.standard_error, noise.optimum.normal.hessian,
        lambda column: _hold_in_prediction_error(problem, column), problem.runs.workers,
    )  # fmt: skip
    return _profiles(fit, deviations, names, report_progress)


def _profiles(
    fit: _ProfiledFit, deviations: Array, names: Sequence[str], report_progress: ProgressReporter | None
) -> tuple[Profile, ...]:
    place = {n: i for i, n in enumerate(fit.free)}
    done: list[int] = []

    def one(name: str) -> Profile:
        column = place[name]
        profile = _profile(fit, column, float(min(deviations[column], fit.own_errors[column])))
        done.append(1)
        if report_progress:
            report_progress(f"profile likelihood: {len(done)} of {len(names)}")
        return profile

    return tuple(map_in_threads(one, list(names), workers=fit.workers))


def _is_minimum_of_its_problem(estimate: PointEstimate) -> bool:
    cost = estimate.problem.cost(estimate.common_parameters, estimate.optimum.local)
    return bool(np.isclose(cost, estimate.optimum.solution.value, rtol=_COST_TOLERANCE, atol=_COST_TOLERANCE))


def _profile(fit: _ProfiledFit, column: int, deviation: float) -> Profile:
    centre = (float(fit.optimum.common_parameters[column]), fit.optimum.twice_loss)
    below, above = (_branch(fit, column, sign * deviation) for sign in (-1.0, 1.0))
    values, costs = np.array([*reversed(below), centre, *above]).T
    costs = costs - np.min(costs)
    least = int(np.argmin(costs))
    return Profile(
        fit.free[column],
        tuple(map(float, values)),
        tuple(map(float, costs)),
        _crossing(values[least::-1], costs[least::-1]),
        _crossing(values[least:], costs[least:]),
    )


def _branch(fit: _ProfiledFit, column: int, step: float) -> list[tuple[float, float]]:
    """Values and twice the loss, outward until the limit is passed, or bound, reach or the model's range is at its end.

    A refit starts where the information expects the others, as along a ridge no short search would follow them, or at
    its neighbour where that costs less. Where it finds a smaller loss than the estimate's, the limit counts from there.
    """
    refit, start, by_held = fit.hold(column), fit.optimum.common_parameters, fit.others_by(column)
    low, high = (np.delete(bounds, column) for bounds in (fit.lower, fit.upper))
    last, held = replace(fit.optimum, common_parameters=np.delete(start, column)), float(start[column])
    least, points = fit.optimum.twice_loss, []
    for away in _REACHES:
        value = float(start[column]) + away * step
        if not fit.lower[column] <= value <= fit.upper[column]:
            break
        expected = np.clip(last.common_parameters + by_held * (value - held), low, high)
        last, held = refit(value, last, expected), value
        if not np.isfinite(last.twice_loss):
            break
        least = min(least, last.twice_loss)
        points.append((value, last.twice_loss))
        if last.twice_loss - least > CHI_SQUARED_LIMIT:
            break
    return points


def _hold_in_output_error(problem: OutputError, column: int) -> _Hold:
    def refit(value: float, neighbour: _Refit, expected: Array) -> _Refit:
        held, prior = _held(problem, column, value)
        start = _cheaper(held, neighbour, expected)
        again = levenberg_marquardt(held, start, neighbour.local, negligible=_NEGLIGIBLE)
        return _Refit(2.0 * again.solution.value + prior, again.solution.point, again.local)

    return refit


def _hold_in_prediction_error(problem: PredictionError, column: int) -> _Hold:
    def refit(value: float, neighbour: _Refit, expected: Array) -> _Refit:
        runs, prior = _held(problem.runs, column, value)
        held = replace(problem, runs=runs, steps=None)
        again = approach_by_gradient(held, _cheaper(held, neighbour, expected), _MOST_STEPS)[0]
        return _Refit(2.0 * again.solution.value + prior, again.solution.point, neighbour.local)

    return refit


def _cheaper(problem: OutputError | PredictionError, neighbour: _Refit, expected: Array) -> Array:
    """Return the start of a refit that costs less: the neighbour's optimum, or where the others are expected."""
    starts = (expected, neighbour.common_parameters)
    return min(starts, key=lambda start: problem.cost(start, neighbour.local))


def _held(problem: OutputError, column: int, value: float) -> tuple[OutputError, float]:
    """Return the problem with one coefficient fixed, and twice the cost of its own prior at this value."""
    name, (mean, weight) = problem.free[column], (float(of_all[column]) for of_all in problem.priors)
    model = problem.model.with_parameters(problem.model.parameters.fixed(name)).with_values({name: value})
    return replace(problem, model=model, workers=1), weight * (value - mean) ** 2


def _crossing(values: Array, costs: Array) -> float | None:
    """Where the cost passes the limit, by interpolating its root (straight for a parabola); None where it does not."""
    for (a, low), (b, high) in pairwise(zip(values, costs, strict=True)):
        if low < CHI_SQUARED_LIMIT <= high:
            share = (np.sqrt(CHI_SQUARED_LIMIT) - np.sqrt(low)) / (np.sqrt(high) - np.sqrt(low))
            return float(a + share * (b - a))
    return None


# Records too short or too calm for intervals of the information under a disturbance: profiles, and warnings.

FEWEST_MEMORIES = 40.0
"""Memories of a disturbance that records last at least, for intervals of the information to hold; chosen: in fewer too
few intervals of simulated craft hold the truth (`python benchmarks/gusts.py --short`)."""

LONGEST_ADVICE = 10.0
"""Times the duration of the runs that a record is advised to last at most: a memory that calls for more is a quarter of
the runs or longer, and not distinguishable from a slow error of the model; chosen."""

FEWEST_REFERENCE_STEPS = 4
"""Changes of the reference that records of a closed loop contain at least, for the same reason; chosen."""

_LARGEST_SHARE = 0.1
"""Standard error over estimate above which an interval symmetric about the estimate is no longer one of the likelihood:
the standard error grows with the estimate, so that small estimates seem too certain; chosen."""

_MOST_COEFFICIENTS, _MOST_SAMPLES = 6, 10_000
"""Free coefficients and samples up to which profiles are computed without being required: seconds; chosen."""


def short_record_findings(estimation: Estimation, profiles: tuple[Profile, ...]) -> list[Finding]:
    """Return warnings of few memories and few changes of the reference; profiles: behind the intervals, or none."""
    consequence = (
        "intervals come from a profile likelihood and may still be too narrow" if profiles else
        "intervals may be too narrow; --intervals profile gives better ones"
    )  # fmt: skip
    findings, seconds, steps = [], _seconds(estimation), _reference_steps(estimation)
    if _has_few_memories(estimation):
        memory = _longest_memory(estimation)
        missing = FEWEST_MEMORIES * memory - seconds
        advice = f"record at least {significant(missing, 2)} s more, {FEWEST_MEMORIES * memory:.0f} s in all"
        if FEWEST_MEMORIES * memory > LONGEST_ADVICE * seconds:
            advice = (
                "a disturbance with a memory as long as the runs is the model's misfit rather than the sea: free more "
                "coefficients or take a richer model"
            )
        text = f"the records are short compared with the memory of the disturbance: {consequence}"
        evidence = f"{seconds:.0f} s, memory {memory:.3g} s"
        findings.append(Finding(Severity.WARNING, "few-memories", text, evidence, advice))
    if steps is not None and steps < FEWEST_REFERENCE_STEPS:
        findings.append(Finding(Severity.WARNING, "few-reference-steps", f"the reference changes seldom: {consequence}",
                                f"{steps} times in all runs",
                                f"record at least {FEWEST_REFERENCE_STEPS} changes of it"))  # fmt: skip
    return findings


def default_profiles(estimation: Estimation, report_progress: ProgressReporter | None = None) -> tuple[Profile, ...]:
    """Return profiles of the coefficients where the information's intervals do not suffice under a disturbance.

    That is in short records, and where a standard error exceeds a tenth of its estimate. None where no disturbance was
    estimated, where the search did not converge, and where profiles would take long.
    """
    noise, problem, steps = estimation.process_noise, estimation.estimate.problem, _reference_steps(estimation)
    if noise is None or not estimation.has_process_noise:
        return ()
    if not estimation.estimate.optimum.solution.status.is_success:
        return ()
    errors, values = estimation.interval.standard_error, estimation.estimate.common_parameters
    is_short = _has_few_memories(estimation) or (steps is not None and steps < FEWEST_REFERENCE_STEPS)
    is_vague = bool(np.any((errors > _LARGEST_SHARE * np.abs(values))[: len(problem.free)]))
    is_small = len(problem.free) <= _MOST_COEFFICIENTS and len(problem.data.inputs) <= _MOST_SAMPLES
    if not (is_small and (is_short or is_vague)):
        return ()
    return innovation_profiles(noise, errors, problem.free, report_progress)


def _has_few_memories(estimation: Estimation) -> bool:
    return _seconds(estimation) < FEWEST_MEMORIES * _longest_memory(estimation)


def _longest_memory(estimation: Estimation) -> float:
    """Return the longest memory of the disturbance [s]; 0: it has none."""
    added = estimation.noise_model.added
    return max((t for name, t in added.items() if name.startswith(MEMORY_PREFIX)), default=0.0)


def _seconds(estimation: Estimation) -> float:
    """Return the duration of all runs [s]."""
    data = estimation.estimate.problem.data
    return len(data.inputs) * data.dt


def _reference_steps(estimation: Estimation) -> int | None:
    loop = estimation.noise_model.closed_loop
    return None if loop is None else loop.reference_steps
