"""Many segments of one model at once, as arrays, in as many steps as its time scale needs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.numerics.kernels.integrate import DELAY, GAIN, OFFSET, replay, replay_tangent
from seatrial.numerics.kernels.kernel import TangentPointer

# How many Runge-Kutta steps a sample takes: as many as the craft's own time scale needs, found by halving the step.

MOST_SUBSTEPS = 64
"""Runge-Kutta steps in a sample at most: a lag of 0.05 s, the least there is, logged once a second; chosen."""

_NO_BETTER = 2.0  # of the least error, up to which more steps were for nothing: half of them err by 16 times; chosen
SIMULATION_ERROR = 1e-4
"""Error of a simulation that no plot nor table shows, share of a channel's range in the run; chosen."""


def sufficient_substeps(
    simulate: Callable[[int], Array], excess: Callable[[Array, Array], float], first: int = 1
) -> int:
    """Return the least number of steps in a sample, doubled from `first` on, whose halves change nothing that matters.

    Where even `MOST_SUBSTEPS` end outside all bounds, the model itself diverges, and the first number remains. Where
    they change as much as before, the motion grows from any difference: the least number remains that is nearly as
    good as the best.

    Args:
        simulate: outputs (rows, ny) with so many steps in a sample; NaN after a divergence.
        excess: difference of outputs, all finite, from those of half the step, over what the purpose allows.
    """
    coarse, count, errors = simulate(first), first, dict[int, float]()
    while 2 * count <= MOST_SUBSTEPS:
        fine = simulate(2 * count)
        if np.array_equal(np.isfinite(coarse), np.isfinite(fine)):
            within = np.isfinite(fine).all(axis=1)
            errors[count] = excess(coarse[within], fine[within])
            if errors[count] <= 1.0:
                return count if within.all() else first
        count, coarse = 2 * count, fine
    if not np.isfinite(coarse).all():
        return first
    return min((n for n, error in errors.items() if error <= _NO_BETTER * min(errors.values())), default=count)


def error_over_range(coarse: Array, fine: Array) -> float:
    """Return by how much outputs (rows, ny) differ over `SIMULATION_ERROR` of each one's range."""
    if not len(fine):
        return 0.0
    error, allowed = np.max(np.abs(fine - coarse), axis=0), SIMULATION_ERROR * np.ptp(fine, axis=0)
    return float(np.max(np.divide(error, allowed, out=np.where(error > 0.0, np.inf, 0.0), where=allowed > 0.0)))


# Many segments of one model at once, as arrays: outputs, and outputs with sensitivities.

# one pointer for each compiled function: numba needs more time to look one up than a short segment takes
_tangent_pointer = cache(TangentPointer)
INPUT_KINDS = {"zero": OFFSET, "gain": GAIN, "delay": DELAY}


@dataclass(frozen=True)
class InputCorrection:
    """A correction of one input that can be estimated: its `zero` (added), `gain` or `delay` [s]."""

    input: str
    kind: str

    @property
    def name(self) -> str:
        """What reports call it."""
        return f"{self.input} {self.kind}"


@dataclass(frozen=True, eq=False)
class RunInputs:
    """Inputs of whole runs, so that a delayed one is known beyond the ends of a segment.

    Attributes:
        values: of the runs one after another, (rows, nu), in the model's own signs.
        place: of each segment, its first row there, and the rows of its run, first and behind the last, (segments, 3).
    """

    values: Array
    place: Index

    def selected(self, segments: Index) -> "RunInputs":
        """Return the inputs with the place of these segments only."""
        return RunInputs(self.values, np.ascontiguousarray(self.place[segments]))


