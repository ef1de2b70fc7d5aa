"""How the filter gets from sample to sample: by the batch's own discrete step, with its derivatives."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.numerics.kernels.kernel import TangentPointer
from seatrial.numerics.kernels.recursive import filter_linear, filter_runge_kutta
from seatrial.numerics.kernels.sensitivity import step_scratch, step_tables
from seatrial.numerics.kernels.spline import spline_slopes
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.physics.simulate.linear import SUBSTEPS, DiscreteMatrices, discrete_matrices

LOOK_AHEAD = 6
"""Samples that a smooth input is known ahead of its step: a spline's end is felt by 4e-4 of itself there."""

_MAX_MOVE_ERRORS = 0.2  # standard errors; see `ExactStepper`; chosen
_MAX_MOVE_SHARE = 0.01  # share of the coefficient; see `ExactStepper`; chosen

# of `follow_linear`: de, dg, dc, dd, plant, seen, at
_Linearisation = tuple[Array, Array, Array, Array, Array, Array, Array]


@dataclass(frozen=True, eq=False)
class FilterState:
    """What is carried along, changed in place: z (n,) = [coefficients | state], root (n, n) of its covariance.

    Attributes:
        variance: of each channel, (ny,).
        running_means, counts: (ny, 2) and (2, ny), see `kernels.square_root.take`.
        huber_limit, averaging_samples: in standard deviations, in samples.
        widest_precision, retained_share, forgetting_interval, since_forgetting: see `forget`.
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


class Stepper(Protocol):
    """One way from sample to sample."""

    @property
    def look_ahead(self) -> int:
        """Samples that must be known beyond the one that is taken in."""
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

    def run(self, filter_state: FilterState, inputs: Array, measured: Array, first: int, is_run_start: int) -> int:
        """As `Stepping.run`."""
        return filter_runge_kutta(
            *self._rates_and_step, *self._model_arguments, filter_state.z, filter_state.root, inputs, measured,
            first, is_run_start, filter_state.variance, filter_state.huber_limit, filter_state.averaging_samples,
            filter_state.running_means, filter_state.counts, filter_state.widest_precision,
            filter_state.retained_share, filter_state.forgetting_interval, filter_state.since_forgetting,
            *self._scratch_arrays,
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
        self._rows_since_check = 0

    @property
    def look_ahead(self) -> int:
        """As `Stepping.ahead`: none where every input is held."""
        return LOOK_AHEAD if np.any(self._smooth) else 0

    def run(self, filter_state: FilterState, inputs: Array, measured: Array, first: int, is_run_start: int) -> int:
        """As `Stepping.run`."""
        slopes, row = spline_slopes(inputs), first
        while row < len(measured):
            made = self._linearise(filter_state)
            until = min(row + self.CHECK_ROWS - self._rows_since_check, len(measured))
            failed = filter_linear(
                *made, filter_state.z, filter_state.root, inputs, measured[:until], row, is_run_start, slopes,
                filter_state.variance, filter_state.huber_limit, filter_state.averaging_samples,
                filter_state.running_means, filter_state.counts, filter_state.widest_precision,
                filter_state.retained_share, filter_state.forgetting_interval, filter_state.since_forgetting,
                *self._scratch_arrays,
            )  # fmt: skip
            if failed >= 0:
                return failed
            is_run_start, self._rows_since_check, row = (
                0,
                (self._rows_since_check + until - row) % self.CHECK_ROWS,
                until,
            )
        return -1

    def _linearise(self, filter_state: FilterState) -> _Linearisation:
        if self._linearisation is not None and self._rows_since_check:
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
