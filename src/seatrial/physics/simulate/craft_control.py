"""Craft under control: a step of heading, a track, a place that is kept."""

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.station import StationThruster
from seatrial.core.values import Array, DivergedError
from seatrial.numerics.kernels import feedback
from seatrial.numerics.kernels import station as keeper
from seatrial.numerics.kernels.feedback import clamp
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.thrust_orders import OUTSIDE_FORCES
from seatrial.physics.models.thruster_layout import MIN_LAG, AngleInput, Thruster, layout_of
from seatrial.physics.simulate.closed_loop import (
    UNLIMITED,
    ActuatorLimits,
    ClosedLoop,
    LoopLaw,
    hold_equivalent,
    sample_noise,
    simulation_step,
    steps_a_sample,
)
from seatrial.physics.simulate.replay import commanded

# A craft that follows a step of heading under proportional-derivative control.

# places in the memory of the command
_KP, _KD, _CHANGE, _LIMIT, _HEADING, _RATE, _ACTUATOR, _SIGN = range(8)


@dataclass(frozen=True)
class HeadingStep:
    """An order to change the heading and how it is followed: delta = KP error - KD r, held over each step.

    Attributes:
        change: of heading [rad]; limit: largest angle of the actuator [rad].
        actuator: input of the model, positive as the notation table has it.
        duration, dt: s.
    """

    change: float
    limit: float
    actuator: str
    duration: float
    dt: float

    def simulate(self, model: Model, gains: Array, start: Array, inputs: Array) -> tuple[Array, Array] | None:
        """Return states (n, nx) and inputs (n, nu) at each step; None where the craft runs away.

        gains: KP [rad/rad], KD [s]; start: (nx,); inputs: (nu,), held but for the actuator; SI units, the
        model's signs.
        """
        place = model.input_names.index(self.actuator)
        memory = np.empty(_SIGN + 1)
        memory[[_KP, _KD]] = gains
        memory[[_CHANGE, _LIMIT]] = start[model.states.index("psi")] + self.change, self.limit
        memory[[_HEADING, _RATE, _ACTUATOR]] = model.states.index("psi"), model.states.index("r"), place
        memory[_SIGN] = -1.0 if model.inputs[place].is_reversed else 1.0
        count = round(self.duration / self.dt)
        try:
            return commanded(model, _follow, memory, self.dt, count, start, inputs, "a step of heading")
        except DivergedError:
            return None


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _follow(t, x, memory, u):  # noqa: ARG001
    """Order the actuator within its limit."""
    error = memory[_CHANGE] - x[int(memory[_HEADING])]
    order = clamp(memory[_KP] * error - memory[_KD] * x[int(memory[_RATE])], memory[_LIMIT])
    u[int(memory[_ACTUATOR])] = memory[_SIGN] * order


# A craft that follows a track by line of sight, its heading kept by a linear controller within actuator limits.


@dataclass(frozen=True)
class LineOfSight:
    """Guidance by line of sight: psi_d = chi - atan((e + sigma q) / Delta), with the integral q of `track_follower`.

    Attributes:
        lookahead: Delta [m]; integral_gain: sigma [m/s], zero without an integral.
        rate: rad/s, the fastest change of the heading ordered.
    """

    lookahead: float
    integral_gain: float = 0.0
    rate: float = math.inf


@dataclass(frozen=True)
class PlannedTrack:
    """A leg to the north and, from `corner` [m] on, one turned by `turn` [rad], taken within `acceptance` [m]."""

    corner: float = math.inf
    turn: float = 0.0
    acceptance: float = 0.0


STRAIGHT = PlannedTrack()


@dataclass(frozen=True, eq=False)
class TrackRun:
    """States (n, nx), the actuator from its trim (n,), and the distance to starboard of the leg that is followed (n,).

    new_leg: sample from which on that is the leg behind the corner; n where it is not reached.
    """

    states: Array
    actuator: Array
    error: Array
    new_leg: int


def follow_track(
    closed: ClosedLoop, guidance: LineOfSight, disturbance: Array, track: PlannedTrack = STRAIGHT,
    limits: ActuatorLimits = UNLIMITED,
) -> TrackRun:  # fmt: skip
    """Return the run of a heading loop whose order is that of the guidance, at the samples of a disturbance (n,).

    The loop's model has the position east of the track as state ``y0``, and ``x0`` where the track has a corner.

    Raises:
        DivergedError: it runs away.
    """
    count, model = len(disturbance), closed.model
    heading = float(closed.start[model.states.index(closed.output)])
    head = np.zeros(feedback.TRACK_HEAD)
    interval = closed.loop.required_sampling.sample_s
    values = {
        feedback.NORTH: model.states.index("x0" if math.isfinite(track.corner) else "y0"),
        feedback.EAST: model.states.index("y0"),
        feedback.LOOKAHEAD: guidance.lookahead,
        feedback.INTEGRAL_GAIN: guidance.integral_gain,
        feedback.ORDER: heading,
        feedback.ORDER_STEP: guidance.rate * interval,
        feedback.CORNER: track.corner,
        feedback.TURN: track.turn,
        feedback.ACCEPTANCE: track.acceptance,
        feedback.INTERVAL: interval,
    }
    head[list(values)] = list(values.values())
    law = closed.law(limits, count)
    law = replace(law, command=feedback.track_follower, parts={**law.parts, feedback.TRACK: head}, answers=3)
    states, (angle, error, leg) = law.run(
        model, closed.dt, closed.given(disturbance, np.full(count, heading), np.zeros(count)), closed.start,
        closed.inputs, f"loop '{closed.loop.name}' on a track",
    )  # fmt: skip
    return TrackRun(states, angle, error, int(np.searchsorted(leg, 1.0)))


