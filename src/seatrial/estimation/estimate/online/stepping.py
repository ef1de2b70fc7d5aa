"""How the filter gets from sample to sample: by the batch's own discrete step, with its derivatives."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.numerics.kernels.pointer import TangentPointer
from seatrial.numerics.kernels.recursive import follow, follow_linear
from seatrial.numerics.kernels.spline import spline_slopes
from seatrial.physics.simulate.batch import Batch
from seatrial.physics.simulate.linear import SUBSTEPS, Matrices, matrices

LOOK_AHEAD = 6
"""Samples that a smooth input is known ahead of its step: a spline's end is felt by 4e-4 of itself there."""

_MOVED = 0.2
_MOVED_SHARE = 0.01

# of `follow_linear`: de, dg, dc, dd, plant, seen, at
_Made = tuple[Array, Array, Array, Array, Array, Array, Array]


@dataclass(frozen=True, eq=False)
class Held:
    """What is carried along, changed in place: z (n,) = [coefficients | state], root (n, n) of its covariance.

    Attributes:
        variance: of each channel, (ny,); running (ny, 2), tally (2, ny): see `kernels.square_root.take`.
        limit, memory: in standard deviations, in samples; widest, kept, every, since: see `forget`.
    """

    z: Array
    root: Array
    variance: Array
    limit: float
    memory: float
    running: Array
    tally: Index
    widest: Array
    kept: float
    every: int
    since: Index


class Stepping(Protocol):
    """One way from sample to sample."""

    @property
    def ahead(self) -> int:
        """Samples that must be known beyond the one that is taken in."""
        ...

    def run(self, held: Held, inputs: Array, measured: Array, first: int, begins: int) -> int:
        """Take in rows first.. of measured (rows, ny), inputs (more rows, nu); the row that diverged, or -1."""
        ...


def _scratch(nx: int, k: int, ny: int) -> tuple[Array, Array, Array, Array, Array, Array]:
    n = k + nx
    return (np.empty(n), np.empty(n), np.empty(ny), np.empty((ny, n)), np.empty((nx, n)), np.empty((nx, n)))


class RungeKutta:
    """Any model; inputs run straight between samples, as in `simulate.batch`."""

    ahead = 0

    def __init__(self, model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int):
        nx, nu, k = len(model.states), len(model.inputs), len(names)
        code, parameters = model.compiled, model.parameters
        batch = Batch(model, np.zeros((2, nu)), np.array([0, 2]), dt, outputs, names, (), model.states, substeps)
        chain, link_p, link_u = batch._linked(code.rates_pattern)
        select = np.array([model.observables.index(o) for o in outputs], dtype=np.int64)
        places = np.array([parameters.index(n) for n in names], dtype=np.int64)
        ng = len(model.outputs) if np.any(select >= nx) else 0
        width = nx + nu + len(parameters)
        self._step = (TangentPointer(code.rates_tangent), TangentPointer(code.outputs_tangent), dt, substeps)
        self._what = (np.array(parameters.values), places, chain, link_p, link_u, select)
        self._work = (
            *_scratch(nx, k, len(outputs)), np.empty((4, nx)), np.empty((4, nx, k + nx)), np.empty((4, nu)),
            np.zeros((2, 3 * nu)), np.zeros((nx, width)), np.zeros((ng, width)), np.empty(ng),
        )  # fmt: skip

    def run(self, held: Held, inputs: Array, measured: Array, first: int, begins: int) -> int:
        """As `Stepping.run`."""
        return follow(
            *self._step, *self._what, held.z, held.root, inputs, measured, first, begins, held.variance,
            held.limit, held.memory, held.running, held.tally, held.widest, held.kept, held.every, held.since,
            *self._work,
        )  # fmt: skip


