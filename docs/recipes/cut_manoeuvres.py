"""
Manoeuvres out of a long log
============================

A day's log holds approaches, waiting and manoeuvres. ``init`` finds the manoeuvres; each becomes a run of its own.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import seatrial as st
from seatrial.api import prepared_run

# %%
# What a draft offers of the craft's consecutive zigzags:

draft = st.draft_trial("../../examples/waterjet/consecutive-zigzags_5.csv")
print("\n".join(line for line in draft.text.splitlines() if "name =" in line and "from" in line))

# %%
# Two of them are kept, by time in seconds after the first sample.

Path("parts.toml").write_text("""
[ship]
name = "craft"
L = 9.8

[model]
name = "nomoto"

[[records]]
files = "../../examples/waterjet/consecutive-zigzags_5.csv"
validate = "later"
parts = [
    { name = "earlier", from = "1500 s", to = "1750 s" },
    { name = "later", from = "1755 s", to = "2010 s" },
]
time = { column = "time [s]", unit = "s" }

[records.channels]
psi = { column = "psi [deg]", unit = "deg" }
r = { column = "r [deg/s]", unit = "deg/s" }
delta = { column = "delta [deg]", unit = "deg" }
""")
for run in st.load_trial("parts.toml").runs:
    print(run.name, run.role)

# %%
earlier, later = (prepared_run("parts.toml", name) for name in ("earlier", "later"))
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(earlier.time - earlier.time[0], np.degrees(earlier["psi"] - earlier["psi"][0]), label="earlier")
axes.plot(later.time - later.time[0], np.degrees(later["psi"] - later["psi"][0]), label="later")
axes.set(xlabel="time [s]", ylabel="heading [deg]")
axes.legend(loc="lower left")
Path("parts.toml").unlink()
