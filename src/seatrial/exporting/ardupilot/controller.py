"""ArduPilot's heading and speed control of boats on an identified craft, loop by loop."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from seatrial.control.ship import plant_and_disturbance, trim_ship
from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.equations.model import RUDDER, ZERO_BY_DEFAULT
from seatrial.core.values import Array, InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.numerics.kernels.feedback import clamp, steer
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel
from seatrial.physics.loops import Block
from seatrial.physics.models.thrust_orders import AHEAD, YAW, with_orders, work_shares
from seatrial.physics.models.thruster_layout import ThrusterLayout, layout_of
from seatrial.physics.simulate.replay import trajectory
from seatrial.physics.simulate.thrust import DEFAULT_AHEAD

# A craft as ArduPilot steers it: shares of full steering and throttle in, heading, yaw rate and speed out.

FULL_RUDDER = math.radians(35.0)  # SOLAS, chapter II-1, regulation 29.3.2
CRUISE_SHARE = 0.5  # of full throttle at the approach speed, ArduPilot's default of CRUISE_THROTTLE
SCALING_SHARE = 0.8
"""MOT_SPD_SCA_BASE over the cruising speed. Above it steering is scaled by its inverse over the speed, below it the
integral of ArduPilot's regular boats only shrinks (AP_MotorsUGV.cpp, output_regular); chosen."""
REFERENCE_STEERING = 0.7  # of what reaches the rudder at cruising speed: the turn that the feed-forward is for; chosen
_TURNING_TIME = 20.0  # over the mean time constant of the plant: until the yaw rate has reached its peak; chosen


@dataclass(frozen=True, eq=False)
class SteeredCraft:
    """A trimmed craft and what full steering and full throttle are of its inputs.

    Attributes:
        ship: trimmed on a straight course at the cruising speed; of a craft with thrusters the model driven by orders.
        speed: m/s.
        is_skid: steered by throttles to port and starboard, else by a rudder or a nozzle.
        full_steering: change of the steering input from its trim at steering 1, to starboard, in the model's sign.
        steering_rate: largest rate of the input over full steering [1/s]; infinite without a limit.
        throttle: name of the input; empty where the model has none, or several.
        full_throttle: of that input at throttle 1.
    """

    ship: TrimmedShip
    speed: float
    is_skid: bool
    full_steering: float
    steering_rate: float
    throttle: str
    full_throttle: float

    @property
    def model(self) -> Model:
        """The model."""
        return self.ship.model

    @property
    def scaling_speed(self) -> float:
        """MOT_SPD_SCA_BASE [m/s]; it has no effect on skid steering."""
        return 0.0 if self.is_skid else SCALING_SHARE * self.speed

    @property
    def available_steering(self) -> float:
        """Share of full steering that reaches the rudder at cruising speed."""
        return 1.0 if self.is_skid else SCALING_SHARE

    @property
    def trim_throttle(self) -> float:
        """Throttle at cruising speed, 0 to 1."""
        return float(self.ship.inputs[self.model.input_names.index(self.throttle)]) / self.full_throttle

    @property
    def cruise_throttle(self) -> float:
        """CRUISE_THROTTLE, the same in whole per cent, 0 to 1."""
        return round(100.0 * self.trim_throttle) / 100.0

    @property
    def heading_plant(self) -> Block:
        """From steering, -1 to 1, to the heading [rad], at cruising speed."""
        sign = -1.0 if self.model.inputs[self.model.input_names.index(self.ship.actuator)].is_reversed else 1.0
        return plant_and_disturbance(self.ship)[0].scaled(sign * self.full_steering * self.available_steering)

    @property
    def speed_plant(self) -> Block:
        """From throttle, -1 to 1, to the speed [m/s]."""
        ship = replace(self.ship, output="u", actuator=self.throttle, disturbance="")
        return plant_and_disturbance(ship)[0].scaled(self.full_throttle)


