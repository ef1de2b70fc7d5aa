"""
A model of your own
===================

Equations are written once, as in the paper. Jacobians, compiled code, the start of the search and the equations in the
report come from them.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial import Model, Sheet
from seatrial.physics.simulate import replay


def model() -> Model:
    """Return Norrbin's steering equation."""
    sheet = Sheet("yaw", source="Norrbin 1963")
    r, psi = sheet.states("r psi")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 10.0, "s", "time constant", free=True)
    K = sheet.parameter("K", 0.1, "1/s", "gain", free=True)
    alpha = sheet.parameter("alpha", 1.0, "s^2/rad^2", "cubic damping", free=True)
    sheet.rate(r, (K * delta - r - alpha * r**3) / T, "nonlinear steering equation")
    sheet.rate(psi, r)
    return sheet.model()


# %%
# A zigzag of a craft with known coefficients, and a compass with noise of 0.1 degrees.

time = np.arange(0.0, 300.0, 0.5)
rudder = np.radians(20.0) * np.sign(np.sin(0.08 * time))
truth = {"T": 8.0, "K": 0.15, "alpha": 30.0}
run = replay(model().with_values(truth), st.Record.from_arrays("zigzag", time, {"delta": rudder}), {"r": 0.0})
psi = run["psi"] + np.radians(0.1) * np.random.default_rng(1).standard_normal(len(time))
zigzag = st.Record.from_arrays("zigzag", time, {"psi": psi, "delta": rudder})

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(time, np.degrees(rudder), label="rudder")
axes.plot(time, np.degrees(psi), label="heading")
axes.set(xlabel="time [s]", ylabel="angle [deg]")
axes.legend(loc="lower left")

# %%
# A trial made in code takes the model as it takes a built-in one.

fit = st.identify(st.Trial(st.Ship("craft", {"L": 8.0}), (st.Run(zigzag),), model(), truth=truth))
fit.summary()

# %%
fit.plot()
