"""
What changed between two days
=============================

Two fits, of two loadings, days or methods: which coefficients differ by more than chance, and what that means for a
turning circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.physics.simulate import replay

# %%
# The same craft laden and in ballast: in ballast it answers faster.


def trial(name: str, K: float, T: float, seed: int) -> st.Trial:
    """Return zigzags of a craft with noise of a compass and a gyro."""
    craft = st.models.nomoto().with_values({"K": K, "T": T, "U": 2.0})
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 240.0, 0.5)
    rudder = np.radians(20.0) * np.sign(np.sin(0.1 * time))
    run = replay(craft, st.Record.from_arrays(name, time, {"delta": rudder}), {"r": 0.0})
    noise = np.radians(0.2) * rng.standard_normal((2, time.size))
    record = st.Record.from_arrays(
        name, time, {"psi": run["psi"] + noise[0], "r": run["r"] + noise[1], "delta": rudder}
    )
    settings = st.EstimateSettings(channels=("psi", "r"))
    return st.Trial(st.Ship(name, {"L": 8.0}), (st.Run(record),), st.models.nomoto(), settings)


laden = st.identify(trial("laden", K=0.13, T=9.5, seed=1))
ballast = st.identify(trial("ballast", K=0.15, T=8.0, seed=2))

# %%
# Differences, second minus first, with their intervals:

comparison = st.compare(laden, ballast, names=("laden", "ballast"), manoeuvres=("zigzag:20/20",), speed=2.0)
comparison.summary()

# %%
# What the difference does to a zigzag 20/20:

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
for fit, label in ((laden, "laden"), (ballast, "ballast")):
    run = st.simulate(fit, "zigzag:20/20", speed=2.0, duration=120.0)
    axes.plot(run.time, np.degrees(run["psi"]), label=label)
axes.set(xlabel="time [s]", ylabel="heading [deg]")
axes.legend(loc="lower left")
