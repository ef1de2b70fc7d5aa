"""
One run in several files
========================

A compass and a rudder that were logged by two boxes, each at its own rate, one of them with a clock that is late.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import seatrial as st
from seatrial.api import prepared_run
from seatrial.physics.simulate import replay

# %%
# Two files of one zigzag: the heading at 5 Hz, the rudder at 1 Hz with stamps that are 0.4 s late.

time = np.arange(0.0, 120.0, 0.2)
rudder = np.radians(15.0) * np.sign(np.sin(0.15 * time))
craft = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
run = replay(craft, st.Record.from_arrays("zigzag", time, {"delta": rudder}), {"r": 0.0})

compass = pd.DataFrame({"t": time, "heading": np.degrees(run["psi"])})
servo = pd.DataFrame({"clock": time[::5] + 0.4, "angle": np.degrees(rudder[::5])})
compass.to_csv("compass.csv", index=False)
servo.to_csv("servo.csv", index=False)

# %%
# Each file is one of ``[[records.sources]]``; ``clock_offset`` is added to its stamps.

Path("two_files.toml").write_text("""
[ship]
name = "craft"
L = 8.0

[model]
name = "nomoto"

[[records]]
name = "zigzag"

[[records.sources]]
file = "compass.csv"
time = { column = "t", unit = "s" }
channels.psi = { column = "heading", unit = "deg" }

[[records.sources]]
file = "servo.csv"
clock_offset = -0.4
time = { column = "clock", unit = "s" }
channels.delta = { column = "angle", unit = "deg", kind = "command" }
""")

record = prepared_run("two_files.toml", "zigzag")
print(record.to_dataframe().head())

# %%
# The result is one record on one time base. An order (``kind = "command"``) is held between its stamps, a measurement
# is interpolated.

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(record.time, np.degrees(record["psi"]), label="heading")
axes.plot(record.time, np.degrees(record["delta"]), label="rudder")
axes.set(xlabel="time [s]", ylabel="angle [deg]")
axes.legend(loc="lower left")

for name in ("compass.csv", "servo.csv", "two_files.toml"):
    Path(name).unlink()
