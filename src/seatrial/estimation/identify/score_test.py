"""What records say of parameters that a fit does not have: terms held, inputs that drift, errors of instruments.

One Gauss-Newton step from the optimum with one more parameter says how large it would be, over which standard error,
and what it would move (Rao 1948, Proc. Cambridge Phil. Soc. 44, 50-57: the score statistic is the square of size over
standard error). Residuals are the fit's own: simulated minus measured, or innovations with their variances.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.process_noise_interval import inverse_variances
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations


@dataclass(frozen=True, eq=False)
class Candidate:
    """A parameter that the fit does not have, none where it is 0.

    Attributes:
        problem_with: the problem of output error, over segments or whole runs, with the parameter at a size.
        step: size of differences; small where residuals are not linear in the parameter.
    """

    name: str
    problem_with: Callable[[OutputError, float], OutputError]
    step: float = 1.0


@dataclass(frozen=True, eq=False)
class ScoreTest:
    """Gradient (m,) and curvature (m, m) of the cost by candidates at none of them, all else at its optimum.

    Attributes:
        names: of the candidates; by_candidates: how the shared unknowns follow them, (shared, m).
    """

    names: tuple[str, ...]
    gradient: Array
    curvature: Array
    by_candidates: Array

    @property
    def information(self) -> Array:
        """Of the records on each candidate alone, (m,)."""
        return np.maximum(np.diag(self.curvature), 0.0)

    @property
    def sizes(self) -> Array:
        """Of each candidate alone, (m,), as the records want it in one step."""
        nothing = np.zeros(len(self.names))
        return np.divide(-self.gradient, self.information, out=nothing, where=self.information > 0.0)

    @property
    def scores(self) -> Array:
        """Of each candidate alone, (m,): its size over its standard error by the information."""
        return self.sizes * np.sqrt(self.information)

    def joint(self, prior: Array) -> tuple[Array, Array, float]:
        """Return sizes (m,) and covariance (m, m) of all together, and twice the gain of likelihood.

        prior: covariance before any record, (m, m), 0: none of it. With its root L the covariance is
        L (1 + L' C L)^-1 L' at the curvature C (Rasmussen & Williams 2006, eq. (A.9)), prior and C singular or not.
        """
        values, vectors = np.linalg.eigh(prior)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        inner = np.eye(len(prior)) + root.T @ self.curvature @ root
        covariance = np.asarray(root @ np.linalg.solve(inner, root.T), dtype=np.float64)
        sizes = np.asarray(-covariance @ self.gradient, dtype=np.float64)
        return sizes, covariance, float(-self.gradient @ sizes)


def added_input(name: str, added: Sequence[Array], step: float = 1.0) -> Candidate:
    """Return inputs in the model's signs on top of those of each whole run, (rows, nu) each, as a candidate.

    step: share of them that is simulated, small where the model is not linear in its inputs.
    """

    def problem_with(problem: OutputError, size: float) -> OutputError:
        data, runs = problem.data, problem.data.run_inputs
        assert runs is not None
        parts = []
        for segment, (first, start, _) in enumerate(runs.place):
            length = int(data.offsets[segment + 1] - data.offsets[segment])
            parts.append(added[int(data.run[segment])][first - start : first - start + length])
        whole = replace(runs, values=runs.values + size * np.concatenate(added))
        inputs = data.inputs + size * np.concatenate(parts)
        return replace(problem, data=replace(data, inputs=inputs, run_inputs=whole))

    return Candidate(name, problem_with, step)


def own_criterion(estimation: Estimation) -> PointEstimate | ProcessNoise:
    """Return the estimate by the criterion that its coefficients come from."""
    noise = estimation.process_noise
    return noise if noise is not None and estimation.has_process_noise else estimation.estimate


def score_test(estimate: PointEstimate | ProcessNoise, candidates: Sequence[Candidate]) -> ScoreTest:
    """Return what the records of an estimate say of each candidate.

    Raises:
        ArithmeticError: the simulation leaves what a computer can hold where a candidate is tried.
    """
    problem, point = estimate.problem, estimate.optimum.solution.point
    normal = (
        _innovation_normal(estimate, candidates)
        if isinstance(estimate, ProcessNoise)
        else _output_error_normal(estimate, candidates)
    )
    (gradient, hessian), size = normal.without_local(), len(point)
    moving = np.flatnonzero((point > problem.lower) & (point < problem.upper))
    by_candidates = np.zeros((size, len(candidates)))
    by_candidates[moving] = -inverse(hessian[np.ix_(moving, moving)]) @ hessian[moving, size:]
    curvature = hessian[size:, size:] + hessian[size:, :size] @ by_candidates
    gradient = gradient[size:] + by_candidates.T @ gradient[:size]
    if not (np.all(np.isfinite(curvature)) and np.all(np.isfinite(gradient))):
        raise ArithmeticError(f"the simulation diverges with {', '.join(c.name for c in candidates)}")
    return ScoreTest(tuple(c.name for c in candidates), gradient, 0.5 * (curvature + curvature.T), by_candidates)


def _output_error_normal(estimate: PointEstimate, candidates: Sequence[Candidate]) -> NormalEquations:
    """The normal equations with the candidates behind the shared unknowns."""
    problem, point, local = estimate.problem, estimate.common_parameters, estimate.optimum.local
    simulated, slopes = problem.simulated_outputs(point, local), problem.slopes(point, local)
    added = []
    for one in candidates:
        other = one.problem_with(problem, one.step)
        moved = other.simulated_outputs(point, local) - simulated - (other.data.measured - problem.data.measured)
        added.append(np.nan_to_num(moved / one.step))
    columns = np.stack(added, axis=2)
    weighted = columns * inverse_variances(problem)[:, :, None]
    by_shared, by_local = np.zeros((problem.size, len(candidates))), []
    for segment, (a, b) in enumerate(pairwise(problem.data.offsets)):
        own = problem.columns_of(int(problem.data.session[segment]))
        cross = np.einsum("tyk,tyc->kc", slopes[a:b], weighted[a:b])
        by_shared[own] += cross[: len(own)]
        by_local.append(cross[len(own) :])
    return _widened(
        problem.normal(point, local), np.einsum("tyc,ty->c", columns, problem.weighted_residuals(simulated)), by_shared,
        np.einsum("tyk,tyc->kc", columns, weighted), np.array(by_local),
    )  # fmt: skip


def _innovation_normal(noise: ProcessNoise, candidates: Sequence[Candidate]) -> NormalEquations:
    """The same of prediction error, with what variances say (Astrom 1980, eq. (3.11))."""
    problem, point, count = noise.problem, noise.optimum.solution.point, len(candidates)
    nothing_local = np.zeros((0, 0))  # the filter eliminates initial states
    normal = problem.normal(point, nothing_local)
    if problem.steps is None:
        problem = replace(problem, steps=problem.difference_steps(point, normal.hessian))
        normal = problem.normal(point, nothing_local)
    here = problem.innovations(point)
    ahead = [replace(problem, runs=one.problem_with(problem.runs, one.step)).innovations(point) for one in candidates]
    steps = np.array([one.step for one in candidates])
    by_mean = np.nan_to_num((np.stack([k.e for k in ahead], axis=2) - here.e[:, :, None]) / steps)
    by_variance = np.nan_to_num((np.stack([k.variance for k in ahead], axis=2) - here.variance[:, :, None]) / steps)
    gradient, by_shared, curvature = np.zeros(count), np.zeros((problem.size, count)), np.zeros((count, count))
    for run, (a, b) in enumerate(pairwise(problem.runs.data.offsets)):
        own = problem.columns_of(int(problem.runs.data.session[run]))
        slopes = problem.slopes_of_run(point, run).with_columns(by_mean[a:b], by_variance[a:b])
        pull, information = slopes.information(slice(None))
        gradient += pull[len(own) :]
        by_shared[own] += information[: len(own), len(own) :]
        curvature += information[len(own) :, len(own) :]
    return _widened(normal, gradient, by_shared, curvature, np.zeros((0, 0, count)))


def _widened(
    normal: NormalEquations, gradient: Array, by_shared: Array, curvature: Array, by_local: Array
) -> NormalEquations:
    """The normal equations with candidates behind the shared unknowns; by_local: (segments, local unknowns, m)."""
    has_local = normal.local_gradient.size > 0
    cross = np.concatenate([normal.cross, np.swapaxes(by_local, 1, 2)], axis=1) if has_local else normal.cross
    hessian = np.block([[normal.hessian, by_shared], [by_shared.T, curvature]])
    return replace(normal, gradient=np.concatenate([normal.gradient, gradient]), hessian=hessian, cross=cross)
