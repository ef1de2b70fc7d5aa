"""A loop in time: a controller, exactly discretised or sampled, on any model, with the limits of its actuator."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, DivergedError, InputError, Provenance, Record, frozen, spelling_hint
from seatrial.numerics.kernels import feedback as kernel
from seatrial.numerics.kernels.feedback import steer
from seatrial.numerics.kernels.sampled import sampled_controller
from seatrial.physics.loops import TransferLoop
from seatrial.physics.simulate.channels import record_of
from seatrial.physics.simulate.controller import controller_state_space
from seatrial.physics.simulate.divergence import require_bounded
from seatrial.physics.simulate.sampled_controller import sample_noise, sampled_body, steps_a_sample

REFERENCE = "reference"


@dataclass(frozen=True)
class ActuatorLimits:
    """What an actuator cannot do, about its trim; infinite where it can.

    The actuator runs after what its servo would do without limits as fast and as far as it may.

    Attributes:
        limit: largest angle [rad]; rate: largest rate [rad/s].
        stall: angle [rad] beyond which its effect falls: by `loss` rad for each rad beyond, down to nothing.
        loss: chosen, the law of no particular fin: at 1 the effect falls beyond stall as steeply as it rose before.
    """

    limit: float = math.inf
    rate: float = math.inf
    stall: float = math.inf
    loss: float = 1.0

    def __post_init__(self) -> None:
        for name in ("limit", "rate", "stall"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"the actuator's {name} must be positive, not {getattr(self, name):g}")
        if not self.loss >= 0.0:
            raise InputError(f"the effect lost beyond stall must not be negative, not {self.loss:g}")

    @property
    def without_stall(self) -> "ActuatorLimits":
        """Angle and rate limits only."""
        return replace(self, stall=math.inf)


UNLIMITED = ActuatorLimits()
_NOISE_SEED = 0  # of the samples' noise where none is given; chosen


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """A loop's controller before a model, ready to be run.

    The error is reference - output. Actuator and disturbance are counted from their trim and positive as the notation
    table has it, whatever the model's own sign.

    Attributes:
        gains: (g,), of the loop's terms; dt: step and sample interval [s].
        actuator, disturbance_input: inputs of the model; the disturbance adds to its trim; may act where the actuator
            does             (`disturbance_input` the same name) or nowhere (empty).
        output: a state of the model.
        start: (nx,) trim and initial state; inputs: (nu,) trim, in the model's signs; by default zero.
        effectiveness: what a radian of the actuator is worth in the model's, which belongs to one speed.

    Raises:
        InputError: names that the model does not have, a step that is not positive, values that are not finite.
    """

    model: Model
    loop: TransferLoop
    gains: Array
    dt: float
    actuator: str
    disturbance_input: str
    output: str
    start: Array = field(default_factory=lambda: np.empty(0))
    inputs: Array = field(default_factory=lambda: np.empty(0))
    effectiveness: float = 1.0

    def __post_init__(self) -> None:
        model, where = self.model, f"a loop of model '{self.model.name}'"
        for name, known, what in (
            (self.actuator, model.input_names, "input"),
            (self.disturbance_input or self.actuator, model.input_names, "input"),
            (self.output, model.states, "state"),
        ):
            if name not in known:
                raise InputError(f"{where} needs '{name}' as {what}{spelling_hint(name, list(known))}")
        if model.parameters.missing:
            raise InputError(f"model '{model.name}' has no value for {', '.join(model.parameters.missing)}")
        if not (math.isfinite(self.dt) and self.dt > 0.0):
            raise InputError(f"the step of {where} must be positive, not {self.dt:g} s")
        for name, size in (("start", len(model.states)), ("inputs", len(model.inputs))):
            given = np.asarray(getattr(self, name), dtype=np.float64)
            object.__setattr__(self, name, frozen(given if given.size else np.zeros(size)))
            if getattr(self, name).shape != (size,) or not np.all(np.isfinite(given)):
                raise InputError(f"{where} needs {size} finite values for '{name}'")
        if self.loop.sampling is not None:
            steps_a_sample(self.loop.sampling, self.dt)
        if np.shape(self.gains) != (len(self.loop.terms),) or not np.all(np.isfinite(self.gains)):
            raise InputError(f"{where} needs {len(self.loop.terms)} finite gains: {', '.join(self.loop.gains.names)}")

    def run(
        self,
        disturbance: Array,
        limits: ActuatorLimits = UNLIMITED,
        reference: Array | None = None,
        fed_forward: Array | None = None,
        noise: Array | None = None,
    ) -> tuple[Array, Array]:
        """Return states (n, nx) and the actuator's angle from its trim (n,) at the samples of the disturbance (n,).

        Args:
            reference: (n,), absolute, as the output; by default the output's trim.
            fed_forward: (n,), added to the order of the actuator before its limits; by default nothing.
            noise: of each sample that a sampled controller takes of the output; by default of its rms, from seed 0.

        Raises:
            InputError: series of other lengths or with gaps.
            DivergedError: the loop runs away; when, and which state.
        """
        count = len(disturbance)
        place = self.model.states.index(self.output)
        wanted = np.full(count, self.start[place]) if reference is None else np.asarray(reference, dtype=np.float64)
        added = np.zeros(count) if fed_forward is None else np.asarray(fed_forward, dtype=np.float64)
        lengths = {count, len(wanted), len(added)}
        if count < 2 or len(lengths) > 1 or not np.all(np.isfinite([disturbance, wanted, added])):
            raise InputError(
                "disturbance, reference and feed-forward of a closed loop need the same number of samples, two or "
                "more, without gaps"
            )
        memory = self.controller_memory(disturbance, limits, wanted, added, noise)
        states, inputs = np.empty((count, len(self.start))), np.empty((count, len(self.inputs)))
        diverged = steer(
            self.model.compiled.rates, self.command, self.start.copy(), self.inputs.copy(),
            self.model.parameters.values, memory, self.dt, states, inputs,
        )  # fmt: skip
        last = count if diverged < 0 else diverged + 1
        time = frozen(self.dt * np.arange(last))
        require_bounded(self.model, time, states[:last], f"loop '{self.loop.name}'")
        if diverged >= 0:
            raise DivergedError(f"loop '{self.loop.name}' before model '{self.model.name}' runs away at {time[-1]:g} s")
        return states, memory[self._angles(memory, count)]

    @property
    def command(self) -> Callable[..., None]:
        """Return what steers: the controller in continuous time, or the sampled one."""
        return kernel.linear_controller if self.loop.sampling is None else sampled_controller

    def _angles(self, memory: Array, count: int) -> slice:
        """Return where the actuator's angles at the samples stand."""
        first = int(memory[kernel.SERIES]) + 3 * count + 2
        return slice(first, first + count)

    def controller_memory(
        self,
        disturbance: Array,
        limits: ActuatorLimits,
        reference: Array,
        fed_forward: Array,
        noise: Array | None = None,
    ) -> Array:
        """Return the memory of `command` for series (n,), checked by the caller.

        noise: of each sample that a sampled controller takes.
        """
        count = len(disturbance)
        if self.loop.sampling is None:
            n, laws = self._controller_laws
            body, own = np.concatenate([laws, np.zeros(2 * n)]), {kernel.CONTROLLER_ORDER: float(n)}
        else:
            samples = -(-count // steps_a_sample(self.loop.sampling, self.dt))
            heard = sample_noise(self.loop.sampling, samples, _NOISE_SEED) if noise is None else noise[:samples]
            body, own = sampled_body(self.loop, self.gains, self.dt, limits.rate, heard)
        place, disturbed = self._input_index(self.actuator), self._input_index(self.disturbance_input)
        values = {
            kernel.COUNT: count,
            kernel.OUTPUT: self.model.states.index(self.output),
            kernel.ACTUATOR: place,
            kernel.DISTURBED_INPUT: disturbed,
            kernel.TRIM: self.inputs[place],
            kernel.EFFECT: self._sign(place) * self.effectiveness,
            kernel.LIMIT: limits.limit,
            kernel.SLEW: limits.rate * self.dt,
            kernel.STALL: limits.stall,
            kernel.LOSS: limits.loss,
            kernel.SERIES: kernel.HEAD_SIZE + len(body),
            **own,
        }
        head = np.zeros(kernel.HEAD_SIZE)
        head[list(values)] = list(values.values())
        trim = self.inputs[disturbed] if disturbed not in (-1, place) else 0.0
        met = trim + self._sign(disturbed) * hold_equivalent(np.asarray(disturbance, dtype=np.float64))
        series = (reference, reference[-1:], met, fed_forward, fed_forward[-1:], np.zeros(count + 1))
        return np.concatenate([head, body, *series])

    @cached_property
    def _controller_laws(self) -> tuple[int, Array]:
        """The controller's order and what `linear_controller` reads of it: free, with slow states held, their rate."""
        made = controller_state_space(self.loop, self.gains)
        laws = (made.discretised(self.dt, is_holding=held) for held in (False, True))
        return len(made.b), np.concatenate([*laws, made.slow_rate])

    def _input_index(self, name: str) -> int:
        """Return the place of an input; -1 of none."""
        return self.model.input_names.index(name) if name else -1

    def _sign(self, place: int) -> float:
        return -1.0 if place >= 0 and self.model.inputs[place].is_reversed else 1.0

    def record(
        self, name: str, disturbance: Array, limits: ActuatorLimits = UNLIMITED, reference: Array | None = None
    ) -> Record:
        """Return `run` as a record: all states, inputs at their trim, the actuator, the disturbance, the reference."""
        states, angle = self.run(disturbance, limits, reference)
        place, disturbed = self._input_index(self.actuator), self._input_index(self.disturbance_input)
        inputs = np.tile(self.inputs, (len(states), 1))
        inputs[:, place] += self._sign(place) * angle
        if disturbed not in (-1, place):
            inputs[:, disturbed] += self._sign(disturbed) * disturbance
        time = frozen(self.dt * np.arange(len(states)))
        made = record_of(self.model, name, time, states, np.empty((len(states), 0)), inputs)
        if reference is not None:
            about = made.channel(self.output)
            made = made.with_channel(REFERENCE, replace(about, values=frozen(reference)))
        return replace(made, provenance=Provenance(f"loop '{self.loop.name}' before model '{self.model.name}'"))


def closed_loop(
    model: Model,
    loop: TransferLoop,
    gains: Array,
    disturbance: Array,
    dt: float,
    *,
    actuator: str,
    disturbance_input: str,
    output: str,
    limits: ActuatorLimits = UNLIMITED,
    reference: Array | None = None,
    start: Array | None = None,
    inputs: Array | None = None,
    effectiveness: float = 1.0,
) -> Record:
    """The loop's controller with gains (g,) before a model, met by a disturbance (n,), following a reference (n,).

    The arguments are those of `ClosedLoop`; see there for signs and trims. Slow terms are held while a limit bites and
    they would drive further into it (conditional integration; Astrom & Hagglund 1995, PID Controllers, section 3.5).

    Returns:
        A simulated record: states, inputs, actuator and disturbance at their samples, and ``reference`` where given.

    Raises:
        InputError: unknown names, wrong lengths, values that are not finite.
        DivergedError: it runs away.
    """
    nothing = np.empty(0)
    prepared = ClosedLoop(
        model, loop, np.asarray(gains, dtype=np.float64), dt, actuator, disturbance_input, output,
        nothing if start is None else start, nothing if inputs is None else inputs, effectiveness,
    )  # fmt: skip
    return prepared.record(f"{loop.name} closed", disturbance, limits, reference)


def hold_equivalent(series: Array) -> Array:
    """Return values (n,) that, each held over its step, act on a mass as the smooth series does: mid-values, sharpened.

    A hold takes sinc(omega dt / 2) off: w - dt^2 / 24 w'' at mid-step, by cubics, makes up for it.
    """
    w = np.concatenate([2.0 * series[:1] - series[1:2], series, 2.0 * series[-1:] - series[-2:-1]])
    w = np.concatenate([w, 2.0 * w[-1:] - w[-2:-1]])
    # the cubic's mid-value less 1/24 of its second difference: 7/12 and -1/12
    return (7.0 * (w[1:-2] + w[2:-1]) - w[:-3] - w[3:]) / 12.0
