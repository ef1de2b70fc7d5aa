"""Runge-Kutta steps in a sample of an output-error problem: none so long that its error shows beside the noise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import NormalEquations, Optimum, bounded_step
from seatrial.physics.simulate.batch import MOST_SUBSTEPS, SIMULATION_ERROR, is_within_range, sufficient_substeps

_START_ERROR = 0.1
"""Error of the outputs with which a search may begin (rms, share of the noise); chosen."""

_OPTIMUM_ERROR = 0.1
"""What halving the step may move a coefficient at the optimum (share of its standard error); chosen."""


def with_steps_of_start(problem: OutputError, shared: Array, local: Array) -> OutputError:
    """Return the problem with enough steps in a sample for a search that begins at a point."""
    if problem.model.is_affine:
        return problem

    def is_close(coarse: Array, fine: Array) -> bool:
        error = np.sqrt(np.mean((fine - coarse) ** 2, axis=0)) if len(fine) else np.zeros(1)
        return bool(np.all(error <= _START_ERROR * problem.noise))

    simulate = _simulation(problem, shared, local)
    return replace(problem, substeps=sufficient_substeps(simulate, is_close, problem.substeps))


def _simulation(problem: OutputError, shared: Array, local: Array) -> Callable[[int], Array]:
    """Return the outputs at a point, (rows, ny), by the number of steps in a sample."""

    def simulate(count: int) -> Array:
        with np.errstate(all="ignore"):
            return replace(problem, substeps=count).simulated_outputs(shared, local)

    return simulate


def sufficient_steps_of_optimum(problem: OutputError, optimum: Optimum, least: int) -> int:
    """Return so many steps in a sample, `least` or more, that halving them leaves a problem's optimum where it is.

    Records of less noise than a simulation errs by, which a simulation wrote, are followed as closely as that.
    """
    shared, count = optimum.solution.point, least
    if problem.model.is_affine or not np.isfinite(optimum.normal.cost):
        return problem.substeps

    def normal(substeps: int) -> NormalEquations:
        with np.errstate(all="ignore"):
            return replace(problem, substeps=substeps).normal(shared, optimum.local)

    if np.all(problem.noise <= SIMULATION_ERROR * np.nanstd(problem.data.measured, axis=0)):
        return sufficient_substeps(_simulation(problem, shared, optimum.local), is_within_range, least)
    before = optimum.normal if count == problem.substeps else normal(count)
    while 2 * count <= MOST_SUBSTEPS:
        after = normal(2 * count)
        is_finite = np.isfinite(before.cost) and np.isfinite(after.cost)
        if is_finite and _is_same_optimum(problem, shared, before, after, len(problem.free)):
            return count
        count, before = 2 * count, after
    return count if np.isfinite(before.cost) else problem.substeps


def sufficient_steps_of_filter(problem: PredictionError, optimum: Optimum) -> int:
    """Return so many steps in a sample, the problem's own or more, that halving them leaves its optimum where it is."""
    shared, count = optimum.solution.point, problem.runs.substeps
    if problem.runs.model.is_affine or not np.isfinite(optimum.normal.cost):
        return count

    def normal(substeps: int) -> NormalEquations:
        with np.errstate(all="ignore"):
            return filter_with_steps(problem, substeps).normal(shared, optimum.local)

    before = normal(count)
    while 2 * count <= MOST_SUBSTEPS:
        after = normal(2 * count)
        if not np.isfinite(after.cost) or _is_same_optimum(problem, shared, before, after, len(problem.runs.free)):
            break
        count, before = 2 * count, after
    return count


def filter_with_steps(problem: PredictionError, substeps: int) -> PredictionError:
    """Return the problem with so many steps in a sample."""
    return replace(problem, runs=replace(problem.runs, substeps=substeps), steps=None)


def _is_same_optimum(
    problem: OutputError | PredictionError, shared: Array, before: NormalEquations, after: NormalEquations, count: int
) -> bool:  # fmt: skip
    """Whether a Gauss-Newton step for the change of the gradient moves none of `count` coefficients by too much."""
    gradient, hessian = after.without_local()
    reduced = replace(after, gradient=gradient - before.without_local()[0], hessian=hessian)
    step = bounded_step(reduced, problem.lower - shared, problem.upper - shared)[:count]
    error = np.sqrt(np.maximum(np.diagonal(inverse(hessian)), 0.0))[: len(step)]
    return bool(np.all(np.abs(step) <= _OPTIMUM_ERROR * error))


def integration_text(problem: OutputError) -> str:
    """Return how many steps a sample takes and what they cost; empty of one."""
    count = problem.substeps
    if count == 1:
        return ""
    return (
        f"the craft moves within a sample of {problem.data.dt:.3g} s: {count} Runge-Kutta steps in each, which take up "
        f"to {count} times as long as one"
    )