@dataclass(frozen=True, eq=False)
class SegmentBatch:
    """Segments laid end to end: rows offsets[s]..offsets[s+1] of `inputs` belong to segment s.

    Inputs that the model's records hold are constant over a sample, the others straight. A delayed one is clamped to
    its run where `run_inputs` are known, else to its segment.

    Attributes:
        inputs: shape (rows, nu), in the model's own signs.
        offsets: shape (segments + 1,).
        dt: s; substeps: Runge-Kutta steps in each.
        outputs: observables that are returned, in order.
        parameters, corrections, initial_states: names to differentiate by, in this order.
    """

    model: Model
    inputs: Array
    offsets: Index
    dt: float
    outputs: tuple[str, ...]
    parameters: tuple[str, ...] = ()
    corrections: tuple[InputCorrection, ...] = ()
    initial_states: tuple[str, ...] = ()
    substeps: int = 1
    run_inputs: RunInputs | None = None

    @property
    def segment_count(self) -> int:
        """Number of segments."""
        return len(self.offsets) - 1

    @property
    def column_count(self) -> int:
        """Number of sensitivity columns."""
        return len(self.parameters) + len(self.corrections) + len(self.initial_states)

    @cached_property
    def _output_columns(self) -> Index:
        return np.array([self.model.observables.index(o) for o in self.outputs], dtype=np.int64)

    @cached_property
    def _links(self) -> tuple[Index, Index, Index, Index, Index, Index]:
        compiled = self.model.compiled
        return (*self._link_tables(compiled.rates_pattern), *self._link_tables(compiled.outputs_pattern))

    def _link_tables(self, pattern: Index) -> tuple[Index, Index, Index]:
        """Structural nonzeros as (row, state), (row, jac column, column), (row, jac column, weight slot, column)."""
        nx, nu = len(self.model.states), len(self.model.inputs)
        column = {nx + nu + self.model.parameters.index(n): c for c, n in enumerate(self.parameters)}
        chain = [(i, k) for i, k in pattern if k < nx]
        link_p = [(i, k, column[k]) for i, k in pattern if k in column]
        link_u = [
            (i, nx + j, 3 * j + INPUT_KINDS[c.kind], len(self.parameters) + m)
            for m, c in enumerate(self.corrections)
            for j in [self.model.input_names.index(c.input)]
            for i, k in pattern
            if k == nx + j
        ]
        return _table(chain, 2), _table(link_p, 3), _table(link_u, 4)

    def _correction_values(self, corrections: Array) -> tuple[Array, Array, Array]:
        """Return gain, offset, delay, each (segments, nu), from correction values (segments, n)."""
        shape = (self.segment_count, len(self.model.inputs))
        made = {"gain": np.ones(shape), "zero": np.zeros(shape), "delay": np.zeros(shape)}
        for m, c in enumerate(self.corrections):
            made[c.kind][:, self.model.input_names.index(c.input)] = corrections[:, m]
        return made["gain"], made["zero"], made["delay"]

    @cached_property
    def _rise(self) -> Array:
        """1 for inputs that run straight from sample to sample, 0 for those that are held, (nu,)."""
        return np.array([0.0 if i.is_held else 1.0 for i in self.model.inputs])

    @cached_property
    def _run_inputs(self) -> RunInputs:
        if self.run_inputs is not None:
            return self.run_inputs
        firsts, behind = self.offsets[:-1], self.offsets[1:]
        return RunInputs(self.inputs, np.ascontiguousarray(np.column_stack([firsts, firsts, behind]), dtype=np.int64))

    def simulate(
        self, first: int, last: int, start: Array, parameters: Array, corrections: Array
    ) -> tuple[Array, Index]:
        """Return outputs of segments first..last: shapes (rows, ny), and the sample of failure or -1, (segments,).

        start (segments, nx), parameters (segments, np) all of the model's, corrections (segments, n): for all segments.
        """
        offsets, failed, y = self._segment_rows(first, last)
        inputs, place = self._run_inputs.values, self._run_inputs.place[first:last]
        gain, zero, delay = (a[first:last] for a in self._correction_values(corrections))
        compiled = self.model.compiled
        replay(compiled.rates, compiled.outputs, inputs, place, self._rise, offsets, 0, last - first, self.dt,
               self.substeps, np.ascontiguousarray(start[first:last]), np.ascontiguousarray(parameters[first:last]),
               gain, zero, delay, self._output_columns, len(self.model.outputs), y, failed)  # fmt: skip
        return y, failed

    def differentiate(
        self, first: int, last: int, start: Array, parameters: Array, corrections: Array
    ) -> tuple[Array, Array, Index]:
        """Return what `simulate` does, with d(output)/d(column), shape (rows, ny, width)."""
        offsets, failed, y = self._segment_rows(first, last)
        inputs, place = self._run_inputs.values, self._run_inputs.place[first:last]
        gain, zero, delay = (a[first:last] for a in self._correction_values(corrections))
        column = np.full(len(self.model.states), -1, dtype=np.int64)
        for m, state in enumerate(self.initial_states):
            column[self.model.states.index(state)] = len(self.parameters) + len(self.corrections) + m
        s = np.empty((len(y), len(self.outputs), self.column_count))
        compiled = self.model.compiled
        rates, seen = _tangent_pointer(compiled.rates_tangent), _tangent_pointer(compiled.outputs_tangent)
        replay_tangent(rates, seen, inputs, place, self._rise, offsets, 0, last - first, self.dt, self.substeps,
                       np.ascontiguousarray(start[first:last]), np.ascontiguousarray(parameters[first:last]),
                       gain, zero, delay, *self._links, column, self._output_columns, len(self.model.outputs),
                       y, s, failed)  # fmt: skip
        return y, s, failed

    def _segment_rows(self, first: int, last: int) -> tuple[Index, Index, Array]:
        rows = slice(self.offsets[first], self.offsets[last])
        offsets = np.ascontiguousarray(self.offsets[first : last + 1] - self.offsets[first])
        y = np.empty((rows.stop - rows.start, len(self.outputs)))
        return offsets, np.full(last - first, -1, dtype=np.int64), y

    def influential_states(self) -> tuple[str, ...]:
        """Return states whose initial value reaches any of the outputs."""
        nx = len(self.model.states)
        compiled = self.model.compiled
        reached = {int(i) for i in self._output_columns if i < nx}
        for i in self._output_columns:
            reached |= {int(k) for row, k in compiled.outputs_pattern if row == i - nx and k < nx}
        while True:
            more = {int(k) for i, k in compiled.rates_pattern if i in reached and k < nx} - reached
            if not more:
                return tuple(s for i, s in enumerate(self.model.states) if i in reached)
            reached |= more

    def offset_states(self) -> tuple[str, ...]:
        """Return states that nothing else depends on: their initial value is added to them, and shows nowhere else."""
        nx = len(self.model.states)
        compiled = self.model.compiled
        selected = {int(i) - nx for i in self._output_columns if i >= nx}
        used = {int(k) for _, k in compiled.rates_pattern}
        used |= {int(k) for row, k in compiled.outputs_pattern if row in selected}
        return tuple(s for i, s in enumerate(self.model.states) if i not in used)


def _table(rows: Sequence[Sequence[int]], width: int) -> Index:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


def batch_class(model: Model) -> type[SegmentBatch]:
    """Return the engine that suits the model: exact propagators where it is affine."""
    if not model.is_affine:
        return SegmentBatch
    from seatrial.physics.simulate.linear import LinearBatch

    return LinearBatch
