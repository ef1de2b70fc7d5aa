"""The recursive filter: the information of a fit carried on, sample by sample, in bounded memory."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol, Self

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError
from seatrial.numerics.kernels.integrate import latest_slopes, spline_slopes, step_scratch, step_tables
from seatrial.numerics.kernels.kernel import TangentPointer
from seatrial.numerics.kernels.recursive import CHANGED, LOOKS, STATE, filter_linear, filter_runge_kutta
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.physics.simulate.linear import SUBSTEPS, DiscreteMatrices, discrete_matrices

# What a recursive filter begins with and what it knows: coefficients, the present state, and how these are tied.


@dataclass(frozen=True, eq=False)
class GaussianState:
    """Gaussian: coefficients theta ~ N(value, covariance), state ~ N(state + sensitivity (theta - value),
    state_covariance).

    Attributes:
        value (k,), covariance (k, k): of the coefficients; state (nx,): at the present sample.
        sensitivity: (nx, k), change of the present state with the coefficients, given all that was measured.
        state_covariance: (nx, nx), covariance of the state were the coefficients known.
    """

    value: Array
    covariance: Array
    state: Array
    sensitivity: Array
    state_covariance: Array

    def __post_init__(self) -> None:
        k, nx = len(self.value), len(self.state)
        shapes = {"covariance": (k, k), "sensitivity": (nx, k), "state_covariance": (nx, nx)}
        for name, shape in {"value": (k,), "state": (nx,), **shapes}.items():
            made = np.shape(getattr(self, name))
            if made != shape or not np.all(np.isfinite(getattr(self, name))):
                raise InputError(f"the filter's first {name} must be {shape} finite numbers, its shape is {made}")

    def joint_root(self) -> Array:
        """R, (k + nx, k + nx), lower block triangular, R R' the covariance of [theta | state].

        Raises:
            InputError: a covariance is not positive (semi-definite).
        """
        k = len(self.value)
        made = np.zeros((k + len(self.state),) * 2)
        made[:k, :k] = covariance_root(self.covariance, "the coefficients' covariance")
        made[k:, :k] = self.sensitivity @ made[:k, :k]
        made[k:, k:] = covariance_root(self.state_covariance, "the state's covariance")
        return made

    def at_run_start(self, state: Array, state_covariance: Array) -> Self:
        """The same coefficients where a run begins: its state knows nothing of them."""
        return replace(
            self, state=state, sensitivity=np.zeros((len(state), len(self.value))), state_covariance=state_covariance
        )


def covariance_root(covariance: Array, name: str) -> Array:
    """A square root of a covariance that may be singular, scaled by its own deviations first.

    Raises:
        InputError: it is not positive semi-definite.
    """
    deviation = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    scale = np.where(deviation > 0.0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    if values[0] < -1e-8 * max(values[-1], 1.0):  # rounding of a covariance; chosen
        raise InputError(f"{name} is not positive; give one that comes from a fit")
    return scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))


# How the filter gets from sample to sample: by the batch's own discrete step, with its derivatives.

LOOK_AHEAD = 6
"""Samples that a smooth input is known ahead of its step: a spline's end is felt by 4e-4 of itself there."""

_HISTORY_SAMPLES = 12  # inputs kept before the sample in work, for the spline; chosen
_MAX_MOVE_ERRORS = 0.2  # standard errors; see `ExactStepper`; chosen
_MAX_MOVE_SHARE = 0.01  # share of the coefficient; see `ExactStepper`; chosen

# of `follow_linear`: de, dg, dc, dd, plant, seen, at
_Linearisation = tuple[Array, Array, Array, Array, Array, Array, Array]


@dataclass(frozen=True)
class JumpSearch:
    """What a filter looks for at a bank of instants, and until when.

    Attributes:
        instants: most of them; with any, no sample waits for later ones, and a smooth input's last slope is of earlier
            ones alone.
        size: standard deviation of a jump before any data, relative to the coefficient.
        threshold: nats of evidence that end the search for one.
        largest_error: relative standard error of every coefficient up to which an instant is kept.
    """

    instants: int = 0
    size: float = 0.0
    threshold: float = np.inf
    largest_error: float = 0.0


NO_JUMP = JumpSearch()
"""No jump is looked for."""


