"""The last row: an autopilot tuned on each method's coefficients and simulated on the true craft."""

import math
from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Table
from seatrial.core.values import Array
from seatrial.data.example_series import JET_VELOCITY
from seatrial.physics.simulate import HeadingStep
from seatrial_studies.controller_cost import (
    ControlLabels,
    ControlledMotion,
    ControllerCost,
    ControlTask,
    controller_cost_table,
    controller_costs,
)
from seatrial_studies.song2025.craft_models import TRUTH
from seatrial_studies.song2025.published import APPROACH_SPEED

TITLE = "What wrong coefficients cost a controller"
TURN = math.radians(30.0)  # change of heading to be followed, our choice
DURATION, STEP = 120.0, 0.25  # s; long enough for the turn, and a step well below the craft's time constants
NOZZLE_LIMIT = math.radians(35.0)  # the largest nozzle angle of the paper's manoeuvres
NOZZLE_WEIGHT = 0.3  # rad of heading error that count as much as a radian of nozzle; our choice
START_GAINS = np.array([1.0, 3.0])  # KP [rad/rad], KD [s]: where the tuning starts; our choice
NOZZLE = "delta"
_STEP = HeadingStep(TURN, NOZZLE_LIMIT, NOZZLE, DURATION, STEP)
_RUNAWAY = 100.0  # approach speeds beyond which a motion has run away; our choice
_LABELS = ControlLabels(("KP", "KD, s"), "heading error rms, deg", "nozzle rms, deg")
_NOTE = (
    f"A change of heading by {math.degrees(TURN):.0f}° at 0.8 m/s, nozzle = KP error - KD r up to 35°, "
    f"{DURATION:.0f} s, "
    f"tuned by simulation of the craft that the coefficients describe for least heading variance plus "
    f"{NOZZLE_WEIGHT:g}² "
    "nozzle variance; then simulated on the true craft. 'Predicted': on the craft that the coefficients describe. "
    "'Cost "
    "over best': the sum that was to be least, on the true craft, over that of the controller tuned on the truth."
)


def heading_task() -> ControlTask[Model]:
    """Return the task: follow a step of heading without moving the nozzle more than needed."""

    def simulate(craft: Model, gains: Array) -> ControlledMotion:
        return _turn(craft, gains)

    return ControlTask(simulate, START_GAINS, NOZZLE_WEIGHT)


def _turn(craft: Model, gains: Array) -> ControlledMotion:
    """The craft under the controller."""
    start = np.zeros(len(craft.states))
    start[craft.states.index("u")] = APPROACH_SPEED
    motion = _STEP.simulate(craft, gains, start, np.array([0.0, JET_VELOCITY]))
    if motion is None or np.max(np.abs(motion[0][:, craft.states.index("u")])) > _RUNAWAY * APPROACH_SPEED:
        return ControlledMotion(np.inf, np.inf)
    states, inputs = motion
    output, actuator = (
        math.degrees(math.sqrt(float(np.mean(y**2))))
        for y in (TURN - states[:, craft.states.index("psi")], inputs[:, craft.input_names.index(NOZZLE)])
    )
    return ControlledMotion(output, actuator)


def heading_controller_costs(crafts: Mapping[str, Model]) -> tuple[ControllerCost, ...]:
    """Return what controllers tuned on these crafts cost on the true one."""
    return controller_costs(crafts, TRUTH.craft(), heading_task())


def heading_controller_table(costs: tuple[ControllerCost, ...]) -> Table:
    """Return the last table of the page."""
    return controller_cost_table(TITLE, {"30° to starboard": costs}, _LABELS, _NOTE)
