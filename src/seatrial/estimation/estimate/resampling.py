"""The same estimate from other runs: one left out each, or as many drawn with replacement.

Noise levels and effective numbers of samples stay those of the joint fit, so that only the runs differ.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.covariance import RunScores, inverse
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import map_in_threads

ReportCount = Callable[[int, int], None]

# promised decrease of the cost at which a refit ends, ours
_NEGLIGIBLE = 1e-4


def one_step_jackknife(estimate: PointEstimate, groups: Sequence[Sequence[int]] | None = None) -> Array:
    """Shared unknowns with each group of runs left out by one Gauss-Newton step from stored normal equations.

    groups: positions of runs; None: each run by itself. Returns (groups, k).
    """
    return estimate.common_parameters + run_scores(estimate, groups).left_out_steps


def run_scores(estimate: PointEstimate, groups: Sequence[Sequence[int]] | None = None) -> RunScores:
    """Return what each group of runs says of the shared unknowns at the estimate; None: each run by itself."""
    parts = _normals_of(estimate, groups or [[r] for r in range(len(estimate.problem.data.runs))])
    hessian = estimate.optimum.normal.without_local()[1]
    return RunScores.from_normals(hessian, np.array([g for g, _ in parts]), np.array([h for _, h in parts]))


@dataclass(frozen=True, eq=False)
class RunEstimates:
    """What each run by itself says of the shared unknowns: values and standard deviations, (runs, k); NaN: nothing.

    decreases: of each run's sum of squares over the noise, by values of its own, (runs,).
    """

    values: Array
    deviations: Array
    decreases: Array


def one_step_by_run(estimate: PointEstimate) -> RunEstimates:
    """Return the shared unknowns from each run alone, by one Gauss-Newton step from the joint estimate.

    theta_i - theta = -H_i^-1 g_i, with the covariance H_i^-1; priors are left out.
    """
    runs, size = len(estimate.problem.data.runs), len(estimate.common_parameters)
    values, deviations, decreases = np.full((runs, size), np.nan), np.full((runs, size), np.nan), np.zeros(runs)
    for k, (gradient, hessian) in enumerate(_normals_of(estimate, [[r] for r in range(runs)])):
        seen = np.flatnonzero(np.diag(hessian) > 0.0)
        covariance = inverse(hessian[np.ix_(seen, seen)])
        values[k, seen] = estimate.common_parameters[seen] - covariance @ gradient[seen]
        deviations[k, seen] = np.sqrt(np.diag(covariance))
        decreases[k] = gradient[seen] @ covariance @ gradient[seen]
    return RunEstimates(values, deviations, decreases)


def _normals_of(estimate: PointEstimate, groups: Sequence[Sequence[int]]) -> list[tuple[Array, Array]]:
    """Gradient and Hessian of each group of runs, local unknowns eliminated, priors left out."""
    problem = estimate.problem
    blocks = problem.segment_normals(estimate.common_parameters, estimate.optimum.local)
    return [
        problem.assemble(
            blocks, estimate.common_parameters, _segments_of(estimate, group), with_prior=False
        ).without_local()
        for group in groups
    ]


def full_jackknife(
    estimate: PointEstimate, workers: int | None = None, report_progress: ReportCount | None = None
) -> Array:
    """Shared unknowns with each run left out, fitted again in full, (runs, k)."""
    return fits_without(estimate, [[r] for r in range(len(estimate.problem.data.runs))], workers, report_progress)


def fits_without(
    estimate: PointEstimate,
    groups: Sequence[Sequence[int]],
    workers: int | None = None,
    report_progress: ReportCount | None = None,
) -> Array:
    """Shared unknowns with each group of runs (positions) left out, fitted again in full, (groups, k)."""
    runs = range(len(estimate.problem.data.runs))
    chosen = [_segments_of(estimate, [r for r in runs if r not in out]) for out in groups]
    return np.array(
        map_in_threads(lambda one: _refit(estimate, one), chosen, workers=workers, report_progress=report_progress)
    )


def _segments_of(estimate: PointEstimate, runs: Sequence[int]) -> Index:
    return np.concatenate([estimate.problem.data.run_segments(r) for r in runs])


def bootstrap_fits(
    estimate: PointEstimate,
    count: int,
    rng: np.random.Generator,
    workers: int | None = None,
    report_progress: ReportCount | None = None,
) -> Array:
    """Shared unknowns of `count` fits to runs drawn with replacement, (count, k) (Efron 1979)."""
    runs = len(estimate.problem.data.runs)
    draws = rng.integers(0, runs, (count, runs))
    chosen = [np.concatenate([estimate.problem.data.run_segments(r) for r in draw]) for draw in draws]
    return np.array(
        map_in_threads(lambda one: _refit(estimate, one), chosen, workers=workers, report_progress=report_progress)
    )


def _refit(estimate: PointEstimate, segments: Index) -> Array:
    """Shared unknowns fitted to some segments, begun at the joint optimum."""
    problem = replace(estimate.problem, data=estimate.problem.data.selected(segments), workers=1)
    local = estimate.optimum.local[segments]
    return levenberg_marquardt(problem, estimate.common_parameters, local, negligible=_NEGLIGIBLE).solution.point
