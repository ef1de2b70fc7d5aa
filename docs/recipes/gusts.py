"""
Gusts that nobody recorded
==========================

A force with a memory, such as gusts of wind, biases an estimate that takes all residuals for sensor noise. The fit
finds it, names its memory, and widens the intervals to what is honest.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st

# %%
# A craft in gusts with a memory of 5 s: its rudder follows zigzag orders, and a yaw disturbance acts like two degrees
# of rudder.

K, T, step, memory = 0.15, 8.0, 0.1, 5.0
rng = np.random.default_rng(7)
count = 6000
time = step * np.arange(count)
delta = np.radians(10.0) * np.sign(np.sin(0.1 * time))
psi, r, gust = np.zeros((3, count))
for k in range(count - 1):
    kick = np.radians(2.0) * np.sqrt(2.0 * step / memory) * rng.standard_normal()
    gust[k + 1] = gust[k] * (1.0 - step / memory) + kick
    r[k + 1] = r[k] + step / T * (K * (0.5 * (delta[k] + delta[k + 1]) + gust[k]) - r[k])
    psi[k + 1] = psi[k] + 0.5 * step * (r[k] + r[k + 1])
noise = np.radians(0.1) * rng.standard_normal((2, count))
record = st.Record.from_arrays("zigzag", time, {"psi": psi + noise[0], "r": r + noise[1], "delta": delta})

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(time, np.degrees(delta), label="rudder")
axes.plot(time, np.degrees(gust), label="gust, as rudder")
axes.set(xlabel="time [s]", ylabel="angle [deg]")
axes.legend(loc="lower left")

# %%
# The fit:

trial = st.Trial(
    st.Ship("craft", {"L": 8.0}),
    (st.Run(record),),
    st.models.nomoto(),
    st.EstimateSettings(channels=("psi", "r")),
    truth={"K": K, "T": T},
)
fit = st.identify(trial)
fit.summary()

# %%
# What was tried and what was chosen:

print(fit.noise_model.text)

# %%
fit.plot()
