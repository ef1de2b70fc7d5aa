"""A loop in time: a controller that samples, on any model, within its actuator's limits."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.tuning import DiscreteBlock
from seatrial.core.values import Array, InputError, Provenance, Record, frozen, spelling_hint
from seatrial.numerics.kernels import feedback
from seatrial.numerics.kernels.feedback import sampled_controller
from seatrial.numerics.kernels.integrate import evaluate
from seatrial.numerics.kernels.linear import propagators, replay
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.discrete import discrete_blocks
from seatrial.physics.loops.loop import Sampling, controllable_form, in_series, straight_step
from seatrial.physics.loops.loop_states import StateSpace
from seatrial.physics.simulate.replay import commanded, record_of

# A sampled controller in steps: its blocks by Tustin's rule, sensor and servo exactly, the dead time as a queue.

_WHOLE = 1e-6  # of a sample: a step that divides it
_TRIED = 40  # numbers of steps a sample that are tried, for one in which the dead time is whole; chosen
_NEAR = 0.02  # of a step: a dead time that counts as whole; chosen
_KEPT = 64  # sensors and servos in steps kept in memory, the same for all gains; chosen
_SLOWEST_POLE = 1e-6  # rad/s, taken for a loop without states
_NOISE_STREAM = 12  # of random numbers, apart from those of disturbances of the same seed; chosen
_FINEST = 0.2  # of the dead time, the longest step where there is one; chosen


def fastest_motion(loop: TransferLoop) -> float:
    """Return the plant's fastest pole [rad/s], which steps of a simulation follow between samples."""
    return float(np.abs(loop.plant.poles).max(initial=_SLOWEST_POLE))


def simulation_step(sampling: Sampling, longest: float) -> float:
    """Return the longest step [s] up to `longest` that divides the sample time, and the dead time as well as can be."""
    T, dead = sampling.sample_s, sampling.dead_time
    least = max(1, math.ceil(T / min(longest, _FINEST * dead if dead else math.inf) - _WHOLE))
    counts = range(least, least + _TRIED)
    misses = {count: abs(dead * count / T - round(dead * count / T)) for count in counts}
    return T / next((count for count, miss in misses.items() if miss < _NEAR), min(misses, key=misses.__getitem__))


def steps_a_sample(sampling: Sampling, dt: float) -> int:
    """Return how many steps of dt [s] make a sample.

    Raises:
        InputError: they do not make one.
    """
    every = round(sampling.sample_s / dt)
    if every < 1 or abs(every * dt - sampling.sample_s) > _WHOLE * sampling.sample_s:
        raise InputError(
            f"steps of {dt:g} s do not make a sample of {sampling.sample_s:g} s; give a step that divides it"
        )
    return every


def sample_noise(sampling: Sampling, count: int, seed: int = 0) -> Array:
    """Return the noise of so many samples, (n,)."""
    if not sampling.noise:
        return np.zeros(count)
    return sampling.noise * np.random.default_rng([seed, _NOISE_STREAM]).standard_normal(count)


