"""The last row: an autopilot tuned on each method's coefficients and simulated on the true craft."""

import math
from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Table
from seatrial.core.values import Array
from seatrial.data.example_series import JET_VELOCITY
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
    """The craft under the controller, by the classical Runge-Kutta method, the nozzle held over each step."""
    rates, values = craft.compiled.rates, craft.parameters.values
    place = {s: craft.states.index(s) for s in ("u", "r", "psi")}
    x = np.zeros(len(craft.states))
    x[place["u"]] = APPROACH_SPEED
    stages = np.empty((4, len(x)))
    errors, nozzles = [], []
    for _ in range(round(DURATION / STEP)):
        error = TURN - x[place["psi"]]
        # positive nozzle angles of the model turn to port: its sign is turned here, so that KP > 0 closes the loop
        delta = -float(np.clip(gains[0] * error - gains[1] * x[place["r"]], -NOZZLE_LIMIT, NOZZLE_LIMIT))
        inputs = np.array([delta, JET_VELOCITY])
        for k, share in enumerate((0.0, 0.5, 0.5, 1.0)):
            rates(0.0, x + share * STEP * stages[k - 1] if k else x, inputs, values, stages[k])
        x = x + STEP / 6.0 * (stages[0] + 2.0 * stages[1] + 2.0 * stages[2] + stages[3])
        if not np.all(np.isfinite(x)) or abs(x[place["u"]]) > 100.0 * APPROACH_SPEED:
            return ControlledMotion(np.inf, np.inf)
        errors.append(error)
        nozzles.append(delta)
    output, actuator = (math.degrees(math.sqrt(float(np.mean(np.square(y))))) for y in (errors, nozzles))
    return ControlledMotion(output, actuator)


def heading_controller_costs(crafts: Mapping[str, Model]) -> tuple[ControllerCost, ...]:
    """Return what controllers tuned on these crafts cost on the true one."""
    return controller_costs(crafts, TRUTH.craft(), heading_task())


def heading_controller_table(costs: tuple[ControllerCost, ...]) -> Table:
    """Return the last table of the page."""
    return controller_cost_table(TITLE, {"30° to starboard": costs}, _LABELS, _NOTE)
