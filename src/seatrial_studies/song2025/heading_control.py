"""The last row: an autopilot tuned on each method's coefficients and simulated on the true craft."""

import math
from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Table
from seatrial.core.values import Array
from seatrial.data.example_series import JET_VELOCITY
from seatrial.numerics.kernels.feedback import clamp, steer
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS
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
_INPUTS = np.array([0.0, JET_VELOCITY])  # nozzle amidships [rad], jet velocity [m/s]
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
    """The craft under the controller, the nozzle held over each step."""
    speed, heading, rate = (craft.states.index(s) for s in ("u", "psi", "r"))
    start = np.zeros(len(craft.states))
    start[speed] = APPROACH_SPEED
    steps = round(DURATION / STEP)
    states, inputs = np.empty((steps, len(start))), np.empty((steps, len(_INPUTS)))
    memory = np.array([*gains, float(heading), float(rate)])
    diverged = steer(
        craft.compiled.rates, _order, start, _INPUTS, craft.parameters.values, memory, STEP, states, inputs
    )
    if diverged >= 0 or np.max(np.abs(states[:, speed])) > _RUNAWAY * APPROACH_SPEED:
        return ControlledMotion(np.inf, np.inf)
    output, actuator = (
        math.degrees(math.sqrt(float(np.mean(y**2)))) for y in (TURN - states[:, heading], inputs[:, 0])
    )
    return ControlledMotion(output, actuator)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _order(t, x, memory, u):
    """Nozzle angle KP error - KD r within its limit; memory: KP, KD, places of heading and rate.

    Positive nozzle angles of the model turn to port: the sign is turned here, so that KP > 0 closes the loop.
    """
    KP, KD, heading, rate = memory
    u[0] = -clamp(KP * (TURN - x[int(heading)]) - KD * x[int(rate)], NOZZLE_LIMIT)


def heading_controller_costs(crafts: Mapping[str, Model]) -> tuple[ControllerCost, ...]:
    """Return what controllers tuned on these crafts cost on the true one."""
    return controller_costs(crafts, TRUTH.craft(), heading_task())


def heading_controller_table(costs: tuple[ControllerCost, ...]) -> Table:
    """Return the last table of the page."""
    return controller_cost_table(TITLE, {"30° to starboard": costs}, _LABELS, _NOTE)
