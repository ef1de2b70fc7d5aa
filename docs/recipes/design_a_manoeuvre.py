"""
Which manoeuvre to run next
===========================

Before a trial: the orders that determine the coefficients best within the time, the rudder's range and the sea room,
next to what a zigzag and a turning circle would give.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st

# %%
# No record is needed: the ship as assumed, the sensors' noise, and limits.

trial_file = Path("plan.toml")
trial_file.write_text("""
[ship]
name = "craft"
L = 8.0

[model]
name = "nomoto"
start = { K = 0.15, T = 8.0, U = 2.0 }

[noise]
psi = { sd = 0.5, unit = "deg" }
r = { sd = 0.2, unit = "deg/s" }

[design]
duration = 60
draws = 4
rate = 2
sea_room = 150

[design.inputs.delta]
lower = -25
upper = 25
unit = "deg"
rate = 5
hold = 5
""")
design = st.design(trial_file)

# %%
design.summary()

# %%
# The orders, as the helmsman gets them, and the plan as a record:

for order in design.orders:
    print(f"{order.time:5.1f} s: rudder {np.degrees(order.values['delta']):6.1f} deg")

# %%
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(design.plan.time, np.degrees(design.plan["delta"]))
axes.set(xlabel="time [s]", ylabel="rudder [deg]")
trial_file.unlink()