@dataclass(frozen=True, eq=False)
class LoopLaw:
    """A controller that samples, as its command reads it.

    Attributes:
        command: a kernel of `COMMAND_SIGNATURE`.
        parts: what stands behind the head of its memory, by the entry of the head that says where.
        head: its other entries; answers: how many series it writes.
    """

    command: Callable[..., None]
    parts: Mapping[int, Array]
    head: Mapping[int, float]
    answers: int = 1

    def sampled(self, sampling: Sampling, dt: float, noise: Array, waiting: Array) -> "LoopLaw":
        """Return the law at a sample time; noise: of each sample; waiting: orders (w,) that act before the first."""
        late = round(sampling.dead_time / dt)
        head = {
            feedback.EVERY: steps_a_sample(sampling, dt),
            feedback.QUEUE_SIZE: late,
            feedback.RESOLUTION: sampling.resolution,
        }
        parts = {feedback.QUEUE: np.repeat(waiting, late), feedback.NOISE: noise}
        return replace(self, parts={**self.parts, **parts}, head={**self.head, **head})

    def run(
        self, model: Model, dt: float, given: Array, start: Array, inputs: Array, subject: str
    ) -> tuple[Array, Array]:
        """Return states (n, nx) and answers (a, n) of a model under the law: the one simulation of loops in time.

        given: references and disturbances as the command reads them, (r, n); start: (nx,); inputs: (nu,), held but
        for what the command sets.

        Raises:
            DivergedError: the loop runs away; when, and which state.
        """
        count = given.shape[1]
        parts = {
            **self.parts, feedback.SERIES: given.ravel(), feedback.ANSWERS: np.zeros(self.answers * (count + 1))
        }  # fmt: skip
        places = np.cumsum([feedback.HEAD_SIZE, *map(len, parts.values())])
        head = np.zeros(feedback.HEAD_SIZE)
        head[[*self.head, *parts, feedback.COUNT]] = [*self.head.values(), *places[:-1], count]
        memory = np.concatenate([head, *parts.values()])
        states, _ = commanded(model, self.command, memory, dt, count, start, inputs, subject)
        return states, memory[places[-2] :].reshape(self.answers, count + 1)[:, :count]


def transfer_law(loop: TransferLoop, gains: Array, dt: float) -> LoopLaw:
    """Return the law of a loop's controller between its sensor and its servo."""
    sensor, sensor_order = _stepped(in_series("sensor", loop.sensor), dt)
    servo, servo_order = _stepped(in_series("servo", loop.servo), dt)
    factors = [*np.asarray(gains).tolist(), *[1.0] * len(loop.filters)]
    blocks = np.concatenate([_numbers(block, gain) for block, gain in zip(discrete_blocks(loop), factors, strict=True)])
    head = {
        feedback.SENSOR_ORDER: sensor_order,
        feedback.SERVO_ORDER: servo_order,
        feedback.TERM_COUNT: len(loop.terms),
        feedback.FILTER_COUNT: len(loop.filters),
    }
    return LoopLaw(sampled_controller, {feedback.SENSOR: sensor, feedback.SERVO: servo, feedback.LAW: blocks}, head)


def _numbers(block: DiscreteBlock, gain: float) -> Array:
    n = len(block.a) - 1
    return np.concatenate([[n, gain, block.hold, 0.0], block.b, block.a, np.zeros(n)])


@lru_cache(maxsize=_KEPT)
def _stepped(block: Block, dt: float) -> tuple[Array, int]:
    """Return a block for an input that runs straight over each step (Franklin, Powell & Workman 1998, section 6.3)."""
    A, b, c, d = controllable_form(block)
    E, before, after = straight_step(A, b, dt)
    n = len(b)
    return np.concatenate([E.T.ravel(), before, after, c, [d], np.zeros(2 * n + 1)]), n


# A linear loop simulated in time: output, actuator and actuator rate, met by one series of the disturbance.


def loop_record(states: StateSpace, gains: Array, disturbance: Array, dt: float) -> Array:
    """Return output, actuator and actuator rate (n, 3) with the gains (g,), from rest, by a compiled scalar loop.

    The disturbance (n,) is held over each step of `dt` [s]: x_{k+1} = e^(A h) x_k + h phi_1(A h) b w_k, exact.

    Raises:
        InputError: a disturbance of fewer than two samples or with gaps.
    """
    if len(disturbance) < 2 or not np.isfinite(disturbance).all():
        raise InputError("the disturbance of a loop needs two samples or more, without gaps")
    A, row = states.closed_loop_matrix(gains), states.actuator_row(gains)
    n = len(A)
    held = propagators(A, np.zeros((0, n, n)), dt)[0]
    rows = np.stack([states.c, row, row @ A])
    direct = np.array([[0.0], [0.0], [row @ states.b]])
    out, failed = np.empty((len(disturbance), 3)), np.full(1, -1, dtype=np.int64)
    inputs = np.ascontiguousarray(disturbance, dtype=np.float64)[:, None]
    replay(
        held[:1].copy(), (held[1] @ states.b)[None, :, None], np.zeros((1, n, 1)), rows[None], direct[None],
        np.zeros(1, dtype=np.int64), inputs, np.array([0, len(disturbance)]), 1, np.zeros((1, n)), out, failed,
    )  # fmt: skip
    return out


