"""Levenberg-Marquardt with shared and local unknowns, and the solution that every optimiser returns."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

# What an optimiser found.

Array = NDArray[np.float64]


class Status(StrEnum):
    """How a search ended; the text says what to do next."""

    CONVERGED = "converged: no smaller residual within rounding"
    STALLED = "stalled: no step lowers the residual; check the model, or start elsewhere"
    EXHAUSTED = "stopped at the evaluation limit; raise it, or look at the history for slow directions"
    FAILED = "the residual could not be evaluated at the start; check start values and records"

    @property
    def is_success(self) -> bool:
        """Whether the point can be used."""
        return self is Status.CONVERGED


@dataclass(frozen=True, eq=False)
class Solution:
    """A point, its value (half the sum of squared residuals, or an objective) and how it was reached.

    Attributes:
        point: shape (n,), physical units.
        value: objective at the point.
        evaluations: number of objective evaluations.
        history: best value after each iteration.
        seed: of the search, where it draws at random.
    """

    point: Array
    value: float
    status: Status
    evaluations: int
    history: tuple[float, ...] = ()
    seed: int | None = None


# Levenberg-Marquardt for least squares with shared and local unknowns, bounds on the shared ones.

# where no step lowers the cost: promises this small, against the cost and against the first cost, are rounding
_ROUNDING = 1e-8
_EXHAUSTED = 1e-20  # of the first cost, as above


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """Gauss-Newton model of half the sum of squares about one point.

    Attributes:
        cost: half the sum of squared residuals (robust loss included).
        gradient, hessian: shared unknowns, shapes (n,), (n, n).
        local_gradient, local_hessian, cross: blocks, shapes (s, m), (s, m, m), (s, n, m).
    """

    cost: float
    gradient: Array
    hessian: Array
    local_gradient: Array
    local_hessian: Array
    cross: Array

    def solve_local(self, right: Array) -> Array:
        """Return the local blocks' solutions for right-hand sides, both (s, m, k)."""
        return np.asarray(np.linalg.solve(_with_ridge(self.local_hessian), right), dtype=np.float64)

    def without_local(self) -> tuple[Array, Array]:
        """Return gradient and Hessian of the shared unknowns with the local ones eliminated at their optimum."""
        if self.local_gradient.size == 0:
            return self.gradient, self.hessian
        solved = self.solve_local(np.swapaxes(self.cross, 1, 2))
        hessian = self.hessian - _sum_of_products(self.cross, solved)
        gradient = self.gradient - np.einsum("sj,sjk->k", self.local_gradient, solved)
        return gradient, hessian


