"""Write twenty minutes of roll and fin angle, log.csv, of a ship whose fins do four fifths of what the model says."""

import math
from dataclasses import replace

import numpy as np

import seatrial as st
from seatrial.control.simulation import closed_loop, disturbance_series
from seatrial.control.task import SimulationSettings
from seatrial.physics.sea import jonswap
from seatrial.physics.simulate.closed_loop import ActuatorLimits

task, step, every = st.load_loop("examples/fin_stabiliser.toml"), 0.02, 25
sea = replace(task.disturbances[0], spectrum=jonswap(2.4, 8.5, 2.0), beta=math.radians(120.0))
(waves,) = disturbance_series(sea, SimulationSettings(1, 1210.0, step), 3)[0]
true = replace(task.loop, plant=task.loop.plant.scaled(0.8))
ship = closed_loop(replace(task, loop=true), true, np.array([11.053, 0.428, 32.736]), task.U, step)
states, fins = ship.run(waves, ActuatorLimits(task.constraints.limit, task.constraints.rate))
roll = states[::every, ship.model.states.index("phi")]
roll = roll + np.random.default_rng(4).normal(0.0, 1e-3, roll.size)
time = step * every * np.arange(roll.size)
rows = np.column_stack([time, np.degrees(roll), np.degrees(fins[::every])])
np.savetxt("log.csv", rows, "%.4f", ",", header="t,phi,fin", comments="")
