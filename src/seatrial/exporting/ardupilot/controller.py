"""ArduPilot's heading and speed control of boats, loop by loop, before any model.

As the sources of ArduPilot compute it (branch master, 2025): AC_PID.cpp, `update_all` and `update_i`;
AR_AttitudeControl.cpp, `get_steering_out_heading`, `get_steering_out_rate`, `get_throttle_out_speed`; AP_MotorsUGV.cpp,
`output_regular`, `output_skid_steering`. What a loop computes reaches the actuators with the next one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from seatrial.core.values import Array
from seatrial.exporting.ardupilot.craft import SteeredCraft
from seatrial.exporting.ardupilot.gains import CascadeGains, PidGains, filter_share
from seatrial.numerics.kernels.feedback import clamp, steer
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel

LOOP_RATE = 50.0  # Hz, default of SCHED_LOOP_RATE for Rover (AP_Scheduler.cpp)
SLEW_RATE = 1.0  # of full throttle in a second, default of MOT_SLEWRATE (AP_MotorsUGV.cpp)

# positions in the controller's memory: places, trims and limits; what is remembered; the two AC_PIDs follow
(
    PSI, R, U, V, STEERING, THROTTLE, STEERING_TRIM, FULL_STEERING, FULL_THROTTLE, DT, IS_SKID, SCALING_SPEED,
    STEERING_SLEW, CRUISE_SPEED, CRUISE_THROTTLE, ANGLE_P, RATE_MAX, TURN_ACCELERATION, SPEED_ACCELERATION, HEADING,
    SPEED, DESIRED_RATE, DESIRED_SPEED, STEERING_OUT, THROTTLE_OUT, STEERING_NOW, IS_STEERING_LIMITED,
    IS_THROTTLE_LIMITED, HAS_REVERSE, HEAD,
) = range(30)  # fmt: skip
# positions in an AC_PID
(
    GAIN_P, GAIN_I, GAIN_D, GAIN_FF, INTEGRAL_MAX, TARGET_SHARE, ERROR_SHARE, DERIVATIVE_SHARE,
    TARGET, ERROR, DERIVATIVE, INTEGRAL, IS_RUNNING, PID_SIZE,
) = range(14)  # fmt: skip


@dataclass(frozen=True)
class ArduPilotGains:
    """Everything tuned: the cascade of the heading, the speed control, and their limits.

    Attributes:
        speed: None where the model has no throttle.
        rate_max: ATC_STR_RAT_MAX [rad/s]; turn_acceleration: ATC_STR_ACC_MAX [rad/s^2].
        speed_acceleration: ATC_ACCEL_MAX [m/s^2].
    """

    heading: CascadeGains
    speed: PidGains | None
    rate_max: float
    turn_acceleration: float
    speed_acceleration: float


def simulate_controlled(
    craft: SteeredCraft, gains: ArduPilotGains, duration: float, heading: float = 0.0, speed: float | None = None
) -> tuple[Array, Array, Array]:
    """Return time (n,), states (n, nx) and inputs (n, nu) of the craft steered to a heading and a speed from its trim.

    heading: change [rad]; speed: m/s, the cruising speed by default. States are NaN once the craft runs away.
    """
    dt = 1.0 / LOOP_RATE
    count = math.ceil(duration / dt) + 1
    states, inputs = np.full((count, len(craft.ship.state)), np.nan), np.empty((count, len(craft.ship.inputs)))
    memory = controller_memory(craft, gains, heading, craft.speed if speed is None else speed, dt)
    loss = steer(
        craft.model.compiled.rates, ardupilot, craft.ship.state.copy(), craft.ship.inputs.copy(),
        craft.model.parameters.values, memory, dt, states, inputs,
    )  # fmt: skip
    if loss >= 0:
        states[loss:] = np.nan
    return np.asarray(dt * np.arange(count), dtype=np.float64), states, inputs


def controller_memory(craft: SteeredCraft, gains: ArduPilotGains, heading: float, speed: float, dt: float) -> Array:
    """Return the memory of `ardupilot` at rest about the trim of the craft; heading [rad], speed [m/s], dt [s]."""
    model = craft.model
    head = np.zeros(HEAD)

    def place(name: str, names: tuple[str, ...]) -> float:
        return float(names.index(name)) if name in names else -1.0

    steering, has_throttle = (
        model.input_names.index(craft.ship.actuator),
        bool(craft.throttle) and gains.speed is not None,
    )
    values = {
        PSI: place("psi", model.states), R: place("r", model.states), U: place("u", model.states),
        V: place("v", model.states), STEERING: steering,
        THROTTLE: place(craft.throttle, model.input_names) if has_throttle else -1.0,
        STEERING_TRIM: craft.ship.inputs[steering], FULL_STEERING: craft.full_steering,
        FULL_THROTTLE: craft.full_throttle, DT: dt, IS_SKID: float(craft.is_skid), SCALING_SPEED: craft.scaling_speed,
        STEERING_SLEW: craft.steering_rate * dt, CRUISE_SPEED: craft.speed,
        CRUISE_THROTTLE: craft.cruise_throttle if has_throttle else 0.0,
        ANGLE_P: gains.heading.angle_P, RATE_MAX: gains.rate_max, TURN_ACCELERATION: gains.turn_acceleration,
        SPEED_ACCELERATION: gains.speed_acceleration, HEADING: craft.ship.state[model.states.index("psi")] + heading,
        SPEED: speed, DESIRED_SPEED: craft.speed,
        THROTTLE_OUT: craft.trim_throttle if has_throttle else 0.0, HAS_REVERSE: float(craft.is_skid),
    }  # fmt: skip
    head[list(values)] = list(values.values())
    return np.concatenate(
        [head, _pid_memory(gains.heading.rate, dt), _pid_memory(gains.speed or PidGains(0.0, 0.0), dt)]
    )


def _pid_memory(gains: PidGains, dt: float) -> Array:
    memory = np.zeros(PID_SIZE)
    memory[[GAIN_P, GAIN_I, GAIN_D, GAIN_FF, INTEGRAL_MAX]] = gains.P, gains.I, gains.D, gains.FF, gains.integral_limit
    filters = gains.target_filter, gains.error_filter, gains.derivative_filter
    memory[[TARGET_SHARE, ERROR_SHARE, DERIVATIVE_SHARE]] = [filter_share(f, dt) for f in filters]
    return memory


@njit(**OPTIONS)
def _pid_output(memory, pid, target, measurement, dt, is_limited):
    """Return P + I + D + FF of an AC_PID: target, error and the error's derivative filtered, then the integral."""
    if memory[pid + IS_RUNNING] == 0.0:
        memory[pid + IS_RUNNING] = 1.0
        memory[pid + TARGET] = target
        memory[pid + ERROR] = target - measurement
    else:
        memory[pid + TARGET] += memory[pid + TARGET_SHARE] * (target - memory[pid + TARGET])
        last = memory[pid + ERROR]
        memory[pid + ERROR] += memory[pid + ERROR_SHARE] * (memory[pid + TARGET] - measurement - last)
        slope = (memory[pid + ERROR] - last) / dt
        memory[pid + DERIVATIVE] += memory[pid + DERIVATIVE_SHARE] * (slope - memory[pid + DERIVATIVE])
    error = memory[pid + ERROR]
    if not is_limited or memory[pid + INTEGRAL] * error < 0.0:
        integral = memory[pid + INTEGRAL] + memory[pid + GAIN_I] * error * dt
        memory[pid + INTEGRAL] = clamp(integral, memory[pid + INTEGRAL_MAX])
    feedback = memory[pid + GAIN_P] * error + memory[pid + INTEGRAL] + memory[pid + GAIN_D] * memory[pid + DERIVATIVE]
    return feedback + memory[pid + GAIN_FF] * memory[pid + TARGET]