class LeastSquaresProblem(Protocol):
    """What the optimiser asks of a problem; `local` has shape (s, m), possibly with m = 0."""

    @property
    def lower(self) -> Array:
        """Lower bounds of the shared unknowns."""
        ...

    @property
    def upper(self) -> Array:
        """Upper bounds of the shared unknowns."""
        ...

    def cost(self, shared: Array, local: Array) -> float:
        """Return half the sum of squares; infinite where the model cannot be evaluated."""
        ...

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return the Gauss-Newton model at a point."""
        ...


@dataclass(frozen=True, eq=False)
class Optimum:
    """Solution with its local unknowns and the Gauss-Newton model there."""

    solution: Solution
    local: Array
    normal: NormalEquations


def _sum_of_products(cross: Array, solved: Array) -> Array:
    """Return the sum of cross_s solved_s over all s, (n, k), of (s, n, m) and (s, m, k), as one matrix product."""
    blocks, rows, inner = cross.shape
    return np.swapaxes(cross, 0, 1).reshape(rows, blocks * inner) @ solved.reshape(blocks * inner, -1)


def _with_ridge(blocks: Array) -> Array:
    """Return blocks with a relative rounding-size ridge, so that an unobservable local direction stays put.

    A block of zeros, of a segment in which nothing was measured, is 1e-14 of the unit matrix.
    """
    diagonal = np.einsum("sii->si", blocks)
    largest = diagonal.max(axis=1, keepdims=True)
    ridge = 1e-12 * diagonal + 1e-14 * np.where(largest > 0.0, largest, 1.0)  # rounding of double precision; chosen
    return blocks + np.einsum("si,ij->sij", ridge, np.eye(blocks.shape[1]))


def _step(normal: NormalEquations, damping: float, low: Array, high: Array) -> tuple[Array, Array]:
    """Return the damped Gauss-Newton step with low <= shared step <= high."""
    hessian = normal.hessian.copy()
    diagonal = hessian.reshape(-1)[:: len(hessian) + 1]
    diagonal += damping * np.where(diagonal > 0, diagonal, 1.0)
    if not normal.local_gradient.size:
        return _solve_bounded(hessian, normal.gradient, low, high), normal.local_gradient
    local = _with_ridge(normal.local_hessian)
    local = local + damping * np.einsum("sii,ij->sij", local, np.eye(local.shape[1]))
    right = np.concatenate([np.swapaxes(normal.cross, 1, 2), normal.local_gradient[:, :, None]], axis=2)
    solved = np.linalg.solve(local, right)
    hessian = hessian - _sum_of_products(normal.cross, solved[:, :, :-1])
    gradient = normal.gradient - np.einsum("sij,sj->i", normal.cross, solved[:, :, -1])
    step = _solve_bounded(hessian, gradient, low, high)
    return step, -solved[:, :, -1] - solved[:, :, :-1] @ step


def _solve_bounded(hessian: Array, gradient: Array, low: Array, high: Array) -> Array:
    """Return the minimiser of the quadratic model in a box that holds zero (active sets; Stark & Parker 1995, BVLS)."""
    free = _solve(hessian, -gradient)
    if ((free >= low) & (free <= high)).all():
        return free
    step = np.zeros_like(gradient)
    held = ((low >= 0) & (gradient > 0)) | ((high <= 0) & (gradient < 0)) | (low >= high)
    for _ in range(3 * len(step) + 3):
        moving = ~held
        target = step.copy()
        pull = gradient[moving] + hessian[np.ix_(moving, held)] @ step[held]
        target[moving] = _solve(hessian[np.ix_(moving, moving)], -pull)
        way = target - step
        limit = np.where(way > 0, high, low)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(moving & (way != 0), (limit - step) / way, np.inf)
        if share.size and np.min(share) < 1.0:
            first = int(np.argmin(share))
            step = np.clip(step + max(share[first], 0.0) * way, low, high)
            step[first], held[first] = limit[first], True
            continue
        step = target
        # above zero, for a division
        slope = (gradient + hessian @ step) / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
        wrong = np.where(held & (low < high), np.where(step <= low, -slope, slope), -np.inf)
        if not wrong.size or np.max(wrong) <= 1e-12 * np.max(np.abs(slope)):  # rounding; chosen
            return step
        held[int(np.argmax(wrong))] = False
    return step


def _solve(matrix: Array, right: Array) -> Array:
    """Return symmetric solve in the unknowns' own scales; least squares where the matrix is singular to rounding."""
    from scipy.linalg.lapack import dposv

    if not len(right):
        return right
    scale = 1.0 / np.sqrt(np.maximum(np.abs(matrix.diagonal()), 1e-300))  # above zero, for a division
    scaled = matrix * scale[:, None] * scale
    _, found, failed = dposv(scaled.T, scale * right)
    # rounding of a singular matrix; chosen
    return scale * (np.linalg.lstsq(scaled, scale * right, rcond=1e-13)[0] if failed else found)


def bounded_step(normal: NormalEquations, low: Array, high: Array) -> Array:
    """Return the shared step to the minimum of the quadratic model with low <= step <= high, without local unknowns."""
    return _solve_bounded(normal.hessian, normal.gradient, low, high)


def predicted_decrease(normal: NormalEquations, step: Array, local_step: Array) -> float:
    """Return the decrease of the quadratic model along a step."""
    linear = normal.gradient @ step
    curved = step @ normal.hessian @ step
    if local_step.size:
        linear += np.sum(normal.local_gradient * local_step)
        curved += 2.0 * np.einsum("i,sij,sj->", step, normal.cross, local_step)
        curved += np.einsum("si,sij,sj->", local_step, normal.local_hessian, local_step)
    return float(-linear - 0.5 * curved)


