"""
The model as C code
===================

For a simulator or an autopilot: states, inputs and coefficients with units and signs in a header, and the rate
equations without any library.
"""

import shutil
from pathlib import Path

import matplotlib.pyplot as plt

import seatrial as st

# %%
# A fitted model; here one with known values.

craft = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
circle = st.simulate(craft, "turning-circle:20", duration=150.0)
figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
axes.plot(circle["y0"], circle["x0"])
axes.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")

# %%
# The files:

st.export(craft, "c99", "craft_c")
for path in sorted(Path("craft_c").iterdir()):
    print(path.name, path.stat().st_size, "bytes")

# %%
print(next(Path("craft_c").glob("*.h")).read_text()[:1800])
shutil.rmtree("craft_c")
