"""The end of a search for prediction error: quasi-Newton steps by the exact gradient, within the bounds.

The expected information begins as the curvature. Of weak disturbances the cost curves otherwise, and steps by it alone
go to and fro across the valley; each step's change of the gradient corrects it (Broyden, Fletcher, Goldfarb, Shanno),
damped so that it stays positive (Powell 1978; Nocedal & Wright 2006, Numerical Optimization, procedure 18.2).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import NEAR_ENOUGH
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import NormalEquations, Optimum, Solution, Status, bounded_step, predicted_decrease

_MAX_DECREMENT = 1e-3  # decrease of the cost that a Newton step still promises at an optimum, ours
# most steps by the exact gradient, and shares of one of which the best is taken, ours: intensity and memory of a weak
# disturbance are far from quadratic, so that whole steps overshoot, and each costs as much as fifty evaluations
_NEWTON_STEPS, _STEP_SHARES = 30, (1.0, 0.5, 0.25, 0.125)
# by which all shares are made smaller where none decreases the cost, as in a narrow valley that bends; ours
_SHORTER = (1.0, 1.0 / 16.0, 1.0 / 256.0)
_LEAST_CURVATURE = 0.2  # of the believed curvature along a step (Powell 1978)
_DETERMINED = 2.0  # standard errors above zero from which on a variance is searched by its logarithm; chosen
_FARTHEST = 2.0  # logarithm of the factor by which one step changes a size or time at most; chosen
# how often steps of differences are renewed at most, and the factor by which they are wrong then; chosen
_RENEWALS, _WRONG_STEPS = 2, 3.0
# along the principal axes: rounds at most, standard errors of values to either side and of the farthest step, and the
# least information on an axis over the largest of an unknown (a longer one is not determined); chosen
_ROUNDS, _ASIDE, _FARTHEST_ASIDE, _LEAST_INFORMATION = 5, 0.3, 4.0, 1e-6
# the filter eliminates initial states: there are no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))


def refine_by_newton(problem: PredictionError, optimum: Optimum) -> tuple[PredictionError, Optimum, float]:
    """Take quasi-Newton steps by the exact gradient, none where it vanishes; return the decrement that is left, too.

    Differences to one side lead near the optimum at half the cost, with new steps where the search went so far that
    theirs no longer suit; those to both sides have the last word. Where they stall, as in a valley so narrow that
    errors of the gradient lead out of it, the cost itself is asked along the principal axes.
    """
    steps = problem.difference_steps(optimum.solution.point, optimum.normal.hessian)
    near = _descend(replace(problem, steps=steps, is_one_sided=True), optimum.solution.point, 0)
    for _ in range(_RENEWALS):
        used, steps = steps, problem.difference_steps(near.point, near.normal.hessian)
        is_wrong = np.abs(np.log(steps / np.where(used > 0.0, used, steps))) > np.log(_WRONG_STEPS)
        if not np.any(is_wrong & (problem.lower < problem.upper)):
            steps = used
            break
        near = _descend(replace(problem, steps=steps, is_one_sided=True), near.point, near.count)
    exact = replace(problem, steps=steps)
    end = _descend(exact, near.point, near.count)
    if end.decrement > NEAR_ENOUGH:
        end = _along_axes(exact, end)
    slope = end.decrement
    solution = replace(
        optimum.solution, point=end.point, value=end.normal.cost,
        status=Status.CONVERGED if slope <= NEAR_ENOUGH else Status.STALLED,
        evaluations=optimum.solution.evaluations + end.count, history=(*optimum.solution.history, end.normal.cost),
    )  # fmt: skip
    return exact, Optimum(solution, _NO_INITIAL_STATES, end.normal), slope


def approach_by_gradient(problem: PredictionError, point: Array, most_steps: int) -> tuple[Optimum, float]:
    """Take so many quasi-Newton steps towards an optimum at most; return where they end and the decrement left there.

    By differences to one side, whose steps come from the information that takes the filter's gain as given.
    """
    steps = problem.difference_steps(point, replace(problem, steps=None).normal(point, _NO_INITIAL_STATES).hessian)
    end = _descend(replace(problem, steps=steps, is_one_sided=True), point, 0, most_steps)
    solution = Solution(end.point, end.normal.cost, Status.STALLED, end.count)
    return Optimum(solution, _NO_INITIAL_STATES, end.normal), end.decrement


@dataclass(frozen=True, eq=False)
class _Descent:
    """Where quasi-Newton steps have come to; count: steps so far, decrement: what another one promises."""

    point: Array
    normal: NormalEquations
    count: int
    decrement: float


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """Logarithms of some unknowns, the others themselves; `is_log`: which."""

    is_log: NDArray[np.bool_]

    @classmethod
    def near(cls, problem: PredictionError, point: Array, hessian: Array) -> "_Coordinates":
        """Return those that suit a point: what is positive by its bounds, and variances that are not near zero."""
        error = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))  # above zero, for a division
        is_variance = np.arange(len(point)) >= problem.runs.size
        return cls((point > 0.0) & ((problem.lower > 0.0) | (is_variance & (point > _DETERMINED * error))))

    def normal(self, normal: NormalEquations, point: Array) -> NormalEquations:
        """Return gradient and Hessian by these coordinates."""
        scale = np.where(self.is_log, point, 1.0)
        return replace(normal, gradient=scale * normal.gradient, hessian=normal.hessian * np.outer(scale, scale))

    def room(self, problem: PredictionError, point: Array) -> tuple[Array, Array]:
        """Return the least and the largest step."""
        with np.errstate(divide="ignore", invalid="ignore"):
            down, up = np.log(problem.lower / point), np.log(problem.upper / point)
        low = np.where(self.is_log, np.maximum(down, -_FARTHEST), problem.lower - point)
        high = np.where(self.is_log, np.minimum(up, _FARTHEST), problem.upper - point)
        return low, high

    def moved(self, point: Array, step: Array) -> Array:
        """Return the point after a step; infinite, and so without a likelihood, where no number is so large."""
        with np.errstate(over="ignore"):
            return np.where(self.is_log, point * np.exp(np.where(self.is_log, step, 0.0)), point + step)

    def way(self, point: Array, end: Array) -> Array:
        """Return the step from one point to another."""
        ratio = np.where(self.is_log, end, 1.0) / np.where(self.is_log, point, 1.0)
        return np.where(self.is_log, np.log(ratio), end - point)


def _descend(problem: PredictionError, point: Array, count: int, most_steps: int = _NEWTON_STEPS) -> _Descent:
    """Step until no more than `_MAX_DECREMENT` is promised, or until no step decreases the cost."""
    normal = problem.normal(point, _NO_INITIAL_STATES)
    coordinates = _Coordinates.near(problem, point, normal.hessian)
    here = coordinates.normal(normal, point)
    hessian, is_expected = here.hessian, True
    while True:
        room = coordinates.room(problem, point)
        step, decrement = step_within(room, replace(here, hessian=hessian))
        if decrement <= _MAX_DECREMENT or count >= most_steps:
            return _Descent(point, normal, count, decrement)
        end = _best_along(problem, coordinates, point, step, normal.cost)
        if end is None:
            if is_expected:
                return _Descent(point, normal, count, decrement)
            hessian, is_expected = here.hessian, True  # once more by the expected information
            continue
        normal = problem.normal(end, _NO_INITIAL_STATES)
        after = coordinates.normal(normal, end)
        hessian = with_curvature(hessian, coordinates.way(point, end), after.gradient - here.gradient)
        point, here, count, is_expected = end, after, count + 1, False


def _best_along(
    problem: PredictionError, coordinates: _Coordinates, point: Array, step: Array, cost: float
) -> Array | None:
    """Return the best of some shares of a step, of smaller ones where none is better; None: none decreases the cost."""
    for scale in _SHORTER:
        trials = [
            np.clip(coordinates.moved(point, scale * share * step), problem.lower, problem.upper)
            for share in _STEP_SHARES
        ]
        costs = [problem.cost(trial, _NO_INITIAL_STATES) for trial in trials]
        best = int(np.argmin(costs))
        if costs[best] < cost:
            return trials[best]
    return None


def _along_axes(problem: PredictionError, end: _Descent) -> _Descent:
    """Go to the least of the parabola along each principal axis of the information, until a round gains little.

    Parabolas are through three values of the cost: where an axis is long, they see what slopes by short differences
    miss (Brent 1973, Algorithms for minimization without derivatives, chapter 7). The decrement is what the last round
    gained.
    """
    point, cost, gain = end.point, end.normal.cost, np.inf
    for _ in range(_ROUNDS):
        normal = problem.normal(point, _NO_INITIAL_STATES) if point is not end.point else end.normal
        coordinates = _Coordinates.near(problem, point, normal.hessian)
        before = cost
        for axis in _principal_axes(coordinates.normal(normal, point).hessian):
            point, cost = _least_along(problem, coordinates, point, cost, axis)
        gain = before - cost
        if gain <= NEAR_ENOUGH:
            break
    return _Descent(point, problem.normal(point, _NO_INITIAL_STATES), end.count, gain)


def _principal_axes(hessian: Array) -> Array:
    """Return the principal axes of an information matrix in the unknowns' own scales, each a standard error long."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))  # above zero, for a division
    values, vectors = np.linalg.eigh(hessian * scale[:, None] * scale)
    return (vectors * scale[:, None] / np.sqrt(np.maximum(values, _LEAST_INFORMATION))).T


