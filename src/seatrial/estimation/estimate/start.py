"""Where a search begins: by the weak form of the equations, at the model's own values, or from several points."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import SearchAttempt
from seatrial.core.values import Array, Parameter, ProgressReporter, Record
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    degrees_of_freedom_share,
    effective_inflation,
    residual_correlation,
    residual_spread,
    with_steps_of_start,
)
from seatrial.estimation.estimate.settings import dominant_period
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.regress.operators import WeakForm
from seatrial.numerics.optimise import NormalEquations, levenberg_marquardt
from seatrial.physics.models.candidate_structures import course_unstable
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import hidden_states, measured_states

# Where a search begins: without a guess, by the weak form of the equations; else at the model's own values.

RESTORING = "c_1"
"""Of a model of roll: the square of its natural frequency at small angles."""


@dataclass(frozen=True, eq=False)
class SearchStart:
    """Unknowns from which to search, the problem with the noise they leave, and where they come from in words."""

    problem: OutputError
    common_parameters: Array
    initial_states: Array
    origin: str


def find_start(problem: OutputError, records: Sequence[Record], seconds: float) -> SearchStart:
    """Coefficients by the weak form with windows of half width `seconds`, initial states as measured.

    The model's own values take their place where a state is hidden, or where the weak form's diverge; the period of the
    records does where it explains more of a roll.
    """
    local = problem.measured_initial_states()
    hidden, origin = hidden_states(problem.model, records), "weak form of the equations, no guess"
    if hidden:
        origin = f"the model's own values: nobody measures {', '.join(hidden)}, a state of the weak form"
    shared = _with_coefficients(problem, weak_form_start(problem.model, records, seconds))
    problem = with_steps_of_start(problem, shared, local)
    simulated = problem.simulated_outputs(shared, local)
    if not np.all(np.isfinite(simulated)):
        shared, origin = problem.start(), "the model's own values: those of the weak form diverge"
        problem = with_steps_of_start(problem, shared, local)
        simulated = problem.simulated_outputs(shared, local)
    if not problem.model.has_course:
        swinging = _with_period(problem, records)
        if not problem.cost(swinging, local) >= problem.cost(shared, local):
            shared, origin = swinging, "the period of the records, as the weak form explains less"
            simulated = problem.simulated_outputs(shared, local)
    if np.all(np.isfinite(simulated)):
        left = simulated - problem.data.measured
        problem = replace(problem, noise=residual_spread(replace(problem, huber=1.0), left))
    return SearchStart(problem, shared, local, origin)


def _with_coefficients(problem: OutputError, point: Array) -> Array:
    shared = problem.start()
    names = problem.model.parameters.free_names
    shared[: len(problem.free)] = [point[names.index(n)] for n in problem.free]
    return shared


def _with_period(problem: OutputError, records: Sequence[Record]) -> Array:
    """Return the model's own values with the restoring of the records' median period, (2 pi / T)^2."""
    shared, roll = problem.start(), problem.model.states[0]
    if RESTORING in problem.free:
        period = float(np.median([dominant_period(record[roll], record.dt) for record in records]))
        shared[problem.free.index(RESTORING)] = (2.0 * np.pi / period) ** 2
    return shared


def weak_form_start(model: Model, records: Sequence[Record], seconds: float, rounds: int = 3) -> Array:
    """Free parameters from the weak form over all records, shape (free,); priors pull as far as the data leave room.

    Equations of states that stay constant in a record (positions nobody measured) are left out. A model with hidden
    states starts at its own values.
    """
    point = np.array([p.value for p in model.parameters.free])
    if hidden_states(model, records):
        return point
    states = tuple(measured_states(model, r) for r in records)
    inputs = tuple(inputs_of(model, r) for r in records)
    problem = WeakForm(model, states, inputs, records[0].dt, seconds, np.ones(len(model.states)))
    found, misfit = _solved(problem, point, rounds)
    if (unstable := course_unstable(model)) is not model:
        # a search does not pass through the infinite time constant between a stable and an unstable ship
        other, left = _solved(problem, np.array([p.value for p in unstable.parameters.free]), rounds)
        found = other if left < misfit else found
    return found


def _solved(problem: WeakForm, point: Array, rounds: int) -> tuple[Array, float]:
    """Return the weak form's solution from a point, and the sum of the logarithms of what it leaves of each rate."""
    states, point = problem.states, np.clip(point, problem.lower, problem.upper)
    is_varying = np.all([np.ptp(x, axis=0) > 0 for x in states], axis=0)
    floor = 1e-9 * np.max(np.abs(np.concatenate(states)), axis=0)  # share of the largest value that is rounding; chosen

    def spread(values: Array) -> Array:
        return np.maximum(np.sqrt(np.mean(problem.linearised(values)[0] ** 2, axis=0)), floor)

    for _ in range(rounds):
        problem = problem.weighted(np.where(is_varying, spread(point), np.inf))
        # of the weak form, at most; chosen
        point = levenberg_marquardt(problem, point, np.zeros((0, 0)), evaluations=30).solution.point
    return point, float(np.sum(np.log(spread(point)[is_varying])))


# Output error with the noise of each channel at what its residuals show, at every point of a search.


