"""Speed of one simulation, of a simulation with all its sensitivities, and of starting up."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most, fastest

from seatrial.core.equations import Model
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.batch import SegmentBatch

STEPS = 20_000
DT = 0.1


def without_pose(model: Model) -> Model:
    """The same dynamics alone: surge, sway and yaw, which know neither heading nor place."""
    equations = replace(model.equations, name=f"{model.name}_dynamics", rates=model.equations.rates[:3])
    return replace(model, equations=equations)


def batch(model: Model, *, sensitivities: bool) -> SegmentBatch:
    """A run of alternating nozzle angles; 17 columns: coefficients, initial states, added masses for the rest."""
    time = np.arange(STEPS) * DT
    inputs = np.stack([np.radians(20.0) * np.sign(np.sin(0.1 * time)), np.full(STEPS, 1.866)], axis=1)
    starts = model.states if sensitivities else ()
    extra = ("m_x", "m_y", "J_z")[: 17 - len(COEFFICIENTS) - len(starts)]
    parameters = (*COEFFICIENTS, *extra) if sensitivities else ()
    return SegmentBatch(model, inputs, np.array([0, STEPS]), DT, model.states, parameters, (), starts)


def run() -> list[Line]:
    """Steps a second, sensitivities as a ratio, start-up."""
    lines = []
    for model, label, limit in ((without_pose(waterjet()), "3 dynamic states", 7.0), (waterjet(), "with pose", 10.0)):
        start = np.array([[0.8, *np.zeros(len(model.states) - 1)]])
        arguments = (0, 1, start, model.parameters.values[None], np.empty((1, 0)))
        plain, tangent = batch(model, sensitivities=False), batch(model, sensitivities=True)
        simulated = fastest(lambda: plain.simulate(*arguments))  # noqa: B023
        differentiated = fastest(lambda: tangent.differentiate(*arguments))  # noqa: B023
        rate = STEPS / simulated / 1e6
        what = f"waterjet, {label}: Runge-Kutta steps"
        lines.append(at_least(what, rate, "M/s", 6.0) if limit == 7.0 else Line(what, rate, "M/s"))
        what = f"waterjet, {label}: trajectory and {tangent.column_count} sensitivities"
        lines.append(at_most(what, differentiated / simulated, "simulations", limit))
    command = [Path(sys.executable).with_name("seatrial"), "--help"]
    started = fastest(lambda: subprocess.run(command, capture_output=True, check=True))
    return [*lines, at_most("seatrial --help", started, "s", 0.3)]
