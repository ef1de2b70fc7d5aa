"""A craft that follows a track by line of sight, its heading kept by a linear controller within actuator limits."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, DivergedError
from seatrial.numerics.kernels import guidance as kernel
from seatrial.numerics.kernels.feedback import steer
from seatrial.physics.simulate.closed_loop import UNLIMITED, ActuatorLimits, ClosedLoop


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
    head = np.zeros(kernel.TRACK_HEAD)
    interval = closed.dt if closed.loop.sampling is None else closed.loop.sampling.sample_s
    values = {
        kernel.NORTH: model.states.index("x0" if math.isfinite(track.corner) else "y0"),
        kernel.EAST: model.states.index("y0"),
        kernel.LOOKAHEAD: guidance.lookahead,
        kernel.INTEGRAL_GAIN: guidance.integral_gain,
        kernel.ORDER: heading,
        kernel.ORDER_STEP: guidance.rate * interval,
        kernel.CORNER: track.corner,
        kernel.TURN: track.turn,
        kernel.ACCEPTANCE: track.acceptance,
        kernel.INTERVAL: interval,
    }
    head[list(values)] = list(values.values())
    memory = np.concatenate([memory, head, np.zeros(count)])
    states, inputs = np.empty((count, len(model.states))), np.empty((count, len(model.inputs)))
    diverged = steer(
        model.compiled.rates, kernel.track_follower, closed.start.copy(), closed.inputs.copy(),
        model.parameters.values, memory, closed.dt, states, inputs,
    )  # fmt: skip
    if diverged >= 0:
        raise DivergedError(f"loop '{closed.loop.name}' on a track runs away at {diverged * closed.dt:g} s")
    behind = len(memory) - count - kernel.TRACK_HEAD
    begun = int(memory[behind + kernel.NEW_LEG])
    error = memory[len(memory) - count :]
    return TrackRun(states, memory[behind - count - 1 : behind - 1], error, begun if begun > 0 else count)
