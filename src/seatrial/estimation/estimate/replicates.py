"""The same estimate from other runs: one left out each, or as many drawn with replacement.

Noise levels and effective numbers of samples stay those of the joint fit, so that only the runs differ.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.information.covariance import left_out_steps
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import mapped

Counted = Callable[[int, int], None]

_NEGLIGIBLE = 1e-4


def stepped(made: Estimate) -> Array:
    """Shared unknowns with each run left out by one Gauss-Newton step from stored normal equations, (runs, k)."""
    problem = made.problem
    blocks = problem.blocks(made.shared, made.optimum.local)
    parts = [
        problem.assembled(blocks, made.shared, problem.data.of_run(r), with_prior=False).reduced()
        for r in range(len(problem.data.runs))
    ]
    hessian = made.optimum.normal.reduced()[1]
    return made.shared + left_out_steps(hessian, np.array([g for g, _ in parts]), np.array([h for _, h in parts]))


def left_out(made: Estimate, workers: int | None = None, progress: Counted | None = None) -> Array:
    """Shared unknowns with each run left out, fitted again in full, (runs, k)."""
    runs = range(len(made.problem.data.runs))
    chosen = [np.concatenate([made.problem.data.of_run(r) for r in runs if r != out]) for out in runs]
    return np.array(mapped(lambda one: _again(made, one), chosen, workers=workers, progress=progress))


def drawn(
    made: Estimate, count: int, rng: np.random.Generator, workers: int | None = None, progress: Counted | None = None
) -> Array:
    """Shared unknowns of `count` fits to runs drawn with replacement, (count, k) (Efron 1979)."""
    runs = len(made.problem.data.runs)
    draws = rng.integers(0, runs, (count, runs))
    chosen = [np.concatenate([made.problem.data.of_run(r) for r in draw]) for draw in draws]
    return np.array(mapped(lambda one: _again(made, one), chosen, workers=workers, progress=progress))


def _again(made: Estimate, chosen: Index) -> Array:
    """Shared unknowns fitted to some segments, begun at the joint optimum."""
    problem = replace(made.problem, data=made.problem.data.taken(chosen), workers=1)
    local = made.optimum.local[chosen]
    return levenberg_marquardt(problem, made.shared, local, negligible=_NEGLIGIBLE).solution.point
