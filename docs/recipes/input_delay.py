"""
An input that is late
=====================

A servo, a filter or a network delays what is logged. A tenth of a second can cost a quarter of a coefficient; where the
delay is not known it is estimated.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import seatrial as st
from seatrial.physics.simulate import replay

# %%
# A craft whose rudder moves 0.8 s after its logged order.

delay = 0.8
time = np.arange(0.0, 300.0, 0.2)


def order(t: np.ndarray) -> np.ndarray:
    """Return the rudder's orders at given times."""
    return np.radians(15.0) * np.sign(np.sin(0.13 * t))


craft = st.models.nomoto().with_values({"K": 0.15, "T": 4.0, "U": 2.0})
true = replay(craft, st.Record.from_arrays("run", time, {"delta": order(time - delay)}), {"r": 0.0})
rng = np.random.default_rng(6)
noise = np.radians(0.1) * rng.standard_normal((2, time.size))
record = st.Record.from_arrays(
    "zigzag", time, {"psi": true["psi"] + noise[0], "r": true["r"] + noise[1], "delta": order(time)}
)

part = time < 60.0
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(time[part], np.degrees(order(time[part])), label="order as logged")
axes.plot(time[part], np.degrees(order(time[part] - delay)), "--", label="rudder")
axes.set(xlabel="time [s]", ylabel="rudder [deg]")
axes.legend(loc="lower left")

# %%
# Without and with ``delays``:

ship, runs = st.Ship("craft", {"L": 8.0}), (st.Run(record),)
estimates = {}
for label, settings in (
    ("as logged", st.EstimateSettings(channels=("psi", "r"))),
    ("delay estimated", st.EstimateSettings(channels=("psi", "r"), delays={"delta": None})),
):
    fit = st.identify(st.Trial(ship, runs, st.models.nomoto(), settings))
    estimates[label] = fit.to_dataframe()["estimate"]
pd.DataFrame({"truth": {"K": 0.15, "T": 4.0}, **estimates}).round(4)

# %%
for offset in fit.offsets:
    print(f"{offset.name}: {offset.estimate:.2f} +- {offset.standard_error:.2f} s")