def _least_along(
    problem: PredictionError, coordinates: _Coordinates, point: Array, cost: float, axis: Array
) -> tuple[Array, float]:
    """Return the least of a point, two beside it along an axis and the least of the parabola through them."""

    def beside(share: float) -> tuple[float, Array]:
        moved = np.clip(coordinates.moved(point, share * axis), problem.lower, problem.upper)
        return problem.cost(moved, _NO_INITIAL_STATES), moved

    sides = [beside(-_ASIDE), beside(_ASIDE)]
    curvature, slope = (sides[0][0] + sides[1][0] - 2.0 * cost) / _ASIDE**2, (sides[1][0] - sides[0][0]) / 2.0 / _ASIDE
    is_bowl = np.isfinite(slope) and curvature > 0.0
    least = [beside(float(np.clip(-slope / curvature, -_FARTHEST_ASIDE, _FARTHEST_ASIDE)))] if is_bowl else []
    best = min([*sides, *least], key=lambda one: one[0])
    return (best[1], best[0]) if best[0] < cost else (point, cost)


def with_curvature(hessian: Array, moved: Array, gradient_change: Array) -> Array:
    """Return a positive curvature (k, k) that agrees with the change of the gradient, (k,), over a step, (k,).

    Where the cost curves by less than `_LEAST_CURVATURE` of what is believed, with that much.
    """
    pull = hessian @ moved
    believed, actual = float(moved @ pull), float(moved @ gradient_change)
    if believed <= 0.0:
        return hessian
    # Nocedal & Wright 2006, eqs (18.15) and (18.16)
    share = 1.0 if actual >= _LEAST_CURVATURE * believed else (1.0 - _LEAST_CURVATURE) * believed / (believed - actual)
    change = share * gradient_change + (1.0 - share) * pull
    return hessian - np.outer(pull, pull) / believed + np.outer(change, change) / float(moved @ change)


