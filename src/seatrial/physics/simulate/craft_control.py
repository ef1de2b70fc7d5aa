"""Craft under control: a step of heading, a track, a place that is kept."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, DivergedError
from seatrial.numerics.kernels import feedback
from seatrial.numerics.kernels import station as keeper
from seatrial.numerics.kernels.feedback import clamp
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.thrust_orders import OUTSIDE_FORCES
from seatrial.physics.models.thruster_layout import MIN_LAG, AngleInput, Thruster
from seatrial.physics.simulate.closed_loop import UNLIMITED, ActuatorLimits, ClosedLoop, sample_noise, simulation_step
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
    memory = closed.controller_memory(disturbance, limits, np.full(count, heading), np.zeros(count))
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
    memory = np.concatenate([memory, head, np.zeros(count)])
    states, _ = commanded(
        model, feedback.track_follower, memory, closed.dt, count, closed.start, closed.inputs,
        f"loop '{closed.loop.name}' on a track",
    )  # fmt: skip
    behind = len(memory) - count - feedback.TRACK_HEAD
    begun = int(memory[behind + feedback.NEW_LEG])
    error = memory[len(memory) - count :]
    return TrackRun(states, memory[behind - count - 1 : behind - 1], error, begun if begun > 0 else count)


# A craft with thrusters that keeps its place, simulated by its nonlinear model within its thrusters' limits.


@dataclass(frozen=True, eq=False)
class ThrusterOrders:
    """How a controller orders one thruster: rows of the inverse (6,), table of share (k,) over rising thrust (k,)."""

    thruster: Thruster
    rows: Array
    share: Array
    thrust: Array


@dataclass(frozen=True, eq=False)
class StationController:
    """A sampled PID in body axes: gains (3, 3), filter lags [s] (3,), how it samples, the thrusters.

    Every sample: v by Tustin's rule from the moves of the pose, the integral by trapezoids, kept while forces are cut.
    sampling: noise and resolution are those of the heading [rad]. step: of the simulation at most [s].
    """

    KP: Array
    KI: Array
    KD: Array
    lag: Array
    sampling: Sampling
    thrusters: Sequence[ThrusterOrders]
    step: float = MIN_LAG

    @property
    def dt(self) -> float:
        """The step of the simulation [s]: it divides sample and dead time."""
        return simulation_step(self.sampling, self.step)


@dataclass(frozen=True, eq=False)
class StationRun:
    """Distance north and east of the station [m], heading [rad], (n,) each; thrust ordered (n, thrusters).

    given: share of the ordered force that is within the limits (n,); states: last of the model (nx,).
    """

    dt: float
    north: Array
    east: Array
    heading: Array
    thrust: Array
    given: Array
    states: Array

    @property
    def distance(self) -> Array:
        """Distance from the station [m], (n,)."""
        return np.hypot(self.north, self.east)

    def after(self, first: int) -> "StationRun":
        """Return the run from a sample on."""
        rows = {name: getattr(self, name)[first:] for name in ("north", "east", "heading", "thrust", "given")}
        return replace(self, **rows)


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
        pushes: how far the water has gone north and east at each step [m]; X, Y, N from outside held over each step, in
            the model's unit; (5, n).
        seed: of the compass's noise.

    Raises:
        DivergedError: the craft runs away.
    """
    dt, count = controller.dt, pushes.shape[1]
    noise = sample_noise(controller.sampling, count, seed)
    memory, series = _memory(model, controller, dt, np.concatenate([pushes, noise[None]]))
    inputs = np.concatenate([resting, np.zeros(len(OUTSIDE_FORCES))])
    at_rest = np.zeros(len(model.states))
    states, _ = commanded(model, keeper.station_keeper, memory, dt, count, at_rest, inputs, "a station")
    rows = memory[series + keeper.DISTURBANCES * count :].reshape(-1, count)
    place = model.states.index
    return StationRun(
        dt, states[:, place("x0")] + pushes[0], states[:, place("y0")] + pushes[1], states[:, place("psi")].copy(),
        rows[2:-1:3].T.copy(), rows[-1].copy(), states[-1].copy(),
    )  # fmt: skip


def _memory(model: Model, controller: StationController, dt: float, pushes: Array) -> tuple[Array, int]:
    """Return the memory of `station_keeper` and where its series begin; pushes: what disturbs, (6, n)."""
    n, count, size = len(controller.thrusters), pushes.shape[1], len(controller.thrusters[0].share)
    sampling = controller.sampling
    series = int(keeper.series_start(n, size))
    memory = np.zeros(series + (keeper.DISTURBANCES + 3 * n + 1) * count)
    values = {
        keeper.THRUSTERS: n, keeper.COUNT: count, keeper.HOLD: round(sampling.sample_s / dt),
        keeper.DELAY: round(sampling.dead_time / dt), keeper.SAMPLE: sampling.sample_s, keeper.TABLE: size,
        keeper.PSI: model.states.index("psi"), keeper.NORTH: model.states.index("x0"),
        keeper.EAST: model.states.index("y0"), keeper.FORCE_INPUT: model.input_names.index(OUTSIDE_FORCES[0]),
        keeper.RESOLUTION: sampling.resolution,
    }  # fmt: skip
    memory[list(values)] = list(values.values())
    past, forward = filter_coefficients(controller.lag, sampling.sample_s)
    parts: tuple[tuple[int, Array], ...] = (
        (keeper.KP, controller.KP), (keeper.KI, controller.KI), (keeper.KD, controller.KD), (keeper.PAST, past),
        (keeper.FORWARD, forward), (series, pushes),
    )  # fmt: skip
    for start, part in parts:
        memory[start : start + part.size] = part.ravel()
    for i, orders in enumerate(controller.thrusters):
        _write_thruster(memory, keeper.ROWS + i * keeper.TRAITS, orders, model)
        start = keeper.tables_start(n) + 2 * i * size
        memory[start : start + 2 * size] = np.concatenate([orders.share, orders.thrust])
    return memory, series


def _write_thruster(memory: Array, row: int, orders: ThrusterOrders, model: Model) -> None:
    thruster, angle = orders.thruster, orders.thruster.angle
    memory[row : row + 6] = orders.rows
    turns = isinstance(angle, AngleInput)
    traits = {
        keeper.AZIMUTH: float(turns), keeper.COMMAND_INPUT: model.input_names.index(thruster.command.channel),
        keeper.ZERO: thruster.command.zero, keeper.SPAN: thruster.command.span,
        keeper.LEAST: orders.thrust[0], keeper.MOST: orders.thrust[-1],
        keeper.ANGLE_INPUT: model.input_names.index(angle.channel) if isinstance(angle, AngleInput) else -1,
    }  # fmt: skip
    memory[row + np.array(list(traits), dtype=np.int64)] = list(traits.values())
