"""
Gains for the sea at hand
=========================

On board nobody knows the sea, and the craft is not quite the model. Twenty minutes of roll and fin angle give both,
with intervals, and the gains of the schedule that suit them. :doc:`seatrial follow </follow>` does this while a stream
comes in; nothing sets the gains.
"""

import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.control.proposals import Stretch, look
from seatrial.control.schedule import gain_schedule, schedule
from seatrial.control.simulation import closed_loop, disturbance_series
from seatrial.control.task import ScheduleGrid, SimulationSettings
from seatrial.physics.sea import jonswap
from seatrial.physics.simulate.closed_loop import ActuatorLimits

# %%
# The loop, and a schedule of it over heading and wave height at 18 kn. On board this is the ``gains.toml`` that
# ``seatrial tune`` wrote.

task = st.load_loop("../../examples/fin_stabiliser.toml")
grid = ScheduleGrid((task.U,), tuple(np.radians([30.0, 90.0, 150.0]).tolist()), (1.0, 2.5, 4.5))
gains = gain_schedule(schedule(task, grid, {}, 1, lambda _: None).points, task.loop.gains.names)

# %%
# The truth that the record hides: bow seas of 2.4 m, and fins that do four fifths of what the model says. The published
# gains are on, limits of angle and rate and the sensor's noise included.

height, period, heading = 2.4, 8.5, math.radians(120.0)
true = replace(task.loop, plant=task.loop.plant.scaled(0.8))
on = np.array([11.053, 0.428, 32.736])
step, every = 0.02, 30
sea = replace(task.disturbances[0], spectrum=jonswap(height, period, 2.0), beta=heading)
(waves,) = disturbance_series(sea, SimulationSettings(1, 1200.0, step), 3)[0]
ship = closed_loop(replace(task, loop=true), true, on, task.U, step)
states, fins = ship.run(waves, ActuatorLimits(task.constraints.limit, task.constraints.rate))
roll = states[::every, ship.model.states.index("phi")]
roll = roll + np.random.default_rng(4).normal(0.0, 1e-3, roll.size)

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
seconds = step * every * np.arange(roll.size)
axes.plot(seconds[:300], np.degrees(roll[:300]), label="roll")
axes.plot(seconds[:300], np.degrees(fins[::every][:300]), label="fins")
axes.set(xlabel="time [s]", ylabel="angle [deg]")
axes.legend()

# %%
# What the stretch shows: the sea, the craft, and the gains that fit both.

proposal = look(task, gains, Stretch(0.0, step * every, np.column_stack([roll, fins[::every]]), task.U))
sea = proposal.sea
print(f"height {sea.height.value:.2f} m [{sea.height.lower:.2f}, {sea.height.upper:.2f}], truth {height:.2f}")
print(f"peak period {sea.period.value:.2f} s [{sea.period.lower:.2f}, {sea.period.upper:.2f}], truth {period:.2f}")
for one in sea.headings:
    low, high, share = math.degrees(one.lower), math.degrees(one.upper), 100.0 * one.probability
    print(f"heading {low:.0f} to {high:.0f} deg ({share:.0f} %), truth {math.degrees(heading):.0f}")
for one in proposal.craft:
    print(f"{one.name} {one.factor.value:.2f} [{one.factor.lower:.2f}, {one.factor.upper:.2f}] of the model's")

# %%
# The gains, and why these:

print({name: round(value, 3) for name, value in proposal.gains.items()})
print("\n".join(proposal.reasons))

# %%
# Half of the stretch is too short, and the reason takes the place of the gains:

print(look(task, gains, Stretch(0.0, step * every, np.column_stack([roll, fins[::every]])[:900], task.U)).reasons[0])
