"""
Did the fins do what was promised?
==================================

After the trial of a tuned stabiliser: legs with the fins on and off, what was predicted beside what was achieved, and
what in the model was wrong.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.control.simulation import closed_loop, disturbance_series
from seatrial.control.task import SimulationSettings
from seatrial.physics.sea import jonswap
from seatrial.physics.simulate.closed_loop import ActuatorLimits

# %%
# The loop as it was tuned, and the gains that were on:

task = st.load_loop("../../examples/fin_stabiliser.toml")
gains = {"KP": 11.053, "KI": 0.428, "KD": 32.736}

# %%
# A log to verify: four legs of twenty minutes, by a ship whose fins do six tenths of what the model says. At sea this
# is a trial file of the logger's files, ``st.verify(task, "results/fins/gains.toml", ["log.toml"])``.

true = replace(task.loop, plant=task.loop.plant.scaled(0.6))
limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
step, every = 0.02, 10


def leg(name: str, height: float, is_on: bool, seed: int) -> st.Record:
    """Return roll and fin angle of one leg in a sea of that height."""
    sea = replace(task.disturbances[0], spectrum=jonswap(height, 8.0, 2.0))
    (waves,) = disturbance_series(sea, SimulationSettings(1, 1200.0, step), seed)[0]
    values = np.array(list(gains.values())) if is_on else np.zeros(3)
    ship = closed_loop(replace(task, loop=true), true, values, task.U, step)
    states, fins = ship.run(waves, limits)
    roll = states[::every, ship.model.states.index("phi")]
    roll += np.random.default_rng(seed).normal(0.0, 1e-3, roll.size)
    time = step * every * np.arange(roll.size)
    return st.Record.from_arrays(name, time, {"phi": roll, "alpha_f": fins[::every]})


log = [leg("off 1", 1.8, False, 1), leg("on 1", 1.9, True, 2), leg("off 2", 1.9, False, 3), leg("on 2", 1.7, True, 4)]

# %%
# Predicted beside achieved, inside or outside:

verification = st.verify(task, gains, log)
verification.summary()

# %%
# The reduction by each way to account for the sea:

for estimate in verification.reductions:
    low, high = 100.0 * estimate.lower, 100.0 * estimate.upper
    print(f"{estimate.method}: {100.0 * estimate.value:.1f} % [{low:.1f}, {high:.1f}]")

# %%
# What in the model was wrong, before the log and with it:

for correction in verification.corrections:
    state = "moved" if correction.is_moved else "held"
    print(f"{correction.name}: {correction.model:.3g} -> {correction.log:.3g} "
          f"[{correction.lower:.3g}, {correction.upper:.3g}], {state}")  # fmt: skip

# %%
# A leg's spectrum, logged and by the model as it was in the sea that explains the leg:

shown = verification.legs[1]
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(shown.omega, np.degrees(1.0) ** 2 * shown.measured, "o", label="as logged")
axes.plot(shown.omega, np.degrees(1.0) ** 2 * shown.predicted, label="by the model as it was")
axes.set(xlabel="frequency of encounter [rad/s]", ylabel="roll [deg² s/rad]")
axes.legend()
