"""
A rudder zero that differs from day to day
==========================================

What a session has of its own is not the ship's: a zero of the rudder's indicator, a compass error. It is estimated
once a session, as a draw from a population.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.physics.simulate import replay

# %%
# Six zigzags on three days; the indicator's zero is -2, 1 and 3 degrees off.

craft = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
rng = np.random.default_rng(5)
time = np.arange(0.0, 120.0, 0.5)
runs = []
for day, zero in zip(("monday", "tuesday", "friday"), (-2.0, 1.0, 3.0), strict=True):
    for amplitude in (10.0, 20.0):
        rudder = np.radians(amplitude) * np.sign(np.sin(0.12 * time))
        true = replay(craft, st.Record.from_arrays("run", time, {"delta": rudder}), {"r": 0.0})
        noise = np.radians(0.1) * rng.standard_normal((2, time.size))
        measured = {"psi": true["psi"] + noise[0], "r": true["r"] + noise[1], "delta": rudder + np.radians(zero)}
        name = f"{day}_{amplitude:.0f}"
        runs.append(st.Run(st.Record.from_arrays(name, time, measured), session=day))

# %%
# ``offsets`` frees the zero for each session. In a trial file: ``offsets = ["delta"]`` under ``[estimate]``, and
# ``session = "day"`` under ``[[records]]``.

trial = st.Trial(
    st.Ship("craft", {"L": 8.0}),
    tuple(runs),
    st.models.nomoto(),
    st.EstimateSettings(offsets={"delta": None}, channels=("psi", "r")),
    truth={"K": 0.15, "T": 8.0},
)
fit = st.identify(trial)
fit.summary()

# %%
# The zeros, with their standard errors. What was added to the indicator is 2, -1 and -3 degrees, to take the error
# away.

days = [offset.group for offset in fit.offsets]
zeros, errors = np.degrees([(o.estimate, o.standard_error) for o in fit.offsets]).T
print(dict(zip(days, zeros.round(3), strict=True)))

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.errorbar(days, zeros, 1.96 * errors, fmt="o", capsize=4)
axes.set(ylabel="added to the indicator [deg]")
