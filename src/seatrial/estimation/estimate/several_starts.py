"""Searches from several starting points: what a likelihood with more than one optimum needs.

Each point gets a short search in which noise levels follow the residuals, the best of them a longer one; the estimate
goes on from the end with the lowest loss. Points: the first start (weak form), the model's own values, and points drawn
about these.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import SearchAttempt
from seatrial.core.values import Array, Parameter, ProgressReporter
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    fit_output_error,
    residual_correlation,
    residual_spread,
)
from seatrial.estimation.estimate.start import SearchStart
from seatrial.estimation.problem.output_error import OutputError

MANY_STARTS = 6
"""Starting points for a craft with thrusters, whose curves and lags give the likelihood several optima; chosen."""
_ROUNDS, _EVALUATIONS = 2, 12
"""Estimates of the noise, and evaluations between them, of a short search; chosen."""
_FINALISTS, _FINAL_ROUNDS = 2, 8
"""Short searches that are taken further, and rounds of these; chosen."""
_CANDIDATES = 6
"""Points drawn for each start, of which the one with the lowest cost is searched from; chosen."""
_SPREAD = 0.7
"""Standard deviation of the logarithm of a drawn coefficient that keeps its sign: a factor of two; chosen."""


@dataclass(frozen=True, eq=False)
class SeveralStarts:
    """Where the estimate goes on, and all short searches, the lowest loss first."""

    start: SearchStart
    attempts: tuple[SearchAttempt, ...]


@dataclass(frozen=True, eq=False)
class _Attempt:
    origin: str
    start_loss: float
    loss: float
    end: PointEstimate


def number_of_starts(model: Model, required: int | None) -> int:
    """Return how many points to search from: what the trial requires, else one unless thrusters drive the craft."""
    return required or (MANY_STARTS if model.equations.layout else 1)


def search_from_several(
    start: SearchStart, known_noise: Mapping[str, float], count: int, seed: int,
    report_progress: ProgressReporter | None = None,
) -> SeveralStarts:  # fmt: skip
    """Return the start with the point at which the best of `count` short searches ended.

    known_noise: channel -> stated noise; seed: of the drawn points.
    """
    attempts: list[_Attempt] = []
    weights: Array | None = None
    for origin, point in _points(start, count, np.random.default_rng(seed)):
        if report_progress:
            report_progress(f"start {len(attempts) + 1} of {count}: {origin}")
        end = fit_output_error(
            start.problem, point, start.initial_states, known_noise, rounds=_ROUNDS, evaluations=_EVALUATIONS
        )
        if weights is None:
            weights = _effective_samples(end)
        begun = _estimate_at(end, point, start.initial_states)
        attempts.append(_Attempt(origin, loss(begun, known_noise, weights), loss(end, known_noise, weights), end))
    assert weights is not None
    attempts.sort(key=lambda a: a.loss)
    attempts[:_FINALISTS] = [_continued(a, known_noise, weights) for a in attempts[:_FINALISTS]]
    best = min(attempts, key=lambda a: a.loss)
    end = best.end
    again = SearchStart(
        end.problem, end.common_parameters, end.optimum.local, f"the best of {count} starts: {best.origin}"
    )
    return SeveralStarts(again, tuple(_reported(a, best) for a in sorted(attempts, key=lambda a: a.loss)))


def _estimate_at(estimate: PointEstimate, point: Array, local: Array) -> PointEstimate:
    """The same problem at another point."""
    optimum = estimate.optimum
    return replace(estimate, optimum=replace(optimum, local=local, solution=replace(optimum.solution, point=point)))


def _continued(attempt: _Attempt, known_noise: Mapping[str, float], weights: Array) -> _Attempt:
    """A search taken further; as it was where that leads no lower."""
    end = attempt.end
    further = fit_output_error(
        end.problem, end.common_parameters, end.optimum.local, known_noise, rounds=_FINAL_ROUNDS,
        evaluations=_EVALUATIONS,
    )  # fmt: skip
    spent = end.optimum.solution.evaluations + further.optimum.solution.evaluations
    solution = replace(further.optimum.solution, evaluations=spent)
    further = replace(further, optimum=replace(further.optimum, solution=solution))
    lower = loss(further, known_noise, weights)
    return replace(attempt, loss=lower, end=further) if lower < attempt.loss else attempt


def loss(estimate: PointEstimate, known_noise: Mapping[str, float], weights: Array) -> float:
    """Return the negative log-likelihood, the noise of each channel at its residuals' own where it is not stated.

    weights: effective samples of each channel, (ny,). Priors and other data count as they are; infinite where the model
    diverges.
    """
    problem, residuals = estimate.problem, estimate.residuals()
    if not np.all(np.isfinite(residuals) | ~np.isfinite(problem.data.measured)):
        return np.inf
    spread = residual_spread(problem, residuals)
    stated = np.array([known_noise.get(o, np.nan) for o in problem.data.outputs])
    of_channels = np.where(np.isfinite(stated), 0.5 * (spread / stated) ** 2, np.log(spread))
    return float(weights @ of_channels) + problem.prior_cost(estimate.common_parameters)


def _effective_samples(estimate: PointEstimate) -> Array:
    inflation = np.maximum(1.0, residual_correlation(estimate.problem, estimate.residuals())[1])
    return np.isfinite(estimate.problem.data.measured).sum(axis=0) / inflation


def _points(start: SearchStart, count: int, rng: np.random.Generator) -> Iterator[tuple[str, Array]]:
    """Origin and shared unknowns of each starting point."""
    problem, values = start.problem, start.problem.start()
    yield start.origin, start.common_parameters
    if count > 1:
        yield "the model's own values", values
    for k in range(count - 2):
        yield f"drawn point {k + 1}", _best_drawn_point(problem, values, start.initial_states, rng)


def _best_drawn_point(problem: OutputError, values: Array, local: Array, rng: np.random.Generator) -> Array:
    """The point with the lowest cost of some that are drawn about the model's own values."""
    parameters = [problem.model.parameters[name] for name in problem.free]
    points = []
    for _ in range(_CANDIDATES):
        point = values.copy()
        point[: len(parameters)] = [_drawn_value(p, rng) for p in parameters]
        points.append(np.clip(point, problem.lower, problem.upper))
    return min(points, key=lambda point: problem.cost(point, local))


def _drawn_value(parameter: Parameter, rng: np.random.Generator) -> float:
    """By its prior; else by a factor of about two where zero is out of its bounds, by its size otherwise."""
    step, prior = rng.standard_normal(), parameter.prior
    if prior is not None and np.isfinite(prior.standard_deviation):
        return prior.mean + prior.standard_deviation * step
    if parameter.lower > 0.0:
        return parameter.value * float(np.exp(_SPREAD * step))
    return parameter.value + max(parameter.scale, abs(parameter.value)) * step


def _reported(attempt: _Attempt, best: _Attempt) -> SearchAttempt:
    problem, solution = attempt.end.problem, attempt.end.optimum.solution
    values = dict(zip(problem.free, map(float, solution.point), strict=False))
    return SearchAttempt(
        attempt.origin, attempt.start_loss - best.loss, attempt.loss - best.loss, solution.evaluations, values,
        attempt is best,
    )  # fmt: skip