@dataclass(frozen=True, eq=False)
class JumpBank:
    """What the data since each of m instants say of a jump of the k coefficients there, changed in place.

    The state, of nx, goes on from its value there. Sizes are relative to the coefficients of the instant.

    Attributes:
        effects: of a jump on the error of [coefficients | state], (k + nx, k m).
        information: on its size, (k, k, m), lower triangle; score: (k, m), information times the likeliest size.
        innovation_effects, propagated, root, solved: room for `kernels.recursive`.
        latest: innovations of each channel, (ny, 4).
        opened: look at which each instant was kept, (m,); -1: none is in that place.
        estimates: value and standard error of the coefficients there, (2 k, m); bounds: of the coefficients, (2, k).
        limits, progress: see `kernels.recursive`.
    """

    effects: Array
    information: Array
    score: Array
    innovation_effects: Array
    latest: Array
    propagated: Array
    root: Array
    solved: Array
    opened: Index
    estimates: Array
    bounds: Array
    limits: Array
    progress: Index

    @classmethod
    def of_size(cls, search: JumpSearch, states: int, outputs: int, bounds: Array, divergence_ratio: float) -> Self:
        """Return a bank, at no instant of which a jump is looked for yet."""
        m, k = search.instants, bounds.shape[1]
        return cls(
            np.zeros((k + states, k * m)), np.zeros((k, k, m)), np.zeros((k, m)), np.zeros(k * m),
            np.zeros((outputs, 4)), np.zeros((states, k * m)), np.zeros((k, k, m)), np.zeros((k, m)),
            np.full(m, -1, dtype=np.int64), np.zeros((2 * k, m)), bounds,
            np.array([search.size**2, search.threshold, search.largest_error, divergence_ratio]),
            np.zeros(2, dtype=np.int64),
        )  # fmt: skip

    @property
    def arrays(self) -> tuple[Array | Index, ...]:
        """All of them, as the kernels take them."""
        return (
            self.effects, self.information, self.score, self.innovation_effects, self.latest, self.propagated,
            self.root, self.solved, self.opened, self.estimates, self.bounds, self.limits, self.progress,
        )  # fmt: skip

    @property
    def is_searched(self) -> bool:
        """Whether jumps are looked for."""
        return self.opened.size > 0

    @property
    def looks(self) -> int:
        """Number of samples after which the present instant was kept."""
        return int(self.progress[LOOKS])

    @property
    def has_changed(self) -> bool:
        """Whether the evidence for a jump was enough; no sample behind that one has been taken in."""
        return bool(self.progress[STATE] == CHANGED)

    def emptied(self) -> Self:
        """Return a bank of no instant."""
        k = self.bounds.shape[1]
        none = np.zeros((k, 0)), np.zeros((k, k, 0))
        return replace(
            self, effects=np.zeros((len(self.effects), 0)), information=none[1], score=none[0],
            innovation_effects=np.zeros(0), latest=np.zeros_like(self.latest),
            propagated=np.zeros((len(self.propagated), 0)), root=none[1], solved=none[0],
            opened=np.zeros(0, dtype=np.int64), estimates=np.zeros((2 * k, 0)), progress=np.zeros(2, dtype=np.int64),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class FilterState:
    """What is carried along, changed in place: z (n,) = [coefficients | state], root (n, n) of its covariance.

    Attributes:
        variance: of each channel, (ny,).
        running_means, counts: (ny, 2) and (2, ny), see `kernels.square_root.take`.
        huber_limit, averaging_samples: in standard deviations, in samples.
        widest_precision, retained_share, forgetting_interval, since_forgetting: see `forget`.
        jumps: of the coefficients, that are looked for.
    """

    z: Array
    root: Array
    variance: Array
    huber_limit: float
    averaging_samples: float
    running_means: Array
    counts: Index
    widest_precision: Array
    retained_share: float
    forgetting_interval: int
    since_forgetting: Index
    jumps: JumpBank

    def copy(self) -> "FilterState":
        """Return the same, to be carried on by itself, in which no jump is looked for."""
        return FilterState(
            self.z.copy(), self.root.copy(), self.variance, self.huber_limit, self.averaging_samples,
            self.running_means.copy(), self.counts.copy(), self.widest_precision, self.retained_share,
            self.forgetting_interval, self.since_forgetting.copy(), self.jumps.emptied(),
        )  # fmt: skip


class Stepper(Protocol):
    """One way from sample to sample."""

    @property
    def look_ahead(self) -> int:
        """Samples that must be known beyond the one that is taken in."""
        ...

    def as_it_is(self) -> "Stepper":
        """Return the same with its present linearisation, whatever the coefficients become."""
        ...

    def run(self, filter_state: FilterState, inputs: Array, measured: Array, first: int, is_run_start: int) -> int:
        """Take in rows first.. of measured (rows, ny), inputs (more rows, nu); the row that diverged, or -1."""
        ...


def _scratch(nx: int, k: int, ny: int) -> tuple[Array, Array, Array, Array, Array, Array]:
    n = k + nx
    return (np.empty(n), np.empty(n), np.empty(ny), np.empty((ny, n)), np.empty((nx, n)), np.empty((nx, n)))


class RungeKuttaStepper:
    """Any model; inputs run straight between samples, as in `simulate.batch`."""

    look_ahead = 0

    def __init__(self, model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int):
        nx, nu, k = len(model.states), len(model.inputs), len(names)
        code, parameters = model.compiled, model.parameters
        batch = SegmentBatch(model, np.zeros((2, nu)), np.array([0, 2]), dt, outputs, names, (), model.states, substeps)
        chain, link_p, link_u = batch._link_tables(code.rates_pattern)
        select = np.array([model.observables.index(o) for o in outputs], dtype=np.int64)
        places = np.array([parameters.index(n) for n in names], dtype=np.int64)
        ng = len(model.outputs) if np.any(select >= nx) else 0
        width = nx + nu + len(parameters)
        (w, s), jac = step_scratch(nx, k + nx), np.zeros((nx, width))
        self._rates_and_step = (TangentPointer(code.rates_tangent), TangentPointer(code.outputs_tangent), dt, substeps)
        self._model_arguments = (np.array(parameters.values), places, select)
        self._scratch_arrays = (
            *_scratch(nx, k, len(outputs)), *step_tables(chain, link_p, s, width), link_u, w, s, np.empty((4, nx)),
            np.empty((4, nu)), np.zeros((3, 3 * nu)), jac, jac.reshape(-1), np.zeros((ng, width)), np.empty(ng),
        )  # fmt: skip

    def as_it_is(self) -> "RungeKuttaStepper":
        """As `Stepper.as_it_is`: it is linear about each sample."""
        return self

    def run(self, filter_state: FilterState, inputs: Array, measured: Array, first: int, is_run_start: int) -> int:
        """As `Stepping.run`."""
        return filter_runge_kutta(
            *self._rates_and_step, *self._model_arguments, filter_state.z, filter_state.root, inputs, measured,
            first, is_run_start, filter_state.variance, filter_state.huber_limit, filter_state.averaging_samples,
            filter_state.running_means, filter_state.counts, filter_state.widest_precision,
            filter_state.retained_share, filter_state.forgetting_interval, filter_state.since_forgetting,
            *filter_state.jumps.arrays, *self._scratch_arrays,
        )  # fmt: skip


class ExactStepper:
    """Affine models by exact propagators; smooth inputs along a spline in straight pieces, as in `simulate.linear`.

    The pieces of a sample are multiplied together once. That is done again when a coefficient has moved by a fifth of
    its standard error or by one per cent, checked every `CHECK_ROWS` samples; until then its move acts to first
    order.
    """

    CHECK_ROWS = 16  # samples between two checks; chosen

    def __init__(self, model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int):
        nx, k = len(model.states), len(names)
        self._model, self._dt = model, dt
        pieces = max(substeps, SUBSTEPS)
        self._smooth = np.array([not i.is_held for i in model.inputs])
        self._piece_inputs = [_hermite_inputs(m / pieces, self._smooth) for m in range(pieces + 1)]
        self._values = np.array(model.parameters.values)
        self._indices = np.array([model.parameters.index(n) for n in names], dtype=np.int64)
        self._output_indices = np.array([model.observables.index(o) for o in outputs], dtype=np.int64)
        self._scratch_arrays = (*_scratch(nx, k, len(outputs)), np.empty(4 * len(model.inputs) + 1), np.empty(nx))
        self._linearisation: _Linearisation | None = None
        self._linearised_at = np.full(k, np.nan)
        self._rows_since_check, self._is_fixed = 0, False

    @property
    def look_ahead(self) -> int:
        """As `Stepping.ahead`: none where every input is held."""
        return LOOK_AHEAD if np.any(self._smooth) else 0

    def as_it_is(self) -> "ExactStepper":
        """As `Stepper.as_it_is`."""
        same = copy(self)
        same._is_fixed = self._linearisation is not None
        return same

    def run(self, filter_state: FilterState, inputs: Array, measured: Array, first: int, is_run_start: int) -> int:
        """As `Stepping.run`."""
        slopes, row = self._input_slopes(inputs, is_causal=filter_state.jumps.is_searched), first
        while row < len(measured):
            made = self._linearise(filter_state)
            until = min(row + self.CHECK_ROWS - self._rows_since_check, len(measured))
            failed = filter_linear(
                *made, filter_state.z, filter_state.root, inputs, measured[:until], row, is_run_start, slopes,
                filter_state.variance, filter_state.huber_limit, filter_state.averaging_samples,
                filter_state.running_means, filter_state.counts, filter_state.widest_precision,
                filter_state.retained_share, filter_state.forgetting_interval, filter_state.since_forgetting,
                *filter_state.jumps.arrays, *self._scratch_arrays,
            )  # fmt: skip
            if failed >= 0:
                return failed
            is_run_start, self._rows_since_check, row = (
                0,
                (self._rows_since_check + until - row) % self.CHECK_ROWS,
                until,
            )
        return -1

    def _input_slopes(self, inputs: Array, *, is_causal: bool) -> Array:
        """Slopes of the inputs at the row before each and there; is_causal: from rows up to it alone."""
        if is_causal:
            return latest_slopes(inputs, _HISTORY_SAMPLES)
        slopes = spline_slopes(inputs)
        return np.hstack([np.concatenate([slopes[:1], slopes[:-1]]), slopes])

    def _linearise(self, filter_state: FilterState) -> _Linearisation:
        if self._linearisation is not None and (self._is_fixed or self._rows_since_check):
            return self._linearisation
        k = len(self._linearised_at)
        now = filter_state.z[:k]
        error = np.sqrt(np.einsum("ij,ij->i", filter_state.root[:k], filter_state.root[:k]))
        moved = np.abs(now - self._linearised_at)
        near = np.all(moved <= _MAX_MOVE_ERRORS * error) and np.all(
            moved <= _MAX_MOVE_SHARE * np.abs(self._linearised_at) + 1e-300  # above zero, for a division
        )
        if self._linearisation is not None and near:
            return self._linearisation
        self._linearised_at = now.copy()
        self._values[self._indices] = now
        step = self._dt / (len(self._piece_inputs) - 1)
        made = discrete_matrices(self._model, self._values[None], step, self._output_indices, self._indices)
        plant, slope = compose_steps(made, self._piece_inputs)
        nx = len(plant)
        seen = np.ascontiguousarray(np.hstack([made.c[0], made.d[0]]))
        de, dg = (np.ascontiguousarray(s) for s in (slope[:, :nx], slope[:, nx:]))
        self._linearisation = (de, dg, made.derivatives[3][0], made.derivatives[4][0], plant, seen, self._linearised_at)
        return self._linearisation


def compose_steps(propagators: DiscreteMatrices, inputs: list[Array]) -> tuple[Array, Array]:
    """The step over one sample from those of its pieces: (nx, nx + 4 nu + 1), and its derivatives, last axis.

    inputs: at the ends of the pieces, as `_along` has them. Columns: state, inputs at both ends, their slopes a sample
    at both ends, 1; cubic Hermite pieces (de Boor 1978, chapter IV) where an input is smooth, else its first value.
    """
    e, g0, g1 = propagators.e[0], propagators.g0[0], propagators.g1[0]
    de, dg0, dg1 = (np.moveaxis(s[0], 2, 0) for s in propagators.derivatives[:3])
    nx, width = len(e), inputs[0].shape[1]
    total, slope = np.eye(nx, nx + width), np.zeros((len(de), nx, nx + width))
    for here, ahead in pairwise(inputs):
        slope = de @ total + e @ slope
        total = e @ total
        total[:, nx:] += g0 @ here + g1 @ ahead
        slope[:, :, nx:] += dg0 @ here + dg1 @ ahead
    return total, np.ascontiguousarray(np.moveaxis(slope, 0, 2))


def _hermite_inputs(s: float, smooth: np.ndarray) -> Array:
    """Inputs at the share s of a step and the constant 1, (nu + 1, 4 nu + 1), from values and slopes at its ends."""
    nu = len(smooth)
    left, right = (1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)
    rise = s * (1 - s) ** 2, s * s * (s - 1)
    made = np.zeros((nu + 1, 4 * nu + 1))
    for part, weight in enumerate((left, right, *rise)):
        held = 1.0 if part == 0 else 0.0
        made[np.arange(nu), part * nu + np.arange(nu)] = np.where(smooth, weight, held)
    made[nu, 4 * nu] = 1.0
    return made


def stepper_for(model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int) -> Stepper:
    """The way that suits the model, which is the batch's."""
    return (ExactStepper if model.is_affine else RungeKuttaStepper)(model, names, outputs, dt, substeps)


_FORGETTING_STEPS = 200  # forgetting acts so many times in a time constant; chosen


@dataclass(frozen=True)
class Forgetting:
    """Slow change: older samples count exp(-age / time_constant) times.

    Information of what is not excited falls to that of `widest_deviation` and no further (Kulhavy & Zarrop 1993).
    Standard errors are those of the weighted sum of squares, at most sqrt 2 times the spread of an unchanging ship.

    Attributes:
        time_constant: s; infinite: nothing is forgotten.
        widest_deviation: standard deviation of each coefficient where all is forgotten, (k,), in its unit.
    """

    time_constant: float = np.inf
    widest_deviation: tuple[float, ...] = ()


@dataclass(frozen=True)
class DivergenceGuard:
    """Limits beyond which innovations are outliers or the filter has diverged.

    Attributes:
        huber_limit: an innovation of more standard deviations counts linearly (Huber 1964) and as an outlier.
        averaging_seconds: s over which innovations are averaged.
        divergence_ratio: mean squared innovation over its variance, beyond which the filter has diverged.
    """

    huber_limit: float = 6.0
    averaging_seconds: float = 30.0
    divergence_ratio: float = 9.0


@dataclass(frozen=True, eq=False)
class InnovationStatistics:
    """What the measurements were beyond their predictions, by channel, (ny,).

    Attributes:
        rms: over the guard's memory, SI.
        variance_ratio: mean square by its predicted variance, 1 if all is as believed.
        sample_count, outlier_count: counts since the filter began.
    """

    rms: Array
    variance_ratio: Array
    sample_count: Array
    outlier_count: Array


@dataclass(eq=False)
class _SampleBuffer:
    """Samples from a few before the present one to those that still wait for what comes after them."""

    inputs: Array
    measured: Array
    processed: int
    is_run_start: int = 0
    failed: bool = False


class RecursiveFilter:
    """Coefficients and state of a model, sample by sample; no thread, no clock of its own.

    A smooth input needs samples ahead (`LOOK_AHEAD`): so many of the latest wait; `flush` takes them in.
    """

    def __init__(
        self,
        model: Model,
        names: Sequence[str],
        outputs: Sequence[str],
        noise: Array,
        dt: float,
        initial: GaussianState,
        *,
        recent_inputs: Array | None = None,
        substeps: int = 1,
        forgetting: Forgetting | None = None,
        guard: DivergenceGuard | None = None,
        jumps: JumpSearch = NO_JUMP,
    ) -> None:
        """Carry `belief` on.

        Args:
            model: its other parameters are known; names: of the k coefficients, in the belief's order.
            outputs: observables that are measured, ny; noise: their standard deviations, SI, (ny,), times the root of
                the variance inflation where residuals are coloured.
            dt: s between samples.
            recent: the run's latest inputs up to the present sample, (m, nu), m >= 1, in the model's signs, a dozen if
                there are. None: the belief stands before a run's first sample, which comes next.
            jumps: of the coefficients, that are looked for.

        Raises:
            InputError: names the model does not have, or shapes that do not agree.
        """
        self.names, self.outputs, self.dt = tuple(names), tuple(outputs), dt
        for name in self.names:
            _ = model.parameters[name]
        if len(initial.value) != len(self.names) or len(initial.state) != len(model.states):
            raise InputError(
                f"the belief is of {len(initial.value)} coefficients and {len(initial.state)} states; the filter has "
                f"{len(self.names)} and model '{model.name}' {len(model.states)}"
            )
        if np.shape(noise) != (len(self.outputs),) or not np.all(np.asarray(noise) > 0.0):
            raise InputError(f"noise must be positive, one value for each of {', '.join(self.outputs)}")
        self._model, self._guard = model, guard or DivergenceGuard()
        self._stepper = stepper_for(model, self.names, self.outputs, dt, substeps)
        bounds = [model.parameters[n] for n in self.names]
        self._lower, self._upper = np.array([b.lower for b in bounds]), np.array([b.upper for b in bounds])
        self.jumps = JumpBank.of_size(
            jumps, len(model.states), len(self.outputs), np.array([self._lower, self._upper]),
            self._guard.divergence_ratio,
        )  # fmt: skip
        self._look_ahead = 0 if jumps.instants else self._stepper.look_ahead
        self._filter_state = _initial_filter_state(
            initial, np.asarray(noise, dtype=np.float64), dt, self._guard, forgetting or Forgetting(), self.jumps
        )
        self._buffer = self._open_buffer(recent_inputs)

    def _open_buffer(self, recent_inputs: Array | None) -> _SampleBuffer:
        nu, ny = len(self._model.inputs), len(self.outputs)
        if recent_inputs is None:
            return _SampleBuffer(np.empty((0, nu)), np.empty((0, ny)), 0, is_run_start=1)
        inputs = np.ascontiguousarray(recent_inputs[-_HISTORY_SAMPLES:], dtype=np.float64)
        if inputs.ndim != 2 or inputs.shape[1] != nu or not len(inputs):
            raise InputError(f"recent inputs must be at least one row of {nu} columns, their shape is {inputs.shape}")
        return _SampleBuffer(inputs, np.full((len(inputs), ny), np.nan), len(inputs))

    def update(self, measured: Array, inputs: Array) -> None:
        """Take in the next n samples: measured (n, ny), NaN where nothing came; inputs (n, nu) at the same instants.

        Does nothing once the state has left all bounds.

        Raises:
            InputError: shapes that do not agree, or an input that is no number.
        """
        w = self._buffer
        if len(measured) != len(inputs) or measured.shape[1:] != w.measured.shape[1:]:
            raise InputError(f"{np.shape(measured)} measurements do not go with inputs of shape {np.shape(inputs)}")
        if inputs.shape[1:] != w.inputs.shape[1:] or not np.all(np.isfinite(inputs)):
            raise InputError(
                f"inputs must be finite numbers in {w.inputs.shape[1]} columns; fill or leave out the rest"
            )
        w.inputs = np.concatenate([w.inputs, inputs])
        w.measured = np.concatenate([w.measured, measured])
        self._process(len(w.inputs) - self._look_ahead)

    def estimate_with(self, measured: Array, inputs: Array) -> tuple[Array, Array]:
        """Return coefficients (k,) and covariance (k, k) as they would be with the samples that wait and these.

        Nothing is taken in. Arguments as of `update`, no more than will come next; the inputs are finite.
        """
        w, k = self._buffer, len(self.names)
        at, stepper = self._filter_state.copy(), self._stepper.as_it_is()
        if not w.failed:
            all_inputs, all_measured = np.concatenate([w.inputs, inputs]), np.concatenate([w.measured, measured])
            stepper.run(at, all_inputs, all_measured, w.processed, w.is_run_start)
        own = at.root[:k]
        return at.z[:k], own @ own.T

    def flush(self) -> None:
        """Take in what still waits for samples ahead: before the end of a run, or to be up to date."""
        self._process(len(self._buffer.inputs))

    def _process(self, until: int) -> None:
        w, first = self._buffer, self._buffer.processed
        if until <= first or w.failed:
            return
        failed = self._stepper.run(self._filter_state, w.inputs, w.measured[:until], first, w.is_run_start)
        w.failed = failed >= 0
        w.is_run_start, w.processed = 0, until
        drop = max(until - _HISTORY_SAMPLES, 0)
        if drop:
            w.inputs, w.measured, w.processed = w.inputs[drop:], w.measured[drop:], until - drop

    def begin_run(self, state: Array, state_covariance: Array) -> None:
        """A new run, or segment, starts with the next sample: there the state is `state` (nx,), covariance `spread`."""
        self.flush()
        self._filter_state.root[:] = (
            self.gaussian_state().at_run_start(np.asarray(state, dtype=np.float64), state_covariance).joint_root()
        )
        self._filter_state.z[len(self.names) :] = state
        self.jumps.effects[len(self.names) :] = 0.0
        self._buffer = self._open_buffer(None)

    def gaussian_state(self) -> GaussianState:
        """All that is known at the latest sample taken in."""
        k, z = len(self.names), self._filter_state.z
        joint = self.joint_covariance
        own, other = self._filter_state.root[:k], self._filter_state.root[k:]
        # rounding of a singular matrix; chosen
        sensitivity = np.asarray(np.linalg.lstsq(own.T, other.T, rcond=1e-12)[0].T, dtype=np.float64)
        left = other - sensitivity @ own
        return GaussianState(z[:k].copy(), joint[:k, :k], z[k:].copy(), sensitivity, left @ left.T)

    @property
    def value(self) -> Array:
        """Coefficients, (k,)."""
        return self._filter_state.z[: len(self.names)].copy()

    @property
    def covariance(self) -> Array:
        """Of the coefficients, (k, k)."""
        own = self._filter_state.root[: len(self.names)]
        return own @ own.T

    @property
    def joint_covariance(self) -> Array:
        """Of [coefficients | state], (k + nx, k + nx)."""
        return self._filter_state.root @ self._filter_state.root.T

    @property
    def standard_error(self) -> Array:
        """Of the coefficients, (k,)."""
        own = self._filter_state.root[: len(self.names)]
        return np.sqrt(np.einsum("ij,ij->i", own, own))

    @property
    def state(self) -> Array:
        """At the latest sample taken in, (nx,)."""
        return self._filter_state.z[len(self.names) :].copy()

    @property
    def innovations(self) -> InnovationStatistics:
        """Statistics of the innovations so far."""
        h = self._filter_state
        return InnovationStatistics(
            np.sqrt(h.running_means[:, 1]), h.running_means[:, 0].copy(), h.counts[0].copy(), h.counts[1].copy()
        )

    @property
    def is_halted(self) -> bool:
        """Whether nothing more is taken in: the state has left all bounds, or a jump ended the search for one."""
        return self._buffer.failed

    @property
    def is_sound(self) -> bool:
        """Whether the filter may be believed; if not, a window of the latest samples has to be fitted again.

        It is not where a number is not finite, the state left all bounds, a coefficient its own, or the innovations of
        a channel are larger than believed (`Guard.unsound`) while its mean covers half the guard's memory.
        """
        h = self._filter_state
        if (self._buffer.failed and not self.jumps.has_changed) or not (
            np.all(np.isfinite(h.z)) and np.all(np.isfinite(h.root))
        ):
            return False
        value = h.z[: len(self.names)]
        if np.any(value < self._lower) or np.any(value > self._upper):
            return False
        filled = h.counts[0] >= 0.5 * h.averaging_samples
        return not np.any(filled & (h.running_means[:, 0] > self._guard.divergence_ratio))


def _initial_filter_state(
    initial: GaussianState, noise: Array, dt: float, guard: DivergenceGuard, forgetting: Forgetting, jumps: JumpBank
) -> FilterState:
    k, nx, ny = len(initial.value), len(initial.state), len(noise)
    kept, every, widest = 1.0, 1, np.zeros((0, k + nx))
    if np.isfinite(forgetting.time_constant):
        if len(forgetting.widest_deviation) != k or not np.all(np.asarray(forgetting.widest_deviation) > 0.0):
            raise InputError("forgetting needs the widest standard deviation of each coefficient, all positive")
        every = max(1, round(forgetting.time_constant / dt / _FORGETTING_STEPS))
        kept = float(np.exp(-every * dt / forgetting.time_constant))
        widest = np.diag(1.0 / np.asarray(forgetting.widest_deviation, dtype=np.float64))
        widest = np.ascontiguousarray(np.hstack([widest, np.zeros((k, nx))]))
    return FilterState(
        np.concatenate([initial.value, initial.state]),
        initial.joint_root(),
        noise**2,
        guard.huber_limit,
        max(guard.averaging_seconds / dt, 1.0),
        np.zeros((ny, 2)),
        np.zeros((2, ny), dtype=np.int64),
        widest,
        kept,
        every,
        np.zeros(1, dtype=np.int64),
        jumps,
    )
