"""A craft as ArduPilot steers it: shares of full steering and throttle in, heading, yaw rate and speed out."""

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.ship.trimmed_ship import plant_and_disturbance, trim_ship
from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.loops import Block
from seatrial.physics.models.thrust_orders import AHEAD, YAW, with_orders, work_shares
from seatrial.physics.models.thruster_layout import ThrusterLayout
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT, trajectory
from seatrial.physics.simulate.thrust import DEFAULT_AHEAD

RUDDER = "delta"
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
    if model.equations.layout:
        return _unsuitable_thrusters(ThrusterLayout.from_text(model.equations.layout))
    return "" if RUDDER in model.input_names else f"it has no input '{RUDDER}' and no thrusters that could steer it"


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
    is_skid, model = bool(file.model.equations.layout), file.model
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
    throttle = throttle if trim > 0.0 and "u" in model.states else ""
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
    if "u" in model.states:
        return float(ship.state[model.states.index("u")])
    design_speed = model.parameters["U"].value if "U" in model.parameters else math.nan
    speed = design_speed if design_speed > 0.0 else file.approach.get("u", math.nan)
    if not speed > 0.0:
        raise InputError(
            f"model '{model.name}' does not state the speed of its trials, which ArduPilot's steering needs; add u to "
            "[approach] of the model file"
        )
    return float(speed)