def newton_optimum(problem: PredictionError, few: Optimum, share: float) -> tuple[Optimum, float]:
    """The optimum of a problem by one Newton step from that of some of its samples, `share` of which it has more.

    With it half the squared length of the step, in the information's metric.
    The gradient is taken by differences to one side, a filter pass for each unknown.
    """
    point = few.solution.point
    steps = problem.difference_steps(point, share * few.normal.hessian)
    normal = replace(problem, steps=steps, is_one_sided=True).normal(point, _NO_INITIAL_STATES)
    step, decrement = step_within((problem.lower - point, problem.upper - point), normal)
    moved = np.clip(point + step, problem.lower, problem.upper)
    cost = normal.cost - decrement if np.isfinite(decrement) else np.inf
    solution = Solution(moved, cost, Status.CONVERGED, few.solution.evaluations + 1)
    optimum = Optimum(solution, _NO_INITIAL_STATES, replace(normal, cost=cost))
    return optimum, decrement


def newton_step(problem: PredictionError, point: Array) -> Array:
    """The point after one full Newton step, within the bounds."""
    room = problem.lower - point, problem.upper - point
    return np.clip(
        point + step_within(room, problem.normal(point, _NO_INITIAL_STATES))[0], problem.lower, problem.upper
    )


def step_within(room: tuple[Array, Array], normal: NormalEquations) -> tuple[Array, float]:
    """Return the Newton step within its room (least, largest), and the decrease of the cost that it promises.

    Where no bound is in the way that is half the squared gradient in the information's metric. Where gradient or
    information overflow, no step is known: none is taken, and infinitely much is left.
    """
    (low, high), slope = room, normal.gradient
    free = (low < high) & ~((low >= 0.0) & (slope > 0)) & ~((high <= 0.0) & (slope < 0))
    gradient, hessian = slope[free], normal.hessian[np.ix_(free, free)]
    step = np.zeros_like(slope)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))  # above zero, for a division
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is looked for below
        scaled, slopes = hessian * scale[:, None] * scale, scale * gradient
    if not (np.all(np.isfinite(slopes)) and np.all(np.isfinite(scaled))):
        return step, np.inf
    solved = scale * np.linalg.lstsq(scaled, slopes, rcond=1e-12)[0]  # rounding of a singular matrix; chosen
    step[free] = -solved
    if np.all((step >= low) & (step <= high)):
        return step, float(0.5 * gradient @ solved)
    step = bounded_step(normal, low, high)
    return step, predicted_decrease(normal, step, _NO_INITIAL_STATES)
