"""
Roll damping from a decay
=========================

A ship heeled and released: natural period, damping over the amplitude, and GM with what it assumes.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.physics.simulate import replay

# %%
# A decay from 17 degrees of a ship with linear and quadratic damping, sensor noise 0.02 degrees.

ship = st.models.roll().with_values({"b_1": 0.03, "b_2": 0.2, "c_1": 0.36, "c_3": -0.1})
time = 0.2 * np.arange(900)
released = st.Record.from_arrays("decay", time, {"phi": np.full(900, 0.3)})
phi = replay(ship, released, {"phi": 0.3, "p": 0.0})["phi"] + 3.5e-4 * np.random.default_rng(1).standard_normal(900)
decay = st.Record.from_arrays("decay", time, {"phi": phi})
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(time, np.degrees(phi))
axes.set(xlabel="time [s]", ylabel="roll angle [deg]")

# %%
# No guess is needed. The particulars give GM its inertia.

trial = st.Trial(
    st.Ship("barge", {"L": 60.0, "B": 12.0, "d": 3.0}),
    (st.Run(decay),),
    st.models.roll(),
    truth={"b_1": 0.03, "b_2": 0.2},
)
fit = st.identify(trial)
fit.summary()

# %%
# What the coefficients mean. Single damping coefficients stand in for one another, the curve they make does not.

roll = fit.roll
for name in ("natural_period", "metacentric_height"):
    value = getattr(roll, name)
    print(f"{name}: {value.value:.3f} [{value.lower:.3f}, {value.upper:.3f}]")