def _clip_to_bounds(point: Array, problem: LeastSquaresProblem) -> Array:
    return np.minimum(np.maximum(point, problem.lower), problem.upper)


def levenberg_marquardt(
    problem: LeastSquaresProblem,
    shared: Array,
    local: Array,
    *,
    tolerance: float = 1e-10,  # promised decrease over the cost; chosen
    negligible: float = 0.0,
    sufficient: float = 0.0,
    evaluations: int = 100,
    damping: float = 1e-4,  # small: most starts are near; chosen
    report_progress: Callable[[int, float], None] | None = None,
) -> Optimum:
    """Minimise from a start; stops when the model promises less than `tolerance` of the cost, or rounding is reached.

    A promised decrease below `negligible` stops it too: where residuals are in standard deviations, 1e-8 is a move of
    some 1e-4 standard errors, and data without noise are not fitted down to their last bit. Where the evaluations run
    out, or no step lowers the cost, a promised decrease of `sufficient` or less counts as converged: kinks of a model
    (|r| r, sides of a rudder) keep the search from getting nearer.

    damping: of the first step, over the Hessian's diagonal; larger where the start is far from the optimum.

    Deterministic. The result's status says how it ended; bounds of the shared unknowns are never left.
    """
    shared = _clip_to_bounds(shared, problem)
    normal = problem.normal(shared, local)
    count, growth = 1, 2.0  # Nielsen 1999
    least = 1e-4 * damping  # after a rejected step; chosen
    history = [normal.cost]
    if not np.isfinite(normal.cost):
        return Optimum(Solution(shared, normal.cost, Status.FAILED, count), local, normal)
    status = Status.EXHAUSTED
    rejected = 0
    while count < evaluations:
        low, high = problem.lower - shared, problem.upper - shared
        step, local_step = _step(normal, damping, low, high)
        trial = _clip_to_bounds(shared + step, problem)
        trial_local = local + local_step
        predicted = predicted_decrease(normal, trial - shared, local_step)
        enough = max(tolerance * normal.cost, negligible)
        if predicted <= enough:  # else the undamped step, the model's minimum, promises more than enough too
            newton, local_newton = _step(normal, 0.0, low, high)
            if predicted_decrease(normal, newton, local_newton) <= enough:
                trial = _clip_to_bounds(shared + newton, problem)
                last = problem.normal(trial, local + local_newton)
                count += 1
                if last.cost <= normal.cost:
                    shared, local, normal = trial, local + local_newton, last
                history.append(normal.cost)
                status = Status.CONVERGED
                break
        cost = problem.cost(trial, trial_local)
        count += 1
        gain = (normal.cost - cost) / predicted if predicted > 0 else -1.0
        if np.isfinite(cost) and gain > 0:
            shared, local = trial, trial_local
            normal = problem.normal(shared, local)
            count += 1
            bold = gain > 0.8 and rejected == 0  # share of the promise that is kept; chosen
            # Nielsen 1999, eq. (2.4); a hundredth after a good step, chosen
            damping *= 0.01 if bold else max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3)
            damping, growth, rejected = max(damping, 1e-14), 2.0, 0  # rounding of double precision; chosen
        else:
            damping, growth, rejected = max(damping, least) * growth, growth * 2.0, rejected + 1
            # promised decrease that is rounding; rejected steps in a row; chosen
            if predicted <= 1e-14 * normal.cost or rejected > 25:
                rounding = max(_ROUNDING * normal.cost, _EXHAUSTED * history[0], sufficient)
                promised = predicted_decrease(normal, *_step(normal, 0.0, low, high))
                status = Status.CONVERGED if promised <= rounding else Status.STALLED
                break
        history.append(normal.cost)
        if report_progress:
            report_progress(count, normal.cost)
    if status is Status.EXHAUSTED and sufficient > 0.0:
        newton = _step(normal, 0.0, problem.lower - shared, problem.upper - shared)
        status = Status.CONVERGED if predicted_decrease(normal, *newton) <= sufficient else status
    return Optimum(Solution(shared, normal.cost, status, count, tuple(history)), local, normal)