@njit(**OPTIONS)
def _apply(memory, u):
    """Set the inputs that the last loop ordered; a rudder follows as fast as it can."""
    now = memory[STEERING_NOW]
    memory[STEERING_NOW] = now + clamp(memory[STEERING_OUT] - now, memory[STEERING_SLEW])
    u[int(memory[STEERING])] = memory[STEERING_TRIM] + memory[FULL_STEERING] * memory[STEERING_NOW]
    if memory[THROTTLE] >= 0.0:
        u[int(memory[THROTTLE])] = memory[FULL_THROTTLE] * memory[THROTTLE_OUT]


@njit(**OPTIONS)
def _steering_order(x, memory):
    """Return the steering that the heading error asks for, -1 to 1."""
    dt, acceleration = memory[DT], memory[TURN_ACCELERATION]
    error = memory[HEADING] - x[int(memory[PSI])]
    error -= 2.0 * math.pi * math.floor(0.5 + error / (2.0 * math.pi))
    desired = clamp(memory[ANGLE_P] * error, math.sqrt(2.0 * abs(error) * acceleration))
    desired = memory[DESIRED_RATE] + clamp(desired - memory[DESIRED_RATE], acceleration * dt)
    memory[DESIRED_RATE] = clamp(desired, memory[RATE_MAX])
    is_limited = memory[IS_STEERING_LIMITED] > 0.0
    return clamp(_pid_output(memory, HEAD, memory[DESIRED_RATE], x[int(memory[R])], dt, is_limited), 1.0)


