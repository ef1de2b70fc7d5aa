"""What records and priors leave open, by draws: credible intervals that follow bends a covariance takes for straight.

The density is the likelihood of the fit's criterion times the priors. Correlated residuals count as their effective
number of samples (Sokal 1997), which tempers the likelihood; initial states are put where they suit the unknowns best.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.results.fit import CredibleInterval, Posterior
from seatrial.core.values import Array, Finding, Index, InputError, ProgressReporter, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.estimation.problem.output_error import EliminatedStates
from seatrial.numerics.sampling import Chains, ChainSettings, sample_chains
from seatrial.numerics.workers import map_in_threads

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
    settings: ChainSettings | None = None,
) -> tuple[Estimation, Posterior]:
    """Return the estimate with the covariance of draws from its posterior, and the draws.

    Raises:
        InputError: emcee is not installed.
    """
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


def _with_draws(estimation: Estimation, chains: Chains, common: Index) -> Estimation:
    draws = chains.points[:, :, common].reshape(-1, len(common))
    count, total = chains.points.shape[0], len(draws)
    meaning = f"posterior sampled by {count} chains, {total} draws"
    interval = Interval(np.atleast_2d(np.cov(draws, rowvar=False)), np.inf, meaning)
    return replace(estimation, uncertainty=replace(estimation.uncertainty, interval=interval, information=None))


def _posterior(estimation: Estimation, chains: Chains, common: Index, target: _Target) -> Posterior:
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
