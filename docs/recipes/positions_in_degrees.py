"""
Positions in latitude and longitude
===================================

A GNSS log has degrees. Named ``lat`` and ``lon``, they become metres north and east of the first fix, or of an
``origin`` of your own.
"""

from pathlib import Path

import matplotlib.pyplot as plt

from seatrial.api import prepared_run

# %%
# Two lines under ``[records.channels]`` are all. With ``origin`` the runs of several days share one plane.

trial_file = Path("degrees.toml")
trial_file.write_text("""
[data]
folder = "../../examples/ship"

[ship]
name = "tanker of 320 m"
L = 320.0

[model]
name = "nomoto"

[[records]]
files = "circle_35_*.csv"
origin = { lat = { value = 57.62, unit = "deg" }, lon = { value = 10.95, unit = "deg" } }
time = { column = "UTC", unit = "utc" }

[records.channels]
lat = { column = "Latitude", unit = "deg" }
lon = { column = "Longitude", unit = "deg" }
psi = { column = "Heading [deg]", unit = "deg" }
delta = { column = "Rudder [deg]", unit = "deg" }
""")

# %%
# The run as everything else will see it: metres and radians, headings unwrapped.

record = prepared_run(trial_file, "circle_35_port")
print(record.to_dataframe().describe().loc[["min", "max"]].round(2))

# %%
figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
axes.plot(record["y0"], record["x0"])
axes.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
trial_file.unlink()
