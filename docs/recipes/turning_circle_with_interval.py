"""
A turning circle with its interval
==================================

From a fit to the numbers of a wheelhouse poster: each with an interval, and a word on whether it was measured,
predicted or extrapolated.
"""

import matplotlib.pyplot as plt
import pandas as pd

import seatrial as st

# %%
# The fit of the package's waterjet craft, and a turning circle that was not run.

fit = st.identify("../../examples/waterjet.toml")
circle = st.simulate(fit, "turning-circle:30", inputs={"v_j": 1.866})
figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
axes.plot(circle["y0"], circle["x0"])
axes.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")

# %%
# The poster's numbers, each with its interval and its basis:

rows = [
    (manoeuvre.manoeuvre, quantity.name, quantity.value, quantity.lower, quantity.upper, quantity.basis.value)
    for manoeuvre in st.poster(fit).manoeuvres
    for quantity in manoeuvre.quantities
]
pd.DataFrame(rows, columns=["manoeuvre", "measure", "value", "lower", "upper", "basis"]).round(3)