# A loop in time: a controller that samples, on any model, with the limits of its actuator.

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
        steps_a_sample(self.loop.required_sampling, self.dt)
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
            noise: of each sample that the controller takes of the output; by default of its rms, from seed 0.

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
        law = self.law(limits, count, noise)
        states, answers = law.run(
            self.model, self.dt, self.given(disturbance, wanted, added), self.start, self.inputs,
            f"loop '{self.loop.name}'",
        )  # fmt: skip
        return states, answers[0]

    def law(self, limits: ActuatorLimits, count: int, noise: Array | None = None) -> LoopLaw:
        """Return the law with the limits of its actuator for so many steps; noise: of each sample that it takes."""
        sampling, place = self.loop.required_sampling, self._input_index(self.actuator)
        samples = -(-count // steps_a_sample(sampling, self.dt))
        heard = sample_noise(sampling, samples) if noise is None else noise[:samples]
        head = {
            feedback.OUTPUT: self.model.states.index(self.output),
            feedback.ACTUATOR: place,
            feedback.DISTURBED_INPUT: self._input_index(self.disturbance_input),
            feedback.TRIM: self.inputs[place],
            feedback.EFFECT: self._sign(place) * self.effectiveness,
            feedback.LIMIT: limits.limit,
            feedback.SLEW: limits.rate * self.dt,
            feedback.SAMPLE_SLEW: limits.rate * sampling.sample_s,
            feedback.STALL: limits.stall,
            feedback.LOSS: limits.loss,
        }
        law = self._law.sampled(sampling, self.dt, heard, np.zeros(1))
        return replace(law, head={**law.head, **head})

    def given(self, disturbance: Array, reference: Array, fed_forward: Array) -> Array:
        """Return the rows that the law reads of series (n,), (3, n)."""
        place, disturbed = self._input_index(self.actuator), self._input_index(self.disturbance_input)
        trim = self.inputs[disturbed] if disturbed not in (-1, place) else 0.0
        met = trim + self._sign(disturbed) * hold_equivalent(np.asarray(disturbance, dtype=np.float64))
        return np.stack([reference, met, fed_forward])

    @cached_property
    def _law(self) -> LoopLaw:
        """The controller's law, the same in every run."""
        return transfer_law(self.loop, self.gains, self.dt)

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
        outputs = np.empty((len(states), len(self.model.outputs)))
        if self.model.outputs:
            evaluate(self.model.compiled.outputs, states, inputs, self.model.parameters.values, 0.0, outputs)
        made = record_of(self.model, name, time, states, outputs, inputs)
        if reference is not None:
            about = made.channel(self.output)
            made = made.with_channel(REFERENCE, replace(about, values=frozen(reference)))
        return replace(made, provenance=Provenance(f"loop '{self.loop.name}' before model '{self.model.name}'"))


def hold_equivalent(series: Array) -> Array:
    """Return values (n,) that, each held over its step, act on a mass as the smooth series does: mid-values, sharpened.

    A hold takes sinc(omega dt / 2) off: w - dt^2 / 24 w'' at mid-step, by cubics, makes up for it.
    """
    w = np.concatenate([2.0 * series[:1] - series[1:2], series, 2.0 * series[-1:] - series[-2:-1]])
    w = np.concatenate([w, 2.0 * w[-1:] - w[-2:-1]])
    # the cubic's mid-value less 1/24 of its second difference: 7/12 and -1/12
    return (7.0 * (w[1:-2] + w[2:-1]) - w[:-3] - w[3:]) / 12.0
