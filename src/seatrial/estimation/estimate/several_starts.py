"""Searches from several starting points: what a likelihood with more than one optimum needs.

Each point gets a short search in which noise levels follow the residuals; from those that end lowest it goes on, in
rounds, and the estimate begins at the best. Points: the first start (weak form), the model's own values, and points
drawn about these.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import SearchAttempt
from seatrial.core.values import Array, Parameter, ProgressReporter
from seatrial.estimation.estimate.concentrated_likelihood import ConcentratedLikelihood
from seatrial.estimation.estimate.start import SearchStart
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt

MANY_STARTS = 6
"""Starting points for a craft with thrusters, whose curves and lags give the likelihood several optima; chosen."""
_NEGLIGIBLE = 1e-3
"""Promised decrease of the negative log-likelihood at which a search ends; chosen."""
_DAMPING = 0.1
"""Of the first step, over the Hessian's diagonal: starts lie far from the optimum; chosen."""
_CANDIDATES = 6
"""Points drawn for each start, of which the one with the lowest cost is searched from; chosen."""
_SPREAD = 0.7
"""Standard deviation of the logarithm of a drawn coefficient that keeps its sign: a factor of two; chosen."""


@dataclass(frozen=True)
class _Round:
    """How many searches go on, the best ones, and for how many evaluations each."""

    searches: int
    evaluations: int


_FIRST_EVALUATIONS = 20
"""Of each start before any is given up: most stand then nearer to their own optimum than optima lie apart; chosen."""
_ROUNDS = (_Round(3, 20), _Round(1, 40))
"""What follows; chosen so that, of simulated craft, all searches end in the optimum next to the truth
(benchmarks/thrusters_truth.py)."""


@dataclass(frozen=True, eq=False)
class SeveralStarts:
    """Where the estimate goes on, and all short searches, the lowest loss first."""

    start: SearchStart
    attempts: tuple[SearchAttempt, ...]


@dataclass(frozen=True, eq=False)
class _Attempt:
    """A search so far: where it came from, where it stands, its losses there."""

    origin: str
    start: Array
    shared: Array
    local: Array
    evaluations: int = 0
    start_loss: float = np.inf
    loss: float = np.inf

    def scored(self, likelihood: ConcentratedLikelihood, local: Array) -> "_Attempt":
        """Return it with its losses; local: initial states at its start."""
        return replace(
            self, start_loss=likelihood.cost(self.start, local), loss=likelihood.cost(self.shared, self.local)
        )

    def continued(self, likelihood: ConcentratedLikelihood, evaluations: int) -> "_Attempt":
        """Return it after a further search."""
        optimum = levenberg_marquardt(
            likelihood, self.shared, self.local, negligible=_NEGLIGIBLE, evaluations=evaluations, damping=_DAMPING
        )
        solution = optimum.solution
        return replace(
            self, shared=solution.point, local=optimum.local, loss=solution.value,
            evaluations=self.evaluations + solution.evaluations,
        )  # fmt: skip


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
    local, attempts = start.initial_states, list[_Attempt]()
    likelihood = ConcentratedLikelihood(start.problem, known_noise)
    for origin, point in _points(likelihood, start, count, np.random.default_rng(seed)):
        if report_progress:
            report_progress(f"starting points: {len(attempts) + 1} of {count}, {origin}")
        attempts.append(_Attempt(origin, point, point, local).continued(likelihood, _FIRST_EVALUATIONS))
    for following in _ROUNDS:  # the best one shows how correlated residuals are, so that samples count as they should
        best = min(attempts, key=lambda a: a.loss)
        likelihood = replace(likelihood, problem=likelihood.settled_at(best.shared, best.local))
        attempts = sorted((a.scored(likelihood, local) for a in attempts), key=lambda a: a.loss)
        attempts[: following.searches] = [
            a.continued(likelihood, following.evaluations) for a in attempts[: following.searches]
        ]
    attempts.sort(key=lambda a: a.loss)
    best = attempts[0]
    again = SearchStart(
        likelihood.settled_at(best.shared, best.local), best.shared, best.local,
        f"the best of {count} starts: {best.origin}",
    )  # fmt: skip
    return SeveralStarts(again, tuple(_reported(a, best, start.problem) for a in attempts))


def _points(
    likelihood: ConcentratedLikelihood, start: SearchStart, count: int, rng: np.random.Generator
) -> Iterator[tuple[str, Array]]:
    """Origin and shared unknowns of each starting point."""
    values = start.problem.start()
    yield start.origin, start.common_parameters
    if count > 1:
        yield "the model's own values", values
    for k in range(count - 2):
        yield f"drawn point {k + 1}", _best_drawn_point(likelihood, values, start.initial_states, rng)


def _best_drawn_point(
    likelihood: ConcentratedLikelihood, values: Array, local: Array, rng: np.random.Generator
) -> Array:
    """The point with the lowest cost of some that are drawn about the model's own values."""
    problem = likelihood.problem
    parameters = [problem.model.parameters[name] for name in problem.free]
    points = []
    for _ in range(_CANDIDATES):
        point = values.copy()
        point[: len(parameters)] = [_drawn_value(p, rng) for p in parameters]
        points.append(np.clip(point, problem.lower, problem.upper))
    return min(points, key=lambda point: likelihood.cost(point, local))


def _drawn_value(parameter: Parameter, rng: np.random.Generator) -> float:
    """By its prior; else by a factor of about two where zero is out of its bounds, by its size otherwise."""
    step, prior = rng.standard_normal(), parameter.prior
    if prior is not None and np.isfinite(prior.standard_deviation):
        return prior.mean + prior.standard_deviation * step
    if parameter.lower > 0.0:
        return parameter.value * float(np.exp(_SPREAD * step))
    return parameter.value + max(parameter.scale, abs(parameter.value)) * step


def _reported(attempt: _Attempt, best: _Attempt, problem: OutputError) -> SearchAttempt:
    values = dict(zip(problem.free, map(float, attempt.shared), strict=False))
    return SearchAttempt(
        attempt.origin, attempt.start_loss - best.loss, attempt.loss - best.loss, attempt.evaluations, values,
        attempt is best,
    )  # fmt: skip
