"""A Kalman filter over many segments of one model: innovations, and innovations with sensitivities."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations.model import channel_of
from seatrial.core.values import Array, Index
from seatrial.numerics.kernels.integrate import correct
from seatrial.numerics.kernels.kernel import TangentPointer
from seatrial.physics.sensors.measured_outputs import shows_ground_velocity
from seatrial.physics.sensors.wave_motion import STILL, WaveMotion
from seatrial.physics.simulate.batch import SegmentBatch, batch_class

HELD_SUBSTEPS = 4
"""Steps in a sample where inputs are held: at 1 rad a sample the filter then errs by 1e-4 of the motion; chosen."""


@dataclass(frozen=True, eq=False)
class FilterPoint:
    """What a filter has to know besides the model, for one point.

    Attributes:
        start, start_variance: initial states and their variances, (segments, nx).
        parameters: all of the model's, (segments, np); corrections (segments, n).
        intensity: of each state that is `driven`, SI over the root of a second; deviation: of each output, SI.
        waves: unknowns of the filter's `waves`, (k,).
    """

    start: Array
    start_variance: Array
    parameters: Array
    corrections: Array
    intensity: Array
    deviation: Array
    waves: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False)
class _FilteredSegment:
    """What one pass of the filter leaves; arrays that were not required have no rows or columns."""

    e: Array
    v: Array
    de: Array
    dv: Array
    variance: Array
    states: Array
    is_diverged: bool


@dataclass(frozen=True, eq=False)
class KalmanFilter(SegmentBatch):
    """Segments to be filtered; columns: parameters, corrections, squared intensities, waves, squared deviations.

    Attributes:
        driven: states with white process noise.
        waves: what channels show on top of the craft's own motion.
    """

    driven: tuple[str, ...] = ()
    waves: WaveMotion = STILL

    @property
    def noise_count(self) -> int:
        """Number of intensities, unknowns of waves, and deviations."""
        return len(self.driven) + self.waves.size + len(self.outputs)

    @cached_property
    def _driven(self) -> Index:
        return np.array([self.model.states.index(s) for s in self.driven], dtype=np.int64)

    @cached_property
    def _functions(self) -> tuple[TangentPointer, TangentPointer]:
        """Rates and outputs with their Jacobians, their addresses looked up once for all segments."""
        return TangentPointer(self.model.compiled.rates_tangent), TangentPointer(self.model.compiled.outputs_tangent)

    @cached_property
    def _steps_per_sample(self) -> int:
        """Runge-Kutta steps in a sample: more where a linear model holds an input, as samples may lie far apart."""
        if not self.model.is_affine:
            return self.substeps
        is_moving = np.ptp(self.inputs, axis=0) > 0.0
        return max(self.substeps, HELD_SUBSTEPS) if np.any(is_moving & (self._rise == 0.0)) else self.substeps

    @cached_property
    def _shifted_links(self) -> tuple[Index, ...]:
        """Links with columns counted from behind the transition matrix."""
        chain, link_p, link_u, _, g_link_p, g_link_u = self._links
        return (chain, *(_shift_columns(link, len(self.model.states)) for link in (link_p, link_u, g_link_p, g_link_u)))

    @cached_property
    def _state_links(self) -> tuple[Index, ...]:
        none = np.zeros((0, 3), np.int64), np.zeros((0, 4), np.int64)
        return (self._links[0], *none, *none)

    def innovations(self, segment: int, measured: Array, point: FilterPoint) -> tuple[Array, Array, bool]:
        """Return innovations e (measured - predicted) and variances v of one segment, (rows, ny); whether it diverged.

        measured: of all segments, NaN where there is none; there e = 0 and v = 1.
        """
        run = self._run(segment, measured, point, self._state_links, 0, 0)
        return run.e, run.v, run.is_diverged

    def sensitivities(
        self, segment: int, measured: Array, point: FilterPoint
    ) -> tuple[Array, Array, Array, Array, bool]:
        """Return `innovations` with de by all columns, (rows, ny, columns), and dv by the noise's, (rows, ny, noises).

        The gain counts as independent of parameters and corrections.
        """
        width = len(self.parameters) + len(self.corrections) + self.noise_count
        run = self._run(segment, measured, point, self._shifted_links, width, self.noise_count)
        return run.e, run.v, run.de, run.dv, run.is_diverged

    def variances(self, segment: int, point: FilterPoint) -> Array:
        """Variance of each state where nothing is measured, (rows, nx): how far a run may stray from its prediction."""
        nothing = np.full((int(self.offsets[-1]), len(self.outputs)), np.nan)
        return self._run(segment, nothing, point, self._state_links, 0, 0, with_states=True).variance

    def predict_ahead(self, segment: int, measured: Array, point: FilterPoint, origins: Index, steps: int) -> Array:
        """Return outputs up to `steps` samples ahead, from the samples up to each origin, (origins, steps + 1, ny).

        Step 0 is the filtered sample itself. The inputs are those recorded; white noise to come counts as zero. NaN
        where the filter or a prediction diverges.

        Args:
            measured: as in `innovations`; origins: rows within the segment, at least `steps` before its end.
        """
        run = self._run(segment, measured, point, self._state_links, 0, 0, with_states=True)
        if run.is_diverged:
            return np.full((len(origins), steps + 1, len(self.outputs)), np.nan)
        inputs = self._segment_inputs(segment, point.corrections)[0]
        rows = (origins[:, None] + np.arange(steps + 1)).ravel()
        bounds = np.arange(len(origins) + 1, dtype=np.int64) * (steps + 1)
        ahead = batch_class(self.model)(
            self.model, np.ascontiguousarray(inputs[rows]), bounds, self.dt, self.outputs, substeps=self.substeps
        )
        values, none = np.tile(point.parameters[segment], (len(origins), 1)), np.zeros((len(origins), 0))
        states, nx = run.states[origins], len(self.model.states)
        y, _ = ahead.simulate(0, len(origins), np.ascontiguousarray(states[:, :nx]), values, none)
        return y.reshape(len(origins), steps + 1, -1) + self._waves_ahead(states, point.waves, steps)

    def _waves_ahead(self, states: Array, waves: Array, steps: int) -> Array:
        """Return what channels show of waves after filtered states, (origins, steps + 1, ny)."""
        ahead = np.zeros((len(states), steps + 1, len(self.outputs)))
        pairs, _ = self.waves.pairs(waves, self.dt)
        now = states.copy()
        for step in range(steps + 1 if self.waves.peaks else 0):
            for column, places in enumerate(self.wave_states):
                ahead[:, step, column] = now[:, places[places >= 0]].sum(axis=1)
            for a, pair in zip(range(len(self.model.states), states.shape[1], 2), pairs, strict=True):
                now[:, a : a + 2] = now[:, a : a + 2] @ pair[:4].reshape(2, 2).T
        return ahead

    @cached_property
    def wave_states(self) -> Index:
        """State that each output shows of each peak of the waves, -1: none, (ny, peaks)."""
        return self.waves.shown_states([channel_of(o) for o in self.outputs], len(self.model.states))

    @cached_property
    def _heading(self) -> int:
        """Column of the heading, where the velocities over ground beside it were turned by its readings; -1: none."""
        channels = [channel_of(o) for o in self.outputs]
        return channels.index("psi") if shows_ground_velocity(self.model) and "psi" in channels else -1

    def _turning(self, measured: Array) -> Array:
        """Multiple of the heading's error that is taken off each sample, (rows, ny).

        Velocities over ground that a heading too large by e turned are u + v e and v - u e: u - v psi and v + u psi are
        free of e.
        """
        turning, channels = np.zeros(measured.shape), [channel_of(o) for o in self.outputs]
        if self._heading < 0 or not {"u", "v"} <= set(channels):
            return turning
        u, v = channels.index("u"), channels.index("v")
        is_turned = np.all(np.isfinite(measured[:, [u, v, self._heading]]), axis=1)
        turning[is_turned, u], turning[is_turned, v] = -measured[is_turned, v], measured[is_turned, u]
        return turning

    def transitions(self, segment: int, start: Array, parameters: Array, corrections: Array) -> tuple[Array, Array]:
        """Return transition matrices from sample to sample, (rows - 1, nx, nx), and outputs by states, (rows, ny, nx).

        Along the motion without noise; start, parameters, corrections: as in `simulate`, of all segments.
        """
        inputs = self._segment_inputs(segment, corrections)[0]
        rows = len(inputs)
        model, nx = self.model, len(self.model.states)
        whole = SegmentBatch(model, inputs, np.array([0, rows]), self.dt, model.states, substeps=self.substeps)
        one = parameters[segment : segment + 1]
        states = whole.simulate(0, 1, start[segment : segment + 1], one, np.zeros((1, 0)))[0]
        ahead = np.minimum(np.column_stack([np.arange(rows), np.arange(1, rows + 1)]), rows - 1).ravel()
        steps = replace(
            whole, inputs=np.ascontiguousarray(inputs[ahead]), offsets=2 * np.arange(rows + 1, dtype=np.int64),
            outputs=(*self.model.states, *self.outputs), initial_states=self.model.states,
        )  # fmt: skip
        slopes = steps.differentiate(0, rows, states, np.repeat(one, rows, axis=0), np.zeros((rows, 0)))[1]
        return slopes[1:-1:2, :nx], slopes[::2, nx:]

    def _run(
        self,
        segment: int,
        measured: Array,
        point: FilterPoint,
        links: tuple[Index, ...],
        width: int,
        noise_count: int,
        *,
        with_states: bool = False,
    ) -> _FilteredSegment:
        from seatrial.numerics.kernels.innovations import filter_innovations  # compiled when it is first wanted

        chain, link_p, link_u, g_link_p, g_link_u = links
        nx, ny, (a, b) = len(self.model.states), len(self.outputs), self.offsets[segment : segment + 2]
        inputs, weights = self._segment_inputs(segment, point.corrections)
        if not len(link_u) + len(g_link_u):
            weights = np.empty((b - a, 0))
        process = np.zeros(nx)
        process[self._driven] = point.intensity**2
        e, v = np.empty((b - a, ny)), np.empty((b - a, ny))
        de, dv = np.empty((b - a, ny, width)), np.empty((b - a, ny, noise_count))
        pairs, size = self.waves.pairs(point.waves, self.dt)
        rows = b - a if with_states else 0
        variance, states = np.empty((rows, nx)), np.empty((rows, nx + 2 * len(size)))
        readings = np.ascontiguousarray(measured[a:b])
        failed = filter_innovations(
            *self._functions, inputs, weights, self._rise, self.dt,
            self._steps_per_sample, point.start[segment], point.start_variance[segment], point.parameters[segment],
            chain, link_p, link_u, g_link_p, g_link_u, self._output_columns, len(self.model.outputs), self._driven,
            process, point.deviation**2, readings, pairs, size, self.wave_states,
            self._heading, self._turning(readings), e, v, de, dv, variance, states,
        )  # fmt: skip
        return _FilteredSegment(e, v, de, dv, variance, states, failed >= 0)

    def _segment_inputs(self, segment: int, corrections: Array) -> tuple[Array, Array]:
        """Return the corrected inputs of a segment and their derivatives, as `corrected_inputs`."""
        a, b = self.offsets[segment : segment + 2]
        gain, zero, delay = (c[segment] for c in self._correction_values(corrections))
        return corrected_inputs(self.inputs[a:b], self.dt, gain, zero, delay)


def corrected_inputs(inputs: Array, dt: float, gain: Array, zero: Array, delay: Array) -> tuple[Array, Array]:
    """Inputs as `kernels.integrate.effective_input` corrects them, (rows, nu), and their derivatives (rows, 3 nu).

    The derivatives by zero, gain and delay stand in that order for every input (`kernels.integrate`).
    """
    made, weights = np.empty(inputs.shape), np.empty((len(inputs), 3 * inputs.shape[1]))
    correct(np.ascontiguousarray(inputs), dt, gain, zero, delay, made, weights)
    return made, weights


def _shift_columns(link: Index, columns: int) -> Index:
    moved = link.copy()
    moved[:, -1] += columns
    return moved
