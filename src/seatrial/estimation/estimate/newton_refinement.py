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
    """Take quasi-Newton steps by the exact gradient, none where it vanishes; return the decrement that is left, too."""
    point, count = optimum.solution.point, optimum.solution.evaluations
    exact = replace(problem, steps=problem.difference_steps(point, optimum.normal.hessian))
    normal = exact.normal(point, _NO_INITIAL_STATES)
    curved = normal
    for _ in range(_NEWTON_STEPS):
        step, slope = _newton_step(exact, point, curved)
        if slope <= _MAX_DECREMENT:
            break
        trials = [np.clip(point + share * step, exact.lower, exact.upper) for share in _STEP_SHARES]
        costs = [exact.cost(trial, _NO_INITIAL_STATES) for trial in trials]
        best = int(np.argmin(costs))
        if not costs[best] < normal.cost:
            if curved is normal:
                break
            curved = normal  # once more by the expected information
            continue
        before, moved = normal, trials[best] - point
        point, normal, count = (trials[best], exact.normal(trials[best], _NO_INITIAL_STATES), count + 1)
        hessian = with_curvature(curved.hessian, moved, normal.gradient - before.gradient)
        curved = replace(normal, hessian=hessian)
    slope = _newton_step(exact, point, curved)[1]
    status = Status.CONVERGED if slope <= _MAX_DECREMENT else Status.STALLED
    history = (*optimum.solution.history, normal.cost)
    solution = replace(
        optimum.solution, point=point, value=normal.cost, status=status, evaluations=count, history=history
    )
    return exact, Optimum(solution, _NO_INITIAL_STATES, normal), slope


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
