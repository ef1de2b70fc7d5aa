"""The end of a search for prediction error: quasi-Newton steps by the exact gradient, within the bounds.

The expected information begins as the curvature. Of weak disturbances the cost curves otherwise, and steps by it alone
go to and fro across the valley; each step's change of the gradient corrects it (Broyden, Fletcher, Goldfarb, Shanno),
damped so that it stays positive (Powell 1978; Nocedal & Wright 2006, Numerical Optimization, procedure 18.2).
"""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import NormalEquations, Optimum, Solution, Status, bounded_step, predicted_decrease

_MAX_DECREMENT = 1e-3  # decrease of the cost that a Newton step still promises at an optimum, ours
# most steps by the exact gradient, and shares of one of which the best is taken, ours: intensity and memory of a weak
# disturbance are far from quadratic, so that whole steps overshoot, and each costs as much as fifty evaluations
_NEWTON_STEPS, _STEP_SHARES = 30, (1.0, 0.5, 0.25, 0.125)
_LEAST_CURVATURE = 0.2  # of the believed curvature along a step (Powell 1978)
# the filter eliminates initial states: there are no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))


def refine_by_newton(problem: PredictionError, optimum: Optimum) -> tuple[PredictionError, Optimum, float]:
    """Take quasi-Newton steps by the exact gradient, none where it vanishes; return the decrement that is left, too.

    Differences to one side lead near the optimum at half the cost; those to both sides have the last word.
    """
    exact = replace(problem, steps=problem.difference_steps(optimum.solution.point, optimum.normal.hessian))
    one_sided = replace(exact, is_one_sided=True)
    begun = one_sided.normal(optimum.solution.point, _NO_INITIAL_STATES)
    near = _descend(one_sided, _Descent(optimum.solution.point, begun, begun.hessian))
    end = _descend(exact, replace(near, normal=exact.normal(near.point, _NO_INITIAL_STATES)))
    slope = _newton_step(exact, end.point, end.curved)[1]
    solution = replace(
        optimum.solution, point=end.point, value=end.normal.cost,
        status=Status.CONVERGED if slope <= _MAX_DECREMENT else Status.STALLED,
        evaluations=optimum.solution.evaluations + end.count, history=(*optimum.solution.history, end.normal.cost),
    )  # fmt: skip
    return exact, Optimum(solution, _NO_INITIAL_STATES, end.normal), slope


@dataclass(frozen=True, eq=False)
class _Descent:
    """Where quasi-Newton steps have come to; hessian: the curvature that they believe, count: steps so far."""

    point: Array
    normal: NormalEquations
    hessian: Array
    count: int = 0

    @property
    def curved(self) -> NormalEquations:
        """The gradient with the curvature that is believed."""
        return replace(self.normal, hessian=self.hessian)


def _descend(problem: PredictionError, descent: _Descent) -> _Descent:
    """Step until no more than `_MAX_DECREMENT` is promised, or until no step decreases the cost."""
    while descent.count < _NEWTON_STEPS:
        step, slope = _newton_step(problem, descent.point, descent.curved)
        if slope <= _MAX_DECREMENT:
            break
        trials = [np.clip(descent.point + share * step, problem.lower, problem.upper) for share in _STEP_SHARES]
        costs = [problem.cost(trial, _NO_INITIAL_STATES) for trial in trials]
        best = int(np.argmin(costs))
        if not costs[best] < descent.normal.cost:
            if descent.hessian is descent.normal.hessian:
                break
            descent = replace(descent, hessian=descent.normal.hessian)  # once more by the expected information
            continue
        point, normal = trials[best], problem.normal(trials[best], _NO_INITIAL_STATES)
        hessian = with_curvature(descent.hessian, point - descent.point, normal.gradient - descent.normal.gradient)
        descent = _Descent(point, normal, hessian, descent.count + 1)
    return descent


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


@dataclass(frozen=True, eq=False)
class NewtonOptimum:
    """Where one Newton step leads; decrement: half the squared distance from its begin, in the information's metric."""

    optimum: Optimum
    decrement: float


def newton_optimum(problem: PredictionError, few: Optimum, share: float) -> NewtonOptimum:
    """The optimum of a problem by one Newton step from that of some of its samples, `share` of which it has more.

    The gradient is taken by differences to one side, a filter pass for each unknown.
    """
    point = few.solution.point
    steps = problem.difference_steps(point, share * few.normal.hessian)
    normal = replace(problem, steps=steps, is_one_sided=True).normal(point, _NO_INITIAL_STATES)
    step, decrement = _newton_step(problem, point, normal)
    moved = np.clip(point + step, problem.lower, problem.upper)
    cost = normal.cost - decrement if np.isfinite(decrement) else np.inf
    solution = Solution(moved, cost, Status.CONVERGED, few.solution.evaluations + 1)
    optimum = Optimum(solution, _NO_INITIAL_STATES, replace(normal, cost=cost))
    return NewtonOptimum(optimum, decrement)


def newton_step(problem: PredictionError, point: Array) -> Array:
    """The point after one full Newton step, within the bounds."""
    step, _ = _newton_step(problem, point, problem.normal(point, _NO_INITIAL_STATES))
    return np.clip(point + step, problem.lower, problem.upper)


def _newton_step(problem: PredictionError, point: Array, normal: NormalEquations) -> tuple[Array, float]:
    """Newton step within the bounds, and the decrease of the cost that it promises.

    Where no bound is in the way that is half the squared gradient in the information's metric. Where gradient or
    information overflow, no step is known: none is taken, and infinitely much is left.
    """
    low, high, slope = problem.lower, problem.upper, normal.gradient
    free = (low < high) & ~((point <= low) & (slope > 0)) & ~((point >= high) & (slope < 0))
    gradient, hessian = slope[free], normal.hessian[np.ix_(free, free)]
    if not (np.all(np.isfinite(gradient)) and np.all(np.isfinite(hessian))):
        return np.zeros_like(point), np.inf
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))  # above zero, for a division
    # rounding of a singular matrix; chosen
    solved = scale * np.linalg.lstsq(hessian * scale[:, None] * scale, scale * gradient, rcond=1e-12)[0]
    step = np.zeros_like(point)
    step[free] = -solved
    if np.all((point + step >= low) & (point + step <= high)):
        return step, float(0.5 * gradient @ solved)
    step = bounded_step(normal, low - point, high - point)
    return step, predicted_decrease(normal, step, _NO_INITIAL_STATES)