@dataclass(frozen=True, eq=False)
class ConcentratedLikelihood:
    """Negative log-likelihood with the noise levels concentrated out (Seber & Wild 1989, section 2.2.3).

    Sum of nu log(s) over channels: s the residuals' spread, nu their effective degrees of freedom. One search of it
    does what searches for given noise and estimates of the noise do in turn. With a robust loss the spread is that of
    the bulk, and the gradient that for a noise held there.

    Attributes:
        problem: whose `inflation` says how many samples count; its `noise` is not used.
        known_noise: channel -> stated noise, which stays.
    """

    problem: OutputError
    known_noise: Mapping[str, float]

    @property
    def lower(self) -> Array:
        """Lower bounds of the shared unknowns."""
        return self.problem.lower

    @property
    def upper(self) -> Array:
        """Upper bounds of the shared unknowns."""
        return self.problem.upper

    @cached_property
    def _stated(self) -> Array:
        return np.array([self.known_noise.get(o, np.nan) for o in self.problem.data.outputs])

    @cached_property
    def _degrees_of_freedom(self) -> Array:
        samples = np.isfinite(self.problem.data.measured).sum(axis=0) * degrees_of_freedom_share(self.problem)
        return samples if self.problem.inflation is None else samples / self.problem.inflation

    def cost(self, shared: Array, local: Array) -> float:
        """Return the negative log-likelihood with priors and other data; infinite where the model diverges."""
        residuals = self.residuals(shared, local)
        return np.inf if residuals is None else self._cost(self._spread(residuals), shared)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return the Gauss-Newton model at a point: that of the problem with the noise there."""
        residuals = self.residuals(shared, local)
        if residuals is None:
            return replace(self.problem.normal(shared, local), cost=np.inf)
        spread = self._spread(residuals)
        return replace(self._with_noise(spread).normal(shared, local), cost=self._cost(spread, shared))

    def residuals(self, shared: Array, local: Array) -> Array | None:
        """Return simulated minus measured, SI, (rows, ny), NaN where nothing was measured; None after a divergence."""
        simulated = self.problem.simulated_outputs(shared, local)
        return simulated - self.problem.data.measured if np.all(np.isfinite(simulated)) else None

    def settled_at(self, shared: Array, local: Array) -> OutputError:
        """Return the problem with the noise of a point, and with samples counted as its residuals are correlated."""
        residuals = self.residuals(shared, local)
        if residuals is None:
            return self.problem
        problem = self._with_noise(self._spread(residuals))
        return replace(problem, inflation=effective_inflation(residual_correlation(problem, residuals)[1]))

    def _spread(self, residuals: Array) -> Array:
        return residual_spread(self.problem, residuals)

    def _with_noise(self, spread: Array) -> OutputError:
        return replace(self.problem, noise=np.where(np.isfinite(self._stated), self._stated, spread))

    def _cost(self, spread: Array, shared: Array) -> float:
        of_channels = np.where(np.isfinite(self._stated), 0.5 * (spread / self._stated) ** 2, np.log(spread))
        return float(self._degrees_of_freedom @ of_channels) + self.problem.prior_cost(shared)


# Searches from several starting points: what a likelihood with more than one optimum needs.

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


_FIRST_EVALUATIONS = 20
"""Of each start before any is given up: most stand then nearer to their own optimum than optima lie apart; chosen."""
_ROUNDS = ((3, 20), (1, 40))
"""How many searches go on then, the best ones, and for how many evaluations each.

Chosen so that, of simulated craft, all searches end in the optimum next to the truth (benchmarks/thrusters_truth.py).
"""


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


def continued_start(begun: SeveralStarts, problem: OutputError, before: PointEstimate) -> SeveralStarts | None:
    """Return the start at the optimum of the same runs, of which inputs or instruments were taken otherwise.

    Coefficients that it does not have begin at their own values. None where unknowns of sessions or segments differ.
    """
    count, known = len(problem.free), len(before.problem.free)
    own, local = before.common_parameters[known:], before.optimum.local
    if len(own) != problem.size - count or local.shape != problem.measured_initial_states().shape:
        return None
    values = dict(zip(before.problem.free, before.common_parameters.tolist(), strict=False))
    point = problem.start()
    point[:count] = [values.get(name, value) for name, value in zip(problem.free, point.tolist(), strict=False)]
    point[count:] = own
    there = before.problem
    settled = replace(
        problem, noise=there.noise, inflation=there.inflation, population=there.population, substeps=there.substeps,
        huber=there.huber,
    )  # fmt: skip
    return replace(begun, start=SearchStart(settled, point, local, begun.start.origin))


def number_of_starts(model: Model, required: int | None) -> int:
    """Return how many points to search from: what the trial requires, else one unless thrusters drive the craft."""
    return required or (MANY_STARTS if model.has_thrusters else 1)


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
    for searches, evaluations in _ROUNDS:
        # the best one shows how correlated residuals are, so that samples count as they should
        best = min(attempts, key=lambda a: a.loss)
        likelihood = replace(likelihood, problem=likelihood.settled_at(best.shared, best.local))
        attempts = sorted((a.scored(likelihood, local) for a in attempts), key=lambda a: a.loss)
        attempts[:searches] = [a.continued(likelihood, evaluations) for a in attempts[:searches]]
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