# A craft with thrusters that keeps its place, simulated by its nonlinear model within its thrusters' limits.


@dataclass(frozen=True, eq=False)
class StationGains:
    """tau = -K_p R'e - K_i R' int(e) - K_d v: matrices (3, 3); lag: of the filter of v in each axis [s], (3,)."""

    KP: Array
    KI: Array
    KD: Array
    lag: Array


@dataclass(frozen=True, eq=False)
class StationController:
    """A sampled PID in body axes: gains, how it samples, how each thruster is ordered.

    Every sample: v by Tustin's rule from the moves of the pose, the integral by trapezoids, kept while forces are cut.
    sampling: noise and resolution are those of the heading [rad]. step: of the simulation at most [s].
    """

    gains: StationGains
    sampling: Sampling
    thrusters: tuple[StationThruster, ...]
    step: float = MIN_LAG

    @property
    def dt(self) -> float:
        """The step of the simulation [s]: it divides sample and dead time."""
        return simulation_step(self.sampling, self.step)

    def law(self, model: Model) -> LoopLaw:
        """Return the law that keeps a model of `with_outside_forces` on station."""
        past, forward = filter_coefficients(self.gains.lag, self.sampling.sample_s)
        pose = [model.states.index(name) for name in ("x0", "y0", "psi")]
        at_rest, n = np.zeros(keeper.POSE - keeper.INTEGRAL), len(self.thrusters)
        sizes = [0.0, self.sampling.sample_s, n, len(self.thrusters[0].share)]
        matrices = [matrix.ravel() for matrix in (self.gains.KP, self.gains.KI, self.gains.KD)]
        layout = layout_of(model).thrusters
        traits = [_traits(model, *pair) for pair in zip(layout, self.thrusters, strict=True)]
        tables = [part for orders in self.thrusters for part in (orders.share, orders.thrust)]
        law = np.concatenate([*matrices, past, forward, at_rest, pose, sizes, *traits, *tables])
        head = {feedback.DISTURBED_INPUT: model.input_names.index(OUTSIDE_FORCES[0])}
        return LoopLaw(keeper.station_keeper, {feedback.LAW: law}, head, n + 1)


@dataclass(frozen=True, eq=False)
class StationRun:
    """Distance north and east of the station [m], heading [rad], (n,) each; thrust ordered (n, thrusters).

    given: share of the ordered force that is within the limits (n,).
    """

    dt: float
    north: Array
    east: Array
    heading: Array
    thrust: Array
    given: Array

    @property
    def distance(self) -> Array:
        """Distance from the station [m], (n,)."""
        return np.hypot(self.north, self.east)

    def after(self, first: int) -> "StationRun":
        """Return the run from a sample on."""
        rows = {name: getattr(self, name)[first:] for name in ("north", "east", "heading", "thrust", "given")}
        return replace(self, **rows)


def _traits(model: Model, thruster: Thruster, orders: StationThruster) -> Array:
    """Return what `station_keeper` reads of a thruster."""
    traits, angle, command = np.zeros(keeper.TRAITS), thruster.angle, thruster.command
    traits[: orders.inverse.size] = orders.inverse.ravel()
    values = {
        keeper.AZIMUTH: isinstance(angle, AngleInput),
        keeper.COMMAND_INPUT: model.input_names.index(command.channel),
        keeper.ANGLE_INPUT: model.input_names.index(angle.channel) if isinstance(angle, AngleInput) else -1,
        keeper.ZERO: command.zero,
        keeper.SPAN: command.span,
        keeper.LEAST: orders.thrust[0],
        keeper.MOST: orders.thrust[-1],
    }
    traits[list(values)] = list(values.values())
    return traits


def filter_coefficients(lag: Array, sample: float) -> tuple[Array, Array]:
    """Return a, b of v[k] = a v[k-1] + b (x[k] - x[k-1]): s / (lag s + 1) by Tustin's rule; each (3,)."""
    return (2.0 * lag - sample) / (2.0 * lag + sample), 2.0 / (2.0 * lag + sample)


def keep_station(
    model: Model, controller: StationController, resting: Array, pushes: Array, seed: int = 0
) -> StationRun:
    """Return the run of a craft, from rest at its station, in water that moves and under forces from outside.

    Args:
        model: of `with_outside_forces`, without a current of its own.
        resting: inputs with all commands at rest, without the outside forces, (nu - 3,).
        pushes: how far the water has gone north and east at each step [m]; X, Y, N from outside, in the model's unit;
            (5, n).
        seed: of the compass's noise.

    Raises:
        DivergedError: the craft runs away.
    """
    dt, sampling, count = controller.dt, controller.sampling, pushes.shape[1]
    noise = sample_noise(sampling, -(-count // steps_a_sample(sampling, dt)), seed)
    at_rest = np.array([(thruster.command.zero, 0.0) for thruster in layout_of(model).thrusters]).ravel()
    law = controller.law(model).sampled(sampling, dt, noise, at_rest)
    forces = np.stack([hold_equivalent(force) for force in pushes[2:]])
    inputs = np.concatenate([resting, np.zeros(len(OUTSIDE_FORCES))])
    states, answers = law.run(
        model, dt, np.concatenate([-pushes[:2], np.zeros((1, count)), forces]), np.zeros(len(model.states)), inputs,
        "a station",
    )  # fmt: skip
    north, east, heading = states[:, [model.states.index(name) for name in ("x0", "y0", "psi")]].T
    return StationRun(dt, north + pushes[0], east + pushes[1], heading, answers[:-1].T, answers[-1])
