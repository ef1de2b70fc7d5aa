"""Write the two logs of docs/tutorials/usv.md: a simulated craft with two thrusters, as its autopilot would log it.

    python benchmarks/usv_logs.py FOLDER

Straight runs, spins and steps of both thrusters at 10 Hz; sensor noise and truth are those of
benchmarks/thrusters_truth.py.
"""

import sys
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.physics.simulate.replay import replay
from seatrial.problems.thruster_craft import CRAFTS, DT, NOISE, noisy

LOGS = {
    "afternoon_1": [(0.0, 0.0, 5), (0.4, 0.4, 12), (0.9, 0.9, 12), (-0.6, -0.6, 8), (0.0, 0.0, 4), (0.6, -0.6, 12),
                    (-0.8, 0.8, 12), (0.0, 0.0, 4), (0.8, 0.3, 8), (0.3, 0.8, 10), (0.8, 0.3, 10), (-0.9, -0.5, 6),
                    (0.2, 0.9, 8), (0.0, 0.0, 5)],
    "afternoon_2": [(0.0, 0.0, 5), (0.7, 0.7, 12), (0.7, 0.2, 8), (0.2, 0.7, 8), (-0.7, -0.7, 6), (0.0, 0.0, 4),
                    (0.5, -0.7, 10), (0.9, 0.6, 10), (0.0, 0.0, 5)],
}  # fmt: skip
"""Log -> port and starboard, shares of full command, and for how long [s]."""
STEADIER = {"M_v": 1.3, "N_r": -0.3, "N_ur": -0.5, "Y_uv": -1.2}
"""Coefficients with which the craft keeps its course by itself; the others are those of the truth; chosen."""
ZERO_US, SPAN_US = 1500.0, 400.0
"""Pulse at rest and from there to full ahead [us]: the usual ones of hobby electronics."""
COLUMNS = "time_ms,x_ned,y_ned,yaw,surge,sway,yaw_rate,thr_left,thr_right"


def commands(steps: list[tuple[float, float, int]]) -> Array:
    """Return both commands at every sample, (rows, 2)."""
    return np.concatenate([np.tile(step[:2], (round(step[2] / DT), 1)) for step in steps])


def log(name: str, rng: np.random.Generator) -> Array:
    """Return the rows of a log in the units of its columns."""
    model, orders = CRAFTS["two-fixed"].truth.with_values(STEADIER), commands(LOGS[name])
    inputs = {"command_1": orders[:, 0], "command_2": orders[:, 1]}
    planned = Record.from_arrays(name, DT * np.arange(len(orders)), inputs)
    simulated = replay(model.with_held(model.input_names), planned, dict.fromkeys(model.states, 0.0))
    run = noisy(Record.from_arrays(name, simulated.time, {c: simulated[c] for c in NOISE}), rng)
    yaw = np.degrees(np.mod(run["psi"], 2.0 * np.pi))
    pulses = ZERO_US + SPAN_US * orders
    return np.column_stack([
        1000.0 * run.time, run["x0"], run["y0"], yaw, run["u"], run["v"], run["r"], pulses,
    ])  # fmt: skip


def main() -> None:
    """Write the logs into the folder."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for k, name in enumerate(LOGS):
        rows = log(name, np.random.default_rng([18, k]))
        formats = ["%.0f", "%.2f", "%.2f", "%.1f", "%.3f", "%.3f", "%.4f", "%.0f", "%.0f"]
        np.savetxt(folder / f"{name}.csv", rows, formats, ",", header=COLUMNS, comments="")


if __name__ == "__main__":
    main()
