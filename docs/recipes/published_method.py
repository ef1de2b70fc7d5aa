"""
A published method on the same records
======================================

Papers regress accelerations on velocities. The methods are built in, and each is set next to the package's own
estimate on the same records.
"""

import pandas as pd

import seatrial as st

# %%
# Ridge regression on finite differences, and the package's own estimate, of a craft whose coefficients are known.

published = st.identify("../../examples/waterjet.toml", method="ridge")
fit = st.identify("../../examples/waterjet.toml")
table = pd.DataFrame(
    {
        "truth": pd.Series(st.load_trial("../../examples/waterjet.toml").truth),
        "ridge": published.to_dataframe()["estimate"],
        "seatrial": fit.to_dataframe()["estimate"],
    }
).dropna()
table.round(4)

# %%
# Errors over the truth. Simulations of both can look alike: good trajectories prove nothing about coefficients.

errors = (table[["ridge", "seatrial"]].sub(table["truth"], axis=0)).div(table["truth"], axis=0).abs()
axes = errors.plot.bar(logy=True, figsize=(5.5, 3.5), ylabel="relative error")
axes.figure.tight_layout()
