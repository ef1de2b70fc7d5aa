"""Affine models by exact propagators: segments, frequency response, motion in a sum of harmonics."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError
from seatrial.numerics.kernels.integrate import DELAY, GAIN, spline_points, spline_slopes
from seatrial.numerics.kernels.linear import affine_matrices, propagators, replay, replay_tangent
from seatrial.physics.simulate.batch import INPUT_KINDS, SegmentBatch

# Affine models by exact propagators: what `SegmentBatch` gives, without the error of a Runge-Kutta step.

_SAME_SAMPLE = 1e-9  # samples by which a place is rounded; chosen
_NONE: Index = np.empty(0, dtype=np.int64)
SUBSTEPS = 8  # straight pieces of a spline in one sample; chosen


@dataclass(frozen=True, eq=False)
class DiscreteMatrices:
    """Discrete matrices of some parameter sets, first axis; derivatives have the parameter as last axis.

    The last input is the constant 1. e: (w, nx, nx); g0, g1: (w, nx, nu + 1); c: (w, ny, nx); d: (w, ny, nu + 1).
    """

    e: Array
    g0: Array
    g1: Array
    c: Array
    d: Array
    derivatives: tuple[Array, Array, Array, Array, Array]


def discrete_matrices(
    model: Model, parameters: Array, h: float, select: Index, differentiated: Index
) -> DiscreteMatrices:
    """Exact discrete matrices over a step h [s] for each row of `parameters`, and derivatives by `differentiated`."""
    made = [_matrices_of_one(model, row, h, select, differentiated) for row in parameters]
    e, g0, g1, c, d = (np.array(column) for column in zip(*(values for values, _ in made), strict=True))
    slopes = zip(*(slopes for _, slopes in made), strict=True)
    de, dg0, dg1, dc, dd = (np.array([s.transpose(1, 2, 0) for s in column], order="C") for column in slopes)
    return DiscreteMatrices(e, g0, g1, c, d, (de, dg0, dg1, dc, dd))


@lru_cache
def exact_step(model: Model, h: float) -> tuple[Array, Array, Array]:
    """Return e, g0 and g1 of an affine model over a step h [s] at its own parameters."""
    made, _ = _matrices_of_one(model, model.parameters.values, h, np.arange(len(model.states)), _NONE)
    return made[0], made[1], made[2]


def _matrices_of_one(
    model: Model, p: Array, h: float, select: Index, differentiated: Index
) -> tuple[list[Array], list[Array]]:
    nx, nu, ny = len(model.states), len(model.inputs), len(model.outputs)
    code = model.compiled
    plant, dplant = affine_matrices(code.rates_tangent, nx, nx, nu, differentiated, p)
    seen, dseen = affine_matrices(code.outputs_tangent, ny, nx, nu, differentiated, p)
    a, b = np.ascontiguousarray(plant[:, :nx]), plant[:, nx:]
    da, db = np.ascontiguousarray(dplant[:, :, :nx]), dplant[:, :, nx:]
    (e, held, ramp), slope = propagators(a, da, h)
    smooth = np.array([0.0 if i.is_held else 1.0 for i in model.inputs] + [0.0])
    g1 = smooth * (ramp @ b)
    dg1 = smooth * (slope[:, 2] @ b + ramp @ db)
    g0, dg0 = held @ b - g1, slope[:, 1] @ b + held @ db - dg1
    all_seen = np.vstack([np.eye(nx, nx + nu + 1), seen])[select]
    all_slopes = np.concatenate([np.zeros((len(differentiated), nx, nx + nu + 1)), dseen], axis=1)[:, select]
    return (
        [e, g0, g1, all_seen[:, :nx], all_seen[:, nx:]],
        [slope[:, 0], dg0, dg1, all_slopes[:, :, :nx], all_slopes[:, :, nx:]],
    )


@dataclass(frozen=True, eq=False)
class LinearBatch(SegmentBatch):
    """`SegmentBatch` for affine models; `substeps` counts the straight pieces of a smooth input in one sample."""

    def simulate(
        self, first: int, last: int, start: Array, parameters: Array, corrections: Array
    ) -> tuple[Array, Index]:
        """Return the outputs of `SegmentBatch.simulate`."""
        offsets, failed, y, fine, _ = self._prepare(first, last, corrections)
        m, which = self._matrices(parameters[first:last], np.empty(0, dtype=np.int64))
        replay(m.e, m.g0, m.g1, m.c, m.d, which, fine, offsets, self._steps_per_sample,
               np.ascontiguousarray(start[first:last]), y, failed)  # fmt: skip
        return y, failed

    def differentiate(
        self, first: int, last: int, start: Array, parameters: Array, corrections: Array
    ) -> tuple[Array, Array, Index]:
        """Return the slopes of `SegmentBatch.differentiate`."""
        offsets, failed, y, fine, weights = self._prepare(first, last, corrections)
        wanted = np.array([self.model.parameters.index(n) for n in self.parameters], dtype=np.int64)
        m, which = self._matrices(parameters[first:last], wanted)
        s = np.empty((len(y), len(self.outputs), self.column_count))
        shifts = [(self.model.input_names.index(c.input), len(wanted) + k) for k, c in enumerate(self.corrections)]
        starts = np.full(len(self.model.states), -1, dtype=np.int64)
        for k, state in enumerate(self.initial_states):
            starts[self.model.states.index(state)] = len(wanted) + len(self.corrections) + k
        replay_tangent(m.e, m.g0, m.g1, m.c, m.d, *m.derivatives, which, fine, offsets, self._steps_per_sample,
                       np.ascontiguousarray(start[first:last]), np.array(shifts, dtype=np.int64).reshape(-1, 2),
                       weights, starts, y, s, failed)  # fmt: skip
        return y, s, failed

    def fine_inputs(self, segment: int) -> tuple[Array, int]:
        """Inputs of a segment as recorded at the fine step, (rows, nu + 1), the last one 1; and the steps a sample."""
        return self._recorded_inputs[segment][0], self._steps_per_sample

    @cached_property
    def _steps_per_sample(self) -> int:
        """Steps in a sample: one where every input is held or none moves."""
        moving = [np.ptp(self.inputs[:, j]) > 0 and not i.is_held for j, i in enumerate(self.model.inputs)]
        return max(self.substeps, SUBSTEPS) if any(moving) else 1

    def _matrices(self, parameters: Array, differentiated: Index) -> tuple[DiscreteMatrices, Index]:
        distinct, which = parameters[:1], np.zeros(len(parameters), dtype=np.int64)
        if np.any(parameters != distinct):
            distinct, found = np.unique(parameters, axis=0, return_inverse=True)
            which = np.ascontiguousarray(found.reshape(-1), dtype=np.int64)
        return discrete_matrices(
            self.model, distinct, self.dt / self._steps_per_sample, self._output_columns, differentiated
        ), which

    def _prepare(self, first: int, last: int, corrections: Array) -> tuple[Index, Index, Array, Array, Array]:
        """Offsets, failures, room for y, fine inputs with the constant 1, and their slopes by the corrections."""
        offsets, failed, y = self._segment_rows(first, last)
        fine = [self._corrected_inputs(s, corrections[s]) for s in range(first, last)]
        return offsets, failed, y, np.concatenate([u for u, _ in fine]), np.concatenate([w for _, w in fine])

    def _corrected_inputs(self, segment: int, corrections: Array) -> tuple[Array, Array]:
        """Return corrected inputs of one segment at the fine step, (rows, nu + 1), and slopes, (rows, corrections)."""
        if not self.corrections:
            return self._recorded_inputs[segment]
        plain = self._recorded_inputs[segment][0]
        u, w = plain.copy(), np.zeros((len(plain), len(self.corrections)))
        known = dict(zip(self.corrections, corrections, strict=True))
        by_input = {c.input: {k.kind: float(v) for k, v in known.items() if k.input == c.input} for c in known}
        for name, own in by_input.items():
            j = self.model.input_names.index(name)
            delay, gain = own.get("delay", 0.0), own.get("gain", 1.0)
            raw, rise = self._delayed_input(segment, j, delay)
            u[:, j] = gain * raw + own.get("zero", 0.0)
            for k, c in enumerate(self.corrections):
                if c.input == name:
                    kind = INPUT_KINDS[c.kind]
                    w[:, k] = raw if kind == GAIN else -gain * rise if kind == DELAY else 1.0
        return u, w

    @cached_property
    def _recorded_inputs(self) -> list[tuple[Array, Array]]:
        """Inputs as recorded at the fine step, for each segment; equal segments, as of drawn runs, share theirs."""
        lengths, fine = np.diff(self.offsets), dict[bytes, Array]()
        samples = [np.ascontiguousarray(self.inputs[a:b]) for a, b in pairwise(self.offsets)]
        keys = [segment.tobytes() for segment in samples]
        for length in np.unique(lengths).tolist():
            distinct = {k: values for k, values in zip(keys, samples, strict=True) if len(values) == length}
            fine.update(zip(distinct, self._fine_inputs(np.stack(list(distinct.values()), axis=1)), strict=True))
        return [(fine[key], np.empty((len(fine[key]), len(self.corrections)))) for key in keys]

    def _fine_inputs(self, samples: Array) -> Array:
        """Return inputs of segments of one length, (samples, segments, nu), at the fine step with the constant 1.

        Shape (segments, rows, nu + 1).
        """
        rows = np.arange((len(samples) - 1) * self._steps_per_sample + 1)
        fine = np.ones((samples.shape[1], len(rows), samples.shape[2] + 1))
        for j in range(samples.shape[2]):
            columns = np.ascontiguousarray(samples[:, :, j])
            if j in self._held_inputs:
                fine[:, :, j] = columns.T[:, rows // self._steps_per_sample]
            else:
                place = rows / self._steps_per_sample
                fine[:, :, j] = spline_points(columns, spline_slopes(columns), place)[0].T
        return fine

    def _delayed_input(self, segment: int, j: int, delay: float) -> tuple[Array, Array]:
        """Return input j at the fine step, late by `delay` [s], and its rate of change; clamped to the segment."""
        samples, slopes = (np.ascontiguousarray(a[segment][:, j : j + 1]) for a in (self._samples, self._slopes))
        place = np.arange((len(samples) - 1) * self._steps_per_sample + 1) / self._steps_per_sample - delay / self.dt
        if j in self._held_inputs:
            return self._held_mean(samples[:, 0], place)
        inside = (place >= 0.0) & (place <= len(samples) - 1.0)
        place = np.clip(place, 0.0, len(samples) - 1.0)
        value, rise = spline_points(samples, slopes, place)
        return value[:, 0], np.where(inside, rise[:, 0] / self.dt, 0.0)

    def _held_mean(self, samples: Array, place: Array) -> tuple[Array, Array]:
        """Return the mean of a held input over each fine step, from `place` on [samples], and its rate of change."""
        steps, last = self._steps_per_sample, len(samples) - 1
        left = np.floor(place + _SAME_SAMPLE)
        after = (place - left) * steps + 1.0 - steps  # share of the step behind the next sample
        switches = after > -steps * _SAME_SAMPLE
        after = np.clip(after, 0.0, 1.0)
        before, behind = (samples[np.clip(left + k, 0, last).astype(int)] for k in (0, 1))
        return before + after * (behind - before), np.where(switches, (behind - before) * steps / self.dt, 0.0)

    @cached_property
    def _held_inputs(self) -> list[int]:
        return [j for j, i in enumerate(self.model.inputs) if i.is_held]

    @cached_property
    def _samples(self) -> list[Array]:
        """Inputs of each segment, (samples, inputs)."""
        return [np.ascontiguousarray(self.inputs[a:b]) for a, b in pairwise(self.offsets)]

    @cached_property
    def _slopes(self) -> list[Array]:
        """Slopes of the spline through the inputs of each segment, in units of the input a sample."""
        return [spline_slopes(samples) for samples in self._samples]


# Affine models under harmonic input: frequency response, and the exact motion in a sum of harmonics.

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """x' = A x + B u, y = C x + D u of a model about its rest or trim; (nx, nx), (nx, nu), (ny, nx), (ny, nu).

    Of one output C is (nx,) and D (nu,); inputs are in the model's signs.
    """

    A: Array
    B: Array
    C: Array
    D: Array


def linear_system(model: Model, outputs: tuple[str, ...] = ()) -> LinearSystem:
    """Return the matrices at the model's own parameters; outputs: observables in order, all states if none is named.

    Raises:
        InputError: the model is not affine in states and inputs.
    """
    if not model.is_affine:
        raise InputError(f"model '{model.name}' is not linear: it has no frequency response")
    nx, nu, ny = len(model.states), len(model.inputs), len(model.outputs)
    values = model.parameters.values
    rates, _ = affine_matrices(model.compiled.rates_tangent, nx, nx, nu, _NONE, values)
    seen, _ = affine_matrices(model.compiled.outputs_tangent, ny, nx, nu, _NONE, values)
    select = [model.observables.index(o) for o in outputs or model.states]
    rows = np.vstack([np.eye(nx, nx + nu + 1), seen])[select]
    return LinearSystem(rates[:, :nx], rates[:, nx:-1], rows[:, :nx], rows[:, nx:-1])


def frequency_response(system: LinearSystem, omega: Array) -> Complex:
    """Return C (i omega - A)^-1 B + D, shape (n, ny, nu); omega in rad/s, signed, time factor exp(+i omega t)."""
    resolvent = 1j * omega[:, None, None] * np.eye(len(system.A)) - system.A
    return system.C @ np.linalg.solve(resolvent, np.broadcast_to(system.B, (len(omega), *system.B.shape))) + system.D


def harmonic_motion(system: LinearSystem, omega: Array, amplitude: Complex, time: Array, start: Array) -> Array:
    """Return outputs under u = Re sum amplitude exp(i omega t), from state `start` at time[0]; exact, shape (n, ny).

    omega: (h,) rad/s, signed; amplitude: (h, nu); time: (n,) s, evenly spaced.
    """
    states = LinearSystem(system.A, system.B, np.eye(len(system.A)), np.zeros_like(system.B))
    steady = np.einsum("hij,hj->hi", frequency_response(states, omega), amplitude)
    turning = np.exp(1j * np.outer(time, omega))
    forced = (turning @ steady).real
    step = propagators(np.ascontiguousarray(system.A), np.zeros((0, *system.A.shape)), float(time[1] - time[0]))[0][0]
    free = np.empty_like(forced)
    free[0] = start - forced[0]
    for k in range(1, len(time)):
        free[k] = step @ free[k - 1]
    return (forced + free) @ system.C.T + (turning @ amplitude).real @ system.D.T
