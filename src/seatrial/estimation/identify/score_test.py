"""What records say of parameters that a fit does not have, and of values that it takes for known."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError, Prior, Record
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.intervals import (
    RUNS_FOR_JACKKNIFE,
    fits_without,
    inverse_variances,
    one_step_jackknife,
)
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.information.covariance import estimate_shifts, inverse
from seatrial.estimation.predict.prediction_intervals import holdout_model
from seatrial.estimation.predict.windows import HoldoutProtocol, split_windows, window_errors
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.manoeuvres.recognition import recognise_manoeuvre

# How estimates move where an assumed value is off: the records' information on both together.


@dataclass(frozen=True, eq=False)
class AssumedInformation:
    """Information of the records with the assumed values free, too, at the estimate.

    Attributes:
        place: parameter, assumed or free -> its position.
        point: values of all these and of what else the runs share, (n,), SI.
        information: of all of them, (n, n), initial states eliminated.
        moving: positions of what the fit estimates; the first `count` are its free coefficients.
        chi_squared: sum of squares over the noise at the estimate.
    """

    place: Mapping[str, int]
    point: Array
    information: Array
    moving: Index
    count: int
    chi_squared: float

    def shifts(self, change: Array) -> tuple[Array, float]:
        """Return changes of the free coefficients, (count,), SI, and the growth of chi squared; change: (n,), SI."""
        moves, growth = estimate_shifts(self.information, self.moving, change)
        return moves[: self.count], growth

    def unit(self, name: str) -> Array:
        """Return a change by one of an assumed value alone, (n,)."""
        return np.eye(1, len(self.point), self.place[name])[0]


def assumed_information(estimation: Estimation, names: Sequence[str], held: Sequence[str] = ()) -> AssumedInformation:
    """Return the information with fixed parameters of these names free, their priors put aside.

    held: further parameters whose priors are put aside, free or fixed.
    """
    estimate, model = output_error_estimate(estimation), estimation.model
    loose = {n: Prior(0.0, np.inf) for n in {*names, *held}}
    freed = model.parameters.freed(*names, *(n for n in held if n not in names)).with_priors(loose)
    problem: OutputError = replace(estimate.problem, model=model.with_parameters(freed))
    free, size = estimate.problem.free, len(problem.free)
    place = {n: i for i, n in enumerate(problem.free)}
    fitted = [place[n] for n in free]
    point = np.concatenate([problem.start()[:size], estimate.common_parameters[len(free) :]])
    point[fitted] = estimate.common_parameters[: len(free)]
    return AssumedInformation(
        place, point, problem.normal(point, estimate.optimum.local).without_local()[1],
        np.array([*fitted, *range(size, len(point))]), len(free),
        2.0 * problem.cost(point, estimate.optimum.local),
    )  # fmt: skip


def output_error_estimate(estimation: Estimation) -> PointEstimate:
    """Return the estimate with outputs simulated from initial states: under prediction error that over segments."""
    return estimation.shooting if estimation.has_process_noise else estimation.estimate


# What records say of parameters that a fit does not have: terms held, inputs that drift, errors of instruments.


@dataclass(frozen=True, eq=False)
class Candidate:
    """A parameter that the fit does not have, none where it is 0.

    Attributes:
        problem_with: the problem of output error, over segments or whole runs, with the parameter at a size.
        step: size of differences; small where residuals are not linear in the parameter.
        run: number of the one run that it changes; None: it may change all.
    """

    name: str
    problem_with: Callable[[OutputError, float], OutputError]
    step: float = 1.0
    run: int | None = None


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
    changed = [run for run, inputs in enumerate(added) if np.any(inputs)]

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

    return Candidate(name, problem_with, step, changed[0] if len(changed) == 1 else None)


def own_criterion(estimation: Estimation) -> PointEstimate | ProcessNoise:
    """Return the estimate by the criterion that its coefficients come from."""
    noise = estimation.process_noise
    return noise if noise is not None and estimation.has_process_noise else estimation.estimate


def score_test(
    estimate: PointEstimate | ProcessNoise, candidates: Sequence[Candidate], slopes: "OutputSlopes | None" = None
) -> ScoreTest:
    """Return what the records of an estimate say of each candidate.

    slopes: of output error at this point, where they are known; tests with other noise share them.

    Raises:
        ArithmeticError: the simulation leaves what a computer can hold where a candidate is tried.
    """
    problem, point = estimate.problem, estimate.optimum.solution.point
    normal = (
        _innovation_normal(estimate, candidates)
        if isinstance(estimate, ProcessNoise)
        else _output_error_normal(estimate, slopes or OutputSlopes.of_candidates(estimate, candidates))
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


def _tried_together(candidates: Sequence[Candidate]) -> list[list[int]]:
    """Places of candidates that one simulation tries: of different runs, or one that may change all."""
    alone = [[k] for k, candidate in enumerate(candidates) if candidate.run is None]
    together: list[list[int]] = []
    count = Counter[int]()
    for k, candidate in enumerate(candidates):
        if candidate.run is not None:
            if count[candidate.run] == len(together):
                together.append([])
            together[count[candidate.run]].append(k)
            count[candidate.run] += 1
    return [*alone, *together]


def _slopes_by_candidates(
    problem: OutputError, candidates: Sequence[Candidate], moved: Callable[[OutputError], Array]
) -> Array:
    """By how much what is simulated with each candidate moves by a unit of it, (rows, ny, m); 0 where it is not known.

    moved: by how much it moves in a problem with some of them, (rows, ny).
    """
    groups, run = _tried_together(candidates), np.repeat(problem.data.run, np.diff(problem.data.offsets))
    differences = [
        moved(reduce(lambda p, k: candidates[k].problem_with(p, candidates[k].step), group, problem))
        for group in groups
    ]
    slopes = np.zeros((*differences[0].shape, len(candidates)))
    for group, difference in zip(groups, differences, strict=True):
        for k in group:
            own = slice(None) if candidates[k].run is None else run == candidates[k].run
            slopes[own, :, k] = np.nan_to_num(difference[own] / candidates[k].step)
    return slopes


@dataclass(frozen=True, eq=False)
class OutputSlopes:
    """Outputs at the point of an estimate, (rows, ny), and how they move; noise and its colour move none of it.

    Attributes:
        by_unknowns: as `OutputError.slopes`; by_candidates: (rows, ny, m).
    """

    outputs: Array
    by_unknowns: Array
    by_candidates: Array

    @classmethod
    def of_candidates(cls, estimate: PointEstimate, candidates: Sequence[Candidate]) -> "OutputSlopes":
        """Return them at the optimum of an estimate, by candidates at none of them."""
        problem, point, local = estimate.problem, estimate.common_parameters, estimate.optimum.local
        simulated = problem.simulated_outputs(point, local)

        def moved(other: OutputError) -> Array:
            return other.simulated_outputs(point, local) - simulated - (other.data.measured - problem.data.measured)

        by_unknowns = problem.slopes(point, local)
        return cls(simulated, by_unknowns, _slopes_by_candidates(problem, candidates, moved))


def _output_error_normal(estimate: PointEstimate, slopes: OutputSlopes) -> NormalEquations:
    """The normal equations with the candidates behind the shared unknowns."""
    problem, point, local = estimate.problem, estimate.common_parameters, estimate.optimum.local
    columns, count = slopes.by_candidates, slopes.by_candidates.shape[2]
    weighted = columns * inverse_variances(problem)[:, :, None]
    by_shared, by_local = np.zeros((problem.size, count)), []
    for segment, (a, b) in enumerate(pairwise(problem.data.offsets)):
        own = problem.columns_of(int(problem.data.session[segment]))
        cross = np.einsum("tyk,tyc->kc", slopes.by_unknowns[a:b], weighted[a:b])
        by_shared[own] += cross[: len(own)]
        by_local.append(cross[len(own) :])
    gradient = np.einsum("tyc,ty->c", columns, problem.weighted_residuals(slopes.outputs))
    return _widened(
        problem.normal(point, local), gradient, by_shared,
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

    def moved(runs: OutputError) -> Array:
        ahead = replace(problem, runs=runs).innovations(point)
        return np.concatenate([ahead.e - here.e, ahead.variance - here.variance], axis=1)

    by_both = _slopes_by_candidates(problem.runs, candidates, moved)
    by_mean, by_variance = np.split(by_both, 2, axis=1)
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


# Runs predicted in windows by estimates without them: without their session, and without their kind of manoeuvre.


def holdout_scores(estimate: PointEstimate, model: Model, records: Sequence[Record], window_s: float) -> Array:
    """Mean window error of each run by estimates without it, (runs, 2): heading [deg], position [m].

    Left out is each session, or each run where sessions are fewer than a jackknife needs (one step), and each kind of
    manoeuvre where there are several (fitted again); a run's errors are averaged over the two. Runs shorter than a
    window are not judged, unless all are.

    Raises:
        InputError: a window diverges, or a run lacks position or heading in all of its windows.
    """
    data, protocol, scores = estimate.problem.data, HoldoutProtocol(window_s=window_s), []
    template = replace(estimate.problem, model=model)
    of_run = [data.sessions[data.session[data.run_segments(r)[0]]] for r in range(len(records))]
    sessions = groups_of(of_run) if len(set(of_run)) >= RUNS_FOR_JACKKNIFE else [[r] for r in range(len(records))]
    kinds = groups_of([_kind(record) for record in records])
    points = [dict(_by_run(sessions, one_step_jackknife(estimate, sessions)))]
    if len(kinds) > 1:
        points.append(dict(_by_run(kinds, fits_without(estimate, kinds, workers=1))))
    judged = [r for r, record in enumerate(records) if split_windows(record, protocol)] or range(len(records))
    for r in judged:
        errors = []
        for point in (one[r] for one in points):
            by = holdout_model(template, point, of_run[r], records[r])
            errors += window_errors(template, by.model, [records[r]], [by.nuisances], ["run"], protocol)
        if not errors:
            raise InputError(f"run '{records[r].name}' has no window in which both position and heading are measured")
        scores.append((np.mean([e.heading_deg for e in errors]), np.mean([e.position_m for e in errors])))
    return np.array(scores)


def groups_of(names: Sequence[str]) -> list[list[int]]:
    """Return the positions of each name, in the order in which the names occur."""
    return [[i for i, name in enumerate(names) if name == one] for one in dict.fromkeys(names)]


def _by_run(groups: Sequence[Sequence[int]], points: Array) -> Iterator[tuple[int, Array]]:
    """Yield each run of the groups with the estimate without its group."""
    for group, point in zip(groups, points, strict=True):
        yield from ((run, point) for run in group)


def _kind(record: Record) -> str:
    """Manoeuvre that a record shows; one word for all in which none can be recognised."""
    try:
        return str(recognise_manoeuvre(record))
    except InputError:
        return "other"
