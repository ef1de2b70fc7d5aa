"""Prediction error: the likelihood of Kalman innovations, with the intensities of process and measurement noise.

Astrom 1980, Automatica 16, 551, eq. (3.2); Ljung 1999, section 7.4; Schweppe 1965: minus the logarithm of the
likelihood is 1/2 sum [e^2 / S + log S], up to a constant. Output error is its limit without process noise.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations.augment import DAMPINGS, is_biased
from seatrial.core.values import Array, Index
from seatrial.estimation.problem.output_error import OutputError, SegmentNormals
from seatrial.numerics.optimise import NormalEquations
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.sensors.wave_motion import STILL, WaveMotion
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter

FEWEST_WAVE_PERIODS, LONGEST_WAVE_PERIOD = 3.0, 60.0
"""Periods of the slowest waves in the longest run; the longest of encounter [s]: what is slower is no band; chosen."""

Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class KalmanInnovations:
    """Innovations e (measured - predicted) and their variances, both (rows, ny), SI; NaN where nothing was measured.

    Attributes:
        samples: number of measured samples.
    """

    e: Array
    variance: Array

    @property
    def samples(self) -> int:
        """Number of measured samples."""
        return int(np.isfinite(self.e).sum())

    @property
    def normalised(self) -> Array:
        """Innovations in their standard deviations, (rows, ny): white, of unit variance, where the model is true."""
        with np.errstate(invalid="ignore"):  # of a point whose variances are none, which no search accepts
            return self.e / np.sqrt(self.variance)


@dataclass(frozen=True, eq=False)
class PredictionError:
    """Unknowns: those of `runs`, the squared intensity of each process noise, those of `waves`, variances of channels.

    Squares, because the likelihood is smooth in them where there is none.

    Attributes:
        runs: an output-error problem over whole runs; gives model, data, nuisances, priors, bounds.
        process: states driven by white noise.
        start, start_variance: mean and variance of the initial state of each run, both (runs, nx).
        waves: motion that sensors show on top of the craft's own.
        measurement: known standard deviations of channels, SI, NaN where unknown, (ny,).
        steps: steps of the central differences by which the exact gradient is taken, (size,); None: gain frozen.
        is_one_sided: whether differences are taken to one side, which halves their cost.
    """

    runs: OutputError
    process: tuple[str, ...]
    start: Array
    start_variance: Array
    measurement: Array
    steps: Array | None = field(default=None)
    is_one_sided: bool = False
    waves: WaveMotion = STILL

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.runs.size + self.noise_count

    @property
    def noise_count(self) -> int:
        """Number of intensities, unknowns of waves, and standard deviations."""
        return len(self.process) + self.waves.size + len(self.runs.data.outputs)

    @property
    def lower(self) -> Array:
        """Lower bounds: no process noise, no waves, channels as fine as their values are written.

        Values that were converted show no step; a channel whose bias is a state of its own keeps some noise besides.
        """
        shares = np.where([is_biased(o) for o in self.runs.data.outputs], 1e-2, 1e-4)  # of the runs' residuals; chosen
        least = np.maximum(shares * self.runs.noise, self.runs.data.rounding_noise)
        return self._bounds(self.runs.lower, 0.0, self.wave_bounds[0], least**2)

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        # of the residuals of the runs; chosen
        return self._bounds(self.runs.upper, np.inf, self.wave_bounds[1], (1e4 * self.runs.noise) ** 2)

    @cached_property
    def wave_bounds(self) -> tuple[Array, Array]:
        """Bounds of what describes the waves; frequencies up to that of the samples: an angle's rate may show them."""
        data, peaks, sizes = self.runs.data, self.waves.peaks, self.waves.pair_count
        longest = min(LONGEST_WAVE_PERIOD, data.dt * float(np.max(np.diff(data.offsets))) / FEWEST_WAVE_PERIODS)
        slowest = 2.0 * np.pi / longest
        low, high = (slowest, DAMPINGS[0]), (2.0 * np.pi / data.dt, DAMPINGS[1])
        return (
            np.concatenate([np.tile(low, peaks), np.zeros(sizes)]),
            np.concatenate([np.tile(high, peaks), np.full(sizes, np.inf)]),
        )

    def _bounds(self, run_bounds: Array, process_bound: float, wave_bounds: Array, variance_bounds: Array) -> Array:
        known = np.where(np.isfinite(self.measurement), self.measurement**2, variance_bounds)
        return np.concatenate([run_bounds, np.full(len(self.process), process_bound), wave_bounds, known])

    def split(self, shared: Array) -> tuple[Array, Array, Array]:
        """Unknowns of the runs, intensities of `process`, standard deviations of the channels, the latter two SI."""
        first, second = self.runs.size, self.runs.size + len(self.process)
        return shared[:first], np.sqrt(shared[first:second]), np.sqrt(shared[second + self.waves.size :])

    def wave_unknowns(self, shared: Array) -> Array:
        """Return what describes the waves, (k,)."""
        first = self.runs.size + len(self.process)
        return shared[first : first + self.waves.size]

    def columns_of(self, session: int) -> Index:
        """Return positions among the unknowns of what a session's runs depend on."""
        return np.concatenate([self.runs.columns_of(session), np.arange(self.runs.size, self.size)])

    @cached_property
    def _filter(self) -> KalmanFilter:
        runs = self.runs
        names = (*runs.free, *(name for name, _ in runs.session_parameters))
        return KalmanFilter(
            runs.model, runs.data.inputs, runs.data.offsets, runs.data.dt, runs.observables, names,
            tuple(n.correction for n in runs.nuisances), (), runs.substeps, driven=self.process, waves=self.waves,
        )  # fmt: skip

    def filter_point(self, shared: Array) -> FilterPoint:
        """Return a point as the filter sees it."""
        own, intensity, deviation = self.split(shared)
        _, values, corrections = self.runs.unpack(own, np.zeros((self.runs.data.count, len(self.runs.starts))))
        return FilterPoint(
            self.start, self.start_variance, values, corrections, intensity, deviation, self.wave_unknowns(shared)
        )

    def transitions(self, run: int, shared: Array, local: Array) -> tuple[Array, Array]:
        """Transition matrices of a run from sample to sample, (rows - 1, nx, nx), outputs by states (rows, ny, nx).

        Along the motion without noise from initial states `local`; shared: the unknowns of `runs`.
        """
        start, values, corrections = self.runs.unpack(shared, local)
        return self._filter.transitions(run, start, values, corrections)

    def innovations(self, shared: Array) -> KalmanInnovations:
        """Return the innovations of all runs, one after the other; infinite for a run that diverges."""
        at, measured = self.filter_point(shared), self.runs.data.measured

        def one(segment: int) -> tuple[Array, Array]:
            e, v, failed = self._filter.innovations(segment, measured, at)
            return (np.full_like(e, np.inf), np.ones_like(v)) if failed else (e, v)

        parts = self._map(one, range(self.runs.data.count))
        e, v = (np.concatenate([p[i] for p in parts]) for i in range(2))
        missing = np.isnan(self.runs.data.measured)
        return KalmanInnovations(np.where(missing, np.nan, e), np.where(missing, np.nan, v))

    def _map(self, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
        return map_in_threads(function, items, workers=self.runs.workers)

    def predicted_ahead(self, shared: Array, segment: int, origins: Index, steps: int) -> Array:
        """Return the outputs of a run up to `steps` samples ahead of each origin, (origins, steps + 1, ny).

        See `KalmanFilter.predict_ahead`.
        """
        return self._filter.predict_ahead(segment, self.runs.data.measured, self.filter_point(shared), origins, steps)

    def _loss(self, shared: Array, segment: int) -> tuple[float, Array, Array]:
        """Return the minus the log-likelihood of a run, with its innovations and variances."""
        e, v, failed = self._filter.innovations(segment, self.runs.data.measured, self.filter_point(shared))
        return _negative_log_likelihood(e, v) if not failed else np.inf, e, v

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Return the minus the log-likelihood, and half the priors' squares; infinite if any run diverges."""
        costs = self._map(lambda s: self._loss(shared, s)[0], range(self.runs.data.count))
        return float(sum(costs)) + self._prior_normal(shared).cost

    def _prior_normal(self, shared: Array) -> NormalEquations:
        """Return priors and data besides the records."""
        n = len(self.runs.free) + self.runs.unknowns_per_session
        nothing = SegmentNormals(np.zeros(0), np.zeros((0, n)), np.zeros((0, n, n)), n)
        return self.runs.assemble(nothing, shared[: self.runs.size], np.zeros(0, dtype=np.int64), with_prior=True)

    def segment_normals(self, shared: Array) -> SegmentNormals:
        """Return cost, gradient and information of every run, by the columns of its session; priors left out.

        Information is the expected one, sum [de de' / S + dS dS' / (2 S^2)] (Astrom 1980, eq. (3.11)).
        """
        runs = range(self.runs.data.count)
        parts = self._frozen_gain_normals(shared, runs) if self.steps is None else self._exact_normals(shared, runs)
        costs, gradients, hessians = (np.array([p[i] for p in parts]) for i in range(3))
        return SegmentNormals(costs, gradients, hessians, gradients.shape[1])

    def _frozen_gain_normals(self, shared: Array, runs: Sequence[int]) -> list[tuple[float, Array, Array]]:
        width, at = (len(self.runs.free) + self.runs.unknowns_per_session + self.noise_count, self.filter_point(shared))

        def one(segment: int) -> tuple[float, Array, Array]:
            e, v, de, dv, failed = self._filter.sensitivities(segment, self.runs.data.measured, at)
            if failed:
                return np.inf, np.zeros(width), np.eye(width)
            gradient, hessian = _mean_information(e, v, de)
            noise = slice(width - self.noise_count, width)
            by_variance, information = _variance_information(e, v, dv)
            gradient[noise] += by_variance
            hessian[noise, noise] += information
            return _negative_log_likelihood(e, v), gradient, hessian

        return self._map(one, runs)

    def _exact_normals(self, shared: Array, runs: Sequence[int]) -> list[tuple[float, Array, Array]]:
        """Return the same from differences of the innovations themselves, whatever they depend on."""
        ahead, behind = self._difference_points(shared)
        return [self._exact_normal(shared, segment, ahead, behind) for segment in runs]

    def _exact_normal(self, shared: Array, segment: int, ahead: Array, behind: Array) -> tuple[float, Array, Array]:
        slopes = self._slopes_of_run(shared, segment, ahead, behind)
        return (slopes.cost, *slopes.information(slice(None)))

    def part_normals(self, shared: Array, part: Index, count: int) -> list[tuple[Array, Array]]:
        """Return gradient and information of each part of the samples, priors left out; `part`: of each row, (rows,).

        From differences of the innovations: `steps` must be given.
        """
        gradients, hessians = np.zeros((count, self.size)), np.zeros((count, self.size, self.size))
        ahead, behind = self._difference_points(shared)
        for segment, (a, b) in enumerate(pairwise(self.runs.data.offsets)):
            columns = self.columns_of(int(self.runs.data.session[segment]))
            slopes = self._slopes_of_run(shared, segment, ahead, behind)
            for k in range(count):
                gradient, hessian = slopes.information(part[a:b] == k)
                gradients[k, columns] += gradient
                hessians[k][np.ix_(columns, columns)] += hessian
        return list(zip(gradients, hessians, strict=True))

    def slopes_of_run(self, shared: Array, segment: int) -> "InnovationSlopes":
        """Return innovations of a run and their derivatives by differences: `steps` must be given."""
        return self._slopes_of_run(shared, segment, *self._difference_points(shared))

    def _slopes_of_run(self, shared: Array, segment: int, ahead: Array, behind: Array) -> "InnovationSlopes":
        columns = self.columns_of(int(self.runs.data.session[segment]))
        cost, e, v = self._loss(shared, segment)

        def moved(item: tuple[int, Array]) -> tuple[Array, Array]:
            column, side = item
            if side[column] == shared[column]:
                return e, v
            point = shared.copy()
            point[column] = side[column]
            return self._loss(point, segment)[1:]

        de, dv = np.zeros((*e.shape, len(columns))), np.zeros((*e.shape, len(columns)))
        sides = iter(self._map(moved, [(int(c), side) for c in columns for side in (ahead, behind)]))
        for c, column in enumerate(columns):
            (e_1, v_1), (e_0, v_0), way = (next(sides), next(sides), ahead[column] - behind[column])
            if way > 0 and np.isfinite(cost):
                de[:, :, c], dv[:, :, c] = (e_1 - e_0) / way, (v_1 - v_0) / way
        return InnovationSlopes(cost, e, v, de, dv)

    def _difference_points(self, shared: Array) -> tuple[Array, Array]:
        """Return every unknown a step ahead and a step behind, within its bounds."""
        assert self.steps is not None
        ahead, behind = (np.minimum(shared + self.steps, self.upper), np.maximum(shared - self.steps, self.lower))
        return (ahead, np.where(ahead > shared, shared, behind)) if self.is_one_sided else (ahead, behind)

    def normal(self, shared: Array, local: Array) -> NormalEquations:  # noqa: ARG002
        """Return the Gauss-Newton model at a point: gradient and expected information."""
        return self.assemble(self.segment_normals(shared), shared, np.arange(self.runs.data.count), with_prior=True)

    def assemble(self, blocks: SegmentNormals, shared: Array, segments: Index, *, with_prior: bool) -> NormalEquations:
        """Return the normal equations of some runs; with_prior: with what is known besides the records."""
        gradient, hessian = np.zeros(self.size), np.zeros((self.size, self.size))
        for segment in segments:
            columns = self.columns_of(int(self.runs.data.session[segment]))
            gradient[columns] += blocks.gradients[segment]
            hessian[np.ix_(columns, columns)] += blocks.hessians[segment]
        cost = float(blocks.costs[segments].sum())
        if with_prior:
            known, k = self._prior_normal(shared), self.runs.size
            cost += known.cost
            gradient[:k] += known.gradient
            hessian[:k, :k] += known.hessian
        return NormalEquations(
            cost, gradient, hessian, np.zeros((0, 0)), np.zeros((0, 0, 0)), np.zeros((0, self.size, 0))
        )

    # of a standard deviation, as said below; chosen
    def difference_steps(self, shared: Array, hessian: Array, share: float = 0.02) -> Array:
        """Return steps for an exact gradient, (size,): a share of what each unknown may move with the others held.

        Of variances and of what is positive by its bounds no more than a tenth of themselves, unless they are zero.
        """
        # above zero, for a division
        steps = share / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
        is_positive = (np.arange(self.size) >= self.runs.size) | (self.lower > 0.0)
        return np.where(is_positive & (shared > 0.0), np.minimum(steps, 0.1 * shared), steps)  # a tenth, as said above


@dataclass(frozen=True, eq=False)
class InnovationSlopes:
    """Innovations and variances of a run, (rows, ny), and their derivatives by a session's columns, (rows, ny, k)."""

    cost: float
    e: Array
    v: Array
    de: Array
    dv: Array

    def with_columns(self, de: Array, dv: Array) -> "InnovationSlopes":
        """Return these with derivatives by further unknowns behind their own, (rows, ny, k) each."""
        return replace(self, de=np.concatenate([self.de, de], axis=2), dv=np.concatenate([self.dv, dv], axis=2))

    def information(self, rows: slice | NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return gradient and expected information of some rows; of a run that diverges none, and the identity."""
        if not np.isfinite(self.cost):
            return np.zeros(self.de.shape[2]), np.eye(self.de.shape[2])
        e, v = self.e[rows], self.v[rows]
        mean, spread = _mean_information(e, v, self.de[rows]), _variance_information(e, v, self.dv[rows])
        return mean[0] + spread[0], mean[1] + spread[1]


def _negative_log_likelihood(e: Array, v: Array) -> float:
    """Return 1/2 sum [e^2 / v + log v]; infinite if a variance is not positive."""
    if not (np.all(np.isfinite(e)) and np.all(v > 0)):
        return np.inf
    return 0.5 * float(np.sum(e**2 / v + np.log(v)))


def _mean_information(e: Array, v: Array, de: Array) -> tuple[Array, Array]:
    """Return sum e de / v and sum de de' / v: gradient and information by the mean."""
    with np.errstate(invalid="ignore", over="ignore"):  # the cost is infinite there, or a step away
        root = np.sqrt(v)
        jacobian = (de / root[:, :, None]).reshape(-1, de.shape[2])
        return jacobian.T @ (e / root).ravel(), jacobian.T @ jacobian


def _variance_information(e: Array, v: Array, dv: Array) -> tuple[Array, Array]:
    """Return 1/2 sum (1 - e^2 / v) dv / v and 1/2 sum dv dv' / v^2: gradient and information by the variance."""
    relative = (dv / v[:, :, None]).reshape(-1, dv.shape[2])
    return 0.5 * relative.T @ (1.0 - e**2 / v).ravel(), 0.5 * relative.T @ relative


def over_runs(problem: PredictionError, output_error: OutputError) -> PredictionError:
    """Return the problem over the runs of another one: measured initial states, the others as in the mean so far.

    output_error: over the same outputs, its model without the states of a disturbance.
    """
    old, data = problem.runs, output_error.data
    measured = output_error.measured_initial_states()
    start = np.tile(problem.start.mean(axis=0), (data.count, 1))
    for m, state in enumerate(output_error.starts):
        if state in data.outputs:
            start[:, old.model.states.index(state)] = measured[:, m]
    variance = np.tile(problem.start_variance.max(axis=0), (data.count, 1))
    runs = replace(old, data=replace(data, outputs=old.data.outputs))
    return replace(problem, runs=runs, start=start, start_variance=variance, steps=None)


def join_segments(problem: OutputError) -> tuple[OutputError, Index]:
    """Return the problem with the segments of each run joined again, and the first segment of each of its runs."""
    data = problem.data
    rows, firsts, kept = [], [], []
    for run in range(len(data.runs)):
        mine = data.run_segments(run)
        if not len(mine):
            continue
        first = int(mine[0])
        firsts.append(first)
        pieces = [np.arange(a, b) for a, b in pairwise(data.offsets)]
        kept.append(np.concatenate([pieces[first], *(pieces[s][1:] for s in mine[1:])]))
        rows.append(len(kept[-1]))
    order, start = np.concatenate(kept), np.array(firsts)
    whole = replace(
        data, inputs=np.ascontiguousarray(data.inputs[order]), measured=np.ascontiguousarray(data.measured[order]),
        offsets=np.concatenate([[0], np.cumsum(rows)]).astype(np.int64), run=data.run[start],
        session=data.session[start], history=None if data.history is None else data.history.selected(start),
        beginnings=None if data.beginnings is None else data.beginnings.selected(start),
        run_inputs=None if data.run_inputs is None else data.run_inputs.selected(start),
    )  # fmt: skip
    return replace(problem, data=whole, inflation=None), start
