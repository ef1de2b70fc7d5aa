"""The recursive filter: the information of a fit carried on, sample by sample, in bounded memory.

Recursive identification of output error (Ljung & Soderstrom 1983, section 3.7; Ljung 1979): coefficients and state are
one Gaussian belief without process noise, so that the state is what the coefficients and the start of the run make of
it, and its derivatives are those of the batch. For models linear in both it is the batch estimate itself.

It needs a good fit to go on from (`curvature`): begun with errors of 70 % it may settle elsewhere and be sure of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.online.gaussian_state import GaussianState
from seatrial.estimation.estimate.online.stepping import FilterState, stepper_for

_HISTORY_SAMPLES = 12  # inputs kept before the sample in work, for the spline; chosen
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
    ) -> None:
        """Carry `belief` on.

        Args:
            model: its other parameters are known; names: of the k coefficients, in the belief's order.
            outputs: observables that are measured, ny; noise: their standard deviations, SI, (ny,), times the root of
                the variance inflation where residuals are coloured.
            dt: s between samples.
            recent: the run's latest inputs up to the present sample, (m, nu), m >= 1, in the model's signs, a dozen if
                there are. None: the belief stands before a run's first sample, which comes next.

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
        self._filter_state = _initial_filter_state(
            initial, np.asarray(noise, dtype=np.float64), dt, self._guard, forgetting or Forgetting()
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
        self._process(len(w.inputs) - self._stepper.look_ahead)

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
    def is_sound(self) -> bool:
        """Whether the filter may be believed; if not, a window of the latest samples has to be fitted again.

        It is not where a number is not finite, the state left all bounds, a coefficient its own, or the innovations of
        a channel are larger than believed (`Guard.unsound`) while its mean covers half the guard's memory.
        """
        h = self._filter_state
        if self._buffer.failed or not (np.all(np.isfinite(h.z)) and np.all(np.isfinite(h.root))):
            return False
        value = h.z[: len(self.names)]
        if np.any(value < self._lower) or np.any(value > self._upper):
            return False
        filled = h.counts[0] >= 0.5 * h.averaging_samples
        return not np.any(filled & (h.running_means[:, 0] > self._guard.divergence_ratio))


def _initial_filter_state(
    initial: GaussianState, noise: Array, dt: float, guard: DivergenceGuard, forgetting: Forgetting
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
    )