def unsuitable_for_ardupilot(file: ModelFile) -> str:
    """Return why ArduPilot's boat control has no place for a model; empty where it has one."""
    model = file.model
    absent = next((s for s in ("psi", "r") if s not in model.states), "")
    if absent:
        return f"it has no state '{absent}', and ArduPilot steers a boat by heading and yaw rate"
    if model.has_thrusters:
        return _unsuitable_thrusters(layout_of(model))
    return "" if model.has_rudder else f"it has no input '{RUDDER}' and no thrusters that could steer it"


def _unsuitable_thrusters(layout: ThrusterLayout) -> str:
    if layout.has_rudders:
        return "it is steered by rudders and by thrust at once, and ArduPilot's mixers know one or the other"
    for thruster, share in zip(layout.thrusters, work_shares(layout), strict=True):
        if share.ahead != 1.0 or share.yaw == 0.0:
            return (
                f"thruster '{thruster.name}' is neither a throttle to port nor one to starboard, the two that "
                "ArduPilot's skid steering has"
            )
    return ""


def steered_craft(file: ModelFile) -> SteeredCraft:
    """Return the craft of a model file at its approach; a craft with thrusters at half throttle, or at
    the fastest of its trials where that is slower.

    A rudder has 35 degrees to either side and the rate that the model file's manoeuvres are steered with. Full throttle
    of other craft than those with thrusters is twice the propulsion of the approach.

    Raises:
        InputError: the craft has no steady straight run, no known speed, or does not answer its steering.
    """
    is_skid, model = file.model.has_thrusters, file.model
    if is_skid:
        model = with_orders(model)
        approach = {n: v for n, v in file.approach.items() if n in model.input_names}
        file = replace(file, model=model, approach=approach)
    steering = YAW if is_skid else RUDDER
    orders = {AHEAD: DEFAULT_AHEAD, YAW: 0.0} if is_skid else None
    ship = trim_ship(file, output="psi", actuator=steering, inputs=orders)
    fastest = (
        math.inf if file.interval_basis is None else file.interval_basis.training_envelope.get("fastest", math.inf)
    )
    if is_skid and _cruising_speed(file, ship) > fastest:
        ship = trim_ship(file, output="psi", actuator=steering, speed=fastest, inputs={YAW: 0.0})
    throttle = AHEAD if is_skid else _throttle_input(model)
    trim = 0.0 if not throttle else float(ship.inputs[model.input_names.index(throttle)])
    throttle = throttle if trim > 0.0 and model.has_speed else ""
    sign = -1.0 if model.inputs[model.input_names.index(steering)].is_reversed else 1.0
    towards = sign * math.copysign(1.0, plant_and_disturbance(ship)[0].num[0])
    return SteeredCraft(
        ship=ship,
        speed=_cruising_speed(file, ship),
        is_skid=is_skid,
        full_steering=towards * (1.0 if is_skid else FULL_RUDDER),
        steering_rate=math.inf if is_skid else file.rudder_rate.value / FULL_RUDDER,
        throttle=throttle,
        full_throttle=1.0 if is_skid else trim / CRUISE_SHARE,
    )


def turning_rates(craft: SteeredCraft, time_constant: float) -> tuple[float, float]:
    """Return the largest yaw rate [rad/s] and the largest yaw acceleration [rad/s^2] of the turn for the feed-forward.

    time_constant: s, mean of the plant's.
    """
    dt, place = time_constant / 100.0, craft.model.states.index("r")  # s, a hundredth of it; chosen
    steered = craft.ship.inputs.copy()
    share = REFERENCE_STEERING * craft.available_steering
    steered[craft.model.input_names.index(craft.ship.actuator)] += share * craft.full_steering
    count = int(_TURNING_TIME * time_constant / dt)
    states, _ = trajectory(craft.model, np.tile(steered, (count + 1, 1)), dt, craft.ship.state)
    rate = np.abs(states[:, place])
    return float(np.nanmax(rate)), float(np.nanmax(np.diff(rate)) / dt)


