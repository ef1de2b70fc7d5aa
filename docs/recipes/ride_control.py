"""
Less sickness by a fin aft
==========================

Heave and pitch of a ship are known, and a fin aft. Which gains make fewest people sick at the forward seats, and what
do they do to everybody else along the ship?
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.control import gain_evaluator
from seatrial.data.folder.model_file import ModelFile, write_model

# %%
# The ship of Qi et al. 2025, as `identify` would have written it, with a fin 25 m aft of midship.

known = st.models.parameter_set("qi2025-135")
model = known.applied_to(st.models.heave_pitch()).with_values({"lift_1": 791060.0, "x_f1": -25.0})
folder = Path(tempfile.mkdtemp())
write_model(ModelFile(model, ship=known.ship), folder / "model.toml")

# %%
# The loop: pitch is fed back to the fin; what is to be small is the share of people sick within two hours 20 m forward.

forward = '{ name = "motion_sickness", x = 20 }'
text = """
minimise = [{ name = "motion_sickness", x = 20 }, "actuator_rate"]
[plant]
model = "model.toml"
output = "theta"
actuator = "delta_f1"
speed = { value = 18, unit = "kn" }
[controller]
kind = "pid"
parts = ["KP", "KD"]
[actuator]
limit = { value = 20, unit = "deg" }
rate = { value = 30, unit = "deg/s" }
servo = [{ num = [225.0], den = [1.0, 21.0, 225.0] }]
[excitation]
source = "box"
[[seas]]
spectrum = "ittc"
height = 1.5
heading = { value = 135, unit = "deg" }
[simulation]
seeds = 4
duration = 300
"""
(folder / "loop.toml").write_text(text)
tuning = st.tune(st.load_loop(folder / "loop.toml"))
tuning.summary()

# %%
# The same gains at every seat: each place is an objective of its own.

places = np.linspace(-30.0, 30.0, 13)
everywhere = ", ".join(f'{{ name = "motion_sickness", x = {x} }}' for x in places)
(folder / "seats.toml").write_text(text.replace(forward, everywhere))
seats = gain_evaluator(st.load_loop(folder / "seats.toml"))
both = np.array([[0.0, 0.0], [*tuning.chosen.gains.values()]])
shares = 100.0 * seats.objective_values(both)[:, :-1]

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(places, shares[0], label="fin at rest")
axes.plot(places, shares[1], label="chosen gains")
axes.set(xlabel="forward of midship [m]", ylabel="sick within two hours [%]", ylim=(0.0, None))
axes.legend()