@njit(**OPTIONS)
def _throttle_order(x, memory):
    """Return the throttle that the speed error asks for, -1 to 1, as fast as the throttle may change."""
    dt = memory[DT]
    change = clamp(memory[SPEED] - memory[DESIRED_SPEED], memory[SPEED_ACCELERATION] * dt)
    memory[DESIRED_SPEED] += change
    is_limited = memory[IS_THROTTLE_LIMITED] > 0.0
    order = _pid_output(memory, HEAD + PID_SIZE, memory[DESIRED_SPEED], x[int(memory[U])], dt, is_limited)
    order += memory[DESIRED_SPEED] * memory[CRUISE_THROTTLE] / memory[CRUISE_SPEED]
    is_reverse = memory[HAS_REVERSE] == 0.0 and order <= 0.0 and memory[DESIRED_SPEED] >= 0.0
    order = 0.0 if is_reverse else order
    last, bounded = memory[THROTTLE_OUT], clamp(order, 1.0)
    slewed = last + clamp(bounded - last, SLEW_RATE * dt)
    memory[IS_THROTTLE_LIMITED] = 1.0 if is_reverse or abs(order) >= 1.0 or slewed != bounded else 0.0
    return slewed


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def ardupilot(_, x, memory, u):
    """Apply what the last loop ordered, and order for the next."""
    _apply(memory, u)
    steering = _steering_order(x, memory)
    throttle = _throttle_order(x, memory) if memory[THROTTLE] >= 0.0 else 0.0
    memory[IS_STEERING_LIMITED] = 1.0 if abs(steering) >= 1.0 else 0.0
    if memory[IS_SKID] > 0.0:
        total = abs(throttle) + abs(steering)
        if total > 1.0:  # steering and throttle give way alike, MOT_STR_THR_MIX of 0.5
            steering /= total
            throttle = math.copysign(1.0 - abs(steering), throttle)
            memory[IS_STEERING_LIMITED] = 1.0
            memory[IS_THROTTLE_LIMITED] = 1.0
    else:
        base, speed = memory[SCALING_SPEED], memory[CRUISE_SPEED]
        if memory[U] >= 0.0:
            sway = x[int(memory[V])] if memory[V] >= 0.0 else 0.0
            speed = math.hypot(x[int(memory[U])], sway)
        if speed > base:
            steering *= base / speed
        else:
            memory[IS_STEERING_LIMITED] = 1.0
    memory[STEERING_OUT] = steering
    memory[THROTTLE_OUT] = throttle
