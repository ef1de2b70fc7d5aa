"""Steps of heading and speed, simulated on the nonlinear craft under ArduPilot's controller."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.control.demand import relative_overshoot, settling_time
from seatrial.core.values import Array
from seatrial.exporting.ardupilot.controller import ArduPilotGains, simulate_controlled
from seatrial.exporting.ardupilot.craft import SteeredCraft
from seatrial.exporting.ardupilot.sampled_loop import AT_ORIGIN
from seatrial.physics.loops import Block

LARGEST_OVERSHOOT = 0.1  # of the steps of heading and speed; chosen
HEADING_STEP = math.radians(30.0)  # rad; chosen
SPEED_STEP = -0.2  # of the cruising speed; chosen
_HORIZON = 20.0  # of a simulated step, over the plant's time constant; chosen


@dataclass(frozen=True, eq=False)
class StepResponse:
    """A step simulated.

    Attributes:
        time: (n,), s; value: (n,), of heading [rad] or speed [m/s]; step: its wanted change.
        overshoot: share of the step; settling: s until it stays within 5 %, NaN if it does not.
        weighted_error: integral of time times the error's size (ITAE; Graham & Lathrop 1953, Trans. AIEE 72, 273).
        largest_order: steering or throttle, largest size.
    """

    time: Array
    value: Array
    step: float
    overshoot: float
    settling: float
    weighted_error: float
    largest_order: float

    @property
    def faults(self) -> int:
        """Return 2 where it does not settle, 1 where it overshoots by more than 10 %, else 0."""
        return 2 if math.isnan(self.settling) else int(self.overshoot > LARGEST_OVERSHOOT)

    @property
    def cost(self) -> float:
        """What is least of the best of steps with the same faults: the overshoot where it is too much."""
        return self.overshoot if self.faults == 1 else self.weighted_error


def slow_pole(plant: Block, count: int) -> float:
    """Return the geometric mean of so many of the slowest poles off the origin [rad/s].

    Of sway and yaw there are two, of surge one. Lags of thrusters, which are faster, are left out.
    """
    sizes = np.sort(np.abs(plant.poles))
    return float(np.exp(np.mean(np.log(sizes[sizes > AT_ORIGIN * sizes[-1]][:count]))))


def heading_step(craft: SteeredCraft, gains: ArduPilotGains, scale: float) -> StepResponse:
    """Return the craft's change of heading by 30 degrees from a straight course at cruising speed.

    scale: rad/s, slow poles of the plant.
    """
    horizon = _HORIZON / scale + HEADING_STEP / gains.rate_max
    time, states, inputs = simulate_controlled(craft, gains, horizon, heading=HEADING_STEP)
    place = craft.model.input_names.index(craft.ship.actuator)
    orders = (inputs[:, place] - craft.ship.inputs[place]) / craft.full_steering
    psi = craft.model.states.index("psi")
    return _response(time, states[:, psi] - craft.ship.state[psi], orders, HEADING_STEP)


def speed_step(craft: SteeredCraft, gains: ArduPilotGains) -> StepResponse:
    """Return the craft's change of speed by a fifth of the cruising speed, on a straight course."""
    step = SPEED_STEP * craft.speed
    horizon = _HORIZON / slow_pole(craft.speed_plant, 1) + abs(step) / gains.speed_acceleration
    time, states, inputs = simulate_controlled(craft, gains, horizon, speed=craft.speed + step)
    orders = inputs[:, craft.model.input_names.index(craft.throttle)] / craft.full_throttle
    return _response(time, states[:, craft.model.states.index("u")] - craft.speed, orders, step)


def _response(time: Array, value: Array, orders: Array, step: float) -> StepResponse:
    if not np.isfinite(value).all():
        return StepResponse(time, value, step, math.inf, math.nan, math.nan, math.nan)
    demand = np.full(len(time), step)
    demand[0] = 0.0
    error = time * np.abs(demand - value)
    return StepResponse(
        time, value, step, relative_overshoot(value, demand, (1,)), settling_time(value, demand, (1,), time[1]),
        float(np.trapezoid(error, time)), float(np.max(np.abs(orders))),
    )  # fmt: skip
