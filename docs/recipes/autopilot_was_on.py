"""
Records made with the autopilot on
==================================

A controller ties the rudder to the disturbances it answers. An estimate that overlooks this is biased. ``check``
tests for it, ``[feedback]`` declares it, and either way the disturbance is estimated together with the coefficients.
"""

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.data.trial import Feedback

# %%
# A craft on autopilot in gusts: heading changes every minute, the rudder answers heading and yaw rate.

K, T, step = 0.15, 8.0, 0.1
rng = np.random.default_rng(4)
count = 6000
reference = np.radians(20.0) * np.sign(np.sin(2.0 * np.pi * np.arange(count) * step / 120.0))
psi, r, delta = np.zeros((3, count))
gust = 0.0
for k in range(count - 1):
    delta[k] = np.clip(1.0 * (reference[k] - psi[k]) - 4.0 * r[k], -0.6, 0.6)
    gust += step / 5.0 * -gust + np.radians(2.0) * np.sqrt(2.0 * step / 5.0) * rng.standard_normal()
    r[k + 1] = r[k] + step / T * (K * (delta[k] + gust) - r[k])
    psi[k + 1] = psi[k] + step * r[k]
delta[-1] = delta[-2]

noise = np.radians(0.2) * rng.standard_normal((2, count))
noisy = {"psi": psi + noise[0], "r": r + noise[1]}
record = st.Record.from_arrays("on_autopilot", step * np.arange(count), {**noisy, "delta": delta, "psi_ref": reference})
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(record.time, np.degrees(reference), label="ordered")
axes.plot(record.time, np.degrees(record["psi"]), label="measured")
axes.set(xlabel="time [s]", ylabel="heading [deg]")
axes.legend(loc="lower left")

# %%
# The declaration: input, output, and the reference where it was logged. The same in a trial file is a table
# ``[feedback]``.

trial = st.Trial(
    st.Ship("craft", {"L": 8.0}),
    (st.Run(record),),
    st.models.nomoto(),
    truth={"K": K, "T": T},
    estimate=st.EstimateSettings(channels=("psi", "r")),
    feedback=Feedback(input="delta", output="psi", reference="psi_ref"),
)
fit = st.identify(trial)
fit.summary()

# %%
# The result says what the loop costs: what the estimate would have been without a model of the disturbance.

print(fit.noise_model.text)