class Exact:
    """Affine models by exact propagators; smooth inputs along a spline in straight pieces, as in `simulate.linear`.

    The pieces of a sample are multiplied together once. That is done again when a coefficient has moved by a fifth of
    its standard error or by one per cent, which is looked at every `ROWS` samples; until then its move acts to first
    order.
    """

    ROWS = 16

    def __init__(self, model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int):
        nx, k = len(model.states), len(names)
        self._model, self._dt = model, dt
        pieces = max(substeps, SUBSTEPS)
        self._smooth = np.array([not i.is_held for i in model.inputs])
        self._pieces = [_along(m / pieces, self._smooth) for m in range(pieces + 1)]
        self._values = np.array(model.parameters.values)
        self._places = np.array([model.parameters.index(n) for n in names], dtype=np.int64)
        self._select = np.array([model.observables.index(o) for o in outputs], dtype=np.int64)
        self._work = (*_scratch(nx, k, len(outputs)), np.empty(4 * len(model.inputs) + 1), np.empty(nx))
        self._made: _Made | None = None
        self._at = np.full(k, np.nan)
        self._since = 0

    @property
    def ahead(self) -> int:
        """As `Stepping.ahead`: none where every input is held."""
        return LOOK_AHEAD if np.any(self._smooth) else 0

    def run(self, held: Held, inputs: Array, measured: Array, first: int, begins: int) -> int:
        """As `Stepping.run`."""
        slopes, row = spline_slopes(inputs), first
        while row < len(measured):
            made = self._linearised(held)
            until = min(row + self.ROWS - self._since, len(measured))
            failed = follow_linear(
                *made, held.z, held.root, inputs, measured[:until], row, begins, slopes,
                held.variance, held.limit, held.memory, held.running, held.tally, held.widest, held.kept, held.every,
                held.since, *self._work,
            )  # fmt: skip
            if failed >= 0:
                return failed
            begins, self._since, row = 0, (self._since + until - row) % self.ROWS, until
        return -1

    def _linearised(self, held: Held) -> _Made:
        if self._made is not None and self._since:
            return self._made
        k = len(self._at)
        now = held.z[:k]
        error = np.sqrt(np.einsum("ij,ij->i", held.root[:k], held.root[:k]))
        moved = np.abs(now - self._at)
        near = np.all(moved <= _MOVED * error) and np.all(moved <= _MOVED_SHARE * np.abs(self._at) + 1e-300)
        if self._made is not None and near:
            return self._made
        self._at = now.copy()
        self._values[self._places] = now
        step = self._dt / (len(self._pieces) - 1)
        made = matrices(self._model, self._values[None], step, self._select, self._places)
        plant, slope = composed(made, self._pieces)
        nx = len(plant)
        seen = np.ascontiguousarray(np.hstack([made.c[0], made.d[0]]))
        de, dg = (np.ascontiguousarray(s) for s in (slope[:, :nx], slope[:, nx:]))
        self._made = (de, dg, made.slopes[3][0], made.slopes[4][0], plant, seen, self._at)
        return self._made


def composed(made: Matrices, inputs: list[Array]) -> tuple[Array, Array]:
    """The step over one sample from those of its pieces: (nx, nx + 4 nu + 1), and its derivatives, last axis.

    inputs: at the ends of the pieces, as `_along` has them. Columns: state, inputs at both ends, their slopes a sample
    at both ends, 1; cubic Hermite pieces (de Boor 1978, chapter IV) where an input is smooth, else its first value.
    """
    e, g0, g1 = made.e[0], made.g0[0], made.g1[0]
    de, dg0, dg1 = (np.moveaxis(s[0], 2, 0) for s in made.slopes[:3])
    nx, width = len(e), inputs[0].shape[1]
    total, slope = np.eye(nx, nx + width), np.zeros((len(de), nx, nx + width))
    for here, ahead in pairwise(inputs):
        slope = de @ total + e @ slope
        total = e @ total
        total[:, nx:] += g0 @ here + g1 @ ahead
        slope[:, :, nx:] += dg0 @ here + dg1 @ ahead
    return total, np.ascontiguousarray(np.moveaxis(slope, 0, 2))


def _along(s: float, smooth: np.ndarray) -> Array:
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


def stepping(model: Model, names: tuple[str, ...], outputs: tuple[str, ...], dt: float, substeps: int) -> Stepping:
    """The way that suits the model, which is the batch's."""
    return (Exact if model.is_affine else RungeKutta)(model, names, outputs, dt, substeps)
