"""
A first subset of the Taylor expansion
======================================

The expansion of Abkowitz has some sixty coefficients, and no series of zigzags determines them. Eight make a first
model; more are freed one by one, as long as runs that were left out are predicted better.
"""

import numpy as np
import pandas as pd

import seatrial as st

# %%
# Surge resistance and speed loss, and the linear terms of sway and yaw. Mass, inertia and added masses are stated:
# motions show forces per mass only.

first = ["X_u", "X_rr", "Y_v", "Y_r", "Y_d", "N_v", "N_r", "N_d"]
particulars = {"L": 7.0, "m": 3270.0, "x_G": 0.25, "I_z": 1e4, "rho": 1000.0, "U_n": 1.2}
added_masses = {"X_udot": -0.001, "Y_vdot": -0.015, "N_rdot": -0.0008}
model = st.models.abkowitz(first).with_values({**particulars, **added_masses})

# %%
# Two zigzags and a turning circle of a ship with known coefficients, with the noise of a log and a gyro compass. The
# records hold the sway velocity: from heading and positions alone ``Y_v`` may stay open.

truth = dict(zip(first, (-0.003, -0.001, -0.02, 0.003, -0.004, -0.005, -0.003, 0.002), strict=True))
noise = {"u": 0.01, "v": 0.01, "r": 0.002, "psi": 0.005}
rng = np.random.default_rng(1)


def measured(manoeuvre: str) -> st.Record:
    """Return the manoeuvre of the ship as its instruments show it."""
    run = st.simulate(model.with_values(truth), manoeuvre, speed=1.2, duration=120.0, rudder_rate=0.2)
    channels = {name: run[name] + noise.get(name, 0.0) * rng.standard_normal(len(run)) for name in (*noise, "delta")}
    return st.Record.from_arrays(manoeuvre, run.time, channels)


runs = (
    st.Run(measured("zigzag:10/10")),
    st.Run(measured("zigzag:20/20")),
    st.Run(measured("turning-circle:20"), st.Role.VALIDATE),
)

# %%
fit = st.identify(st.Trial(st.Ship("craft", particulars), runs, model))
pd.DataFrame({"truth": truth, **fit.to_dataframe().loc[first, ["estimate", "standard_error"]]}).round(5)

# %%
print({name: round(float(error), 3) for name, error in fit.validation[0].rms.items()})