def _throttle_input(model: Model) -> str:
    drives = [n for n in model.input_names if n != RUDDER and n not in (*ZERO_BY_DEFAULT, "u")]
    return drives[0] if len(drives) == 1 else ""


def _cruising_speed(file: ModelFile, ship: TrimmedShip) -> float:
    model = ship.model
    if model.has_speed:
        return float(ship.state[model.states.index("u")])
    design_speed = model.parameters.value_of("U", math.nan)
    speed = design_speed if design_speed > 0.0 else file.approach.get("u", math.nan)
    if not speed > 0.0:
        raise InputError(
            f"model '{model.name}' does not state the speed of its trials, which ArduPilot's steering needs; add u to "
            "[approach] of the model file"
        )
    return float(speed)


# Gains of ArduPilot's heading and speed control, and the same as a PID on the heading error.


@dataclass(frozen=True)
class PidGains:
    """An AC_PID: gains on the error, feed-forward of the target, and its three filters.

    Attributes:
        P, I, D, FF: per unit of error (rad/s or m/s); I per second, D times seconds.
        integral_limit: of the integral's part of the output.
        target_filter, error_filter, derivative_filter: cut-off frequencies [Hz]; 0: no filter.
    """

    P: float
    I: float  # noqa: E741
    D: float = 0.0
    FF: float = 0.0
    integral_limit: float = 1.0
    target_filter: float = 0.0
    error_filter: float = 0.0
    derivative_filter: float = 0.0


@dataclass(frozen=True)
class CascadeGains:
    """The yaw rate wanted for each radian of heading error [1/s], 0 without a cascade, and what brings it about."""

    angle_P: float
    rate: PidGains


def cascade_from_pid(gains: Mapping[str, float], feed_forward: float, error_filter: float) -> CascadeGains:
    """Return the cascade that equals a PID with gains KP, KI, KD on the heading error, before its filters.

    With r = d(psi)/dt the cascade's output (P + FF) A e - P r + I (A int(e) - psi) has KP = (P + FF) A + I, KI = I A
    and KD = P; A is the larger root of (KD + FF) A^2 - KP A + KI = 0. Where no root is real the feed-forward gives way.

    Raises:
        InputError: the heading error has no gain, KD is negative, or no cascade equals the PID.
    """
    KP, KI, KD = (float(gains.get(name, 0.0)) for name in ("KP", "KI", "KD"))
    if not (KP > 0.0 and KI >= 0.0 and KD >= 0.0):
        raise InputError(f"a cascade needs KP > 0, KI >= 0 and KD >= 0, not {KP:.4g}, {KI:.4g} and {KD:.4g}")
    most = math.inf if KI == 0.0 else KP**2 / (4.0 * KI) - KD
    FF = min(feed_forward, most)
    if not (FF >= 0.0 and KD + FF > 0.0):
        raise InputError(
            f"no yaw-rate cascade equals KP {KP:.4g}, KI {KI:.4g}, KD {KD:.4g}: it needs KP^2 > 4 KD KI; tune with "
            "less KI"
        )
    A = (KP + math.sqrt(max(KP**2 - 4.0 * (KD + FF) * KI, 0.0))) / (2.0 * (KD + FF))
    return CascadeGains(A, PidGains(KD, KI / A, FF=FF, error_filter=error_filter))


def filter_share(frequency: float, dt: float) -> float:
    """Return the share of the way that a filter goes in a sample: dt / (dt + 1 / (2 pi f)), 1 for 0 Hz.

    AP_Math.cpp, calc_lowpass_alpha_dt.
    """
    return 1.0 if frequency == 0.0 else dt / (dt + 1.0 / (2.0 * math.pi * frequency))


# ArduPilot's heading and speed control of boats, loop by loop, before any model.

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
