"""
A log of NMEA 0183 sentences
============================

What a bridge network carries is read as it is: sentences in a text file, with or without a logger's stamp before them.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from pymap3d import ned2geodetic

import seatrial as st


def sentence(body: str) -> str:
    """Return a sentence with its checksum: the exclusive or of all characters."""
    check = 0
    for character in body.encode():
        check ^= character
    return f"${body}*{check:02X}"


def degrees_minutes(angle: float, digits: int) -> str:
    """Return an angle in degrees and minutes as NMEA 0183 writes it."""
    return f"{int(angle):0{digits}d}{60.0 * (angle % 1.0):07.4f}"


# %%
# A zigzag of a craft at 2 m/s: position, heading, rate of turn and rudder, once a second.

craft = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
run = st.simulate(craft, "zigzag:20/20", duration=200.0, rudder_rate=10.0).resampled(1.0)
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.plot(run["x0"], run["y0"])
axes.set(xlabel="north [m]", ylabel="east [m]", aspect="equal")

# %%
# As sentences:

latitude, longitude, _ = ned2geodetic(run["x0"], run["y0"], 0.0 * run.time, 57.62, 10.95, 0.0)
lines = []
for k, time in enumerate(run.time):
    heading = np.degrees(run["psi"][k]) % 360.0
    stamp = f"08{int(time) // 60:02d}{int(time) % 60:02d}.00"
    place = f"{degrees_minutes(latitude[k], 2)},N,{degrees_minutes(longitude[k], 3)},E"
    lines += [
        sentence(f"GPRMC,{stamp},A,{place},3.9,{heading:.1f},120526,,,A"),
        sentence(f"HEHDT,{heading:.1f},T"),
        sentence(f"TIROT,{np.degrees(run['r'][k]) * 60.0:.1f},A"),
        sentence(f"IIRSA,{np.degrees(run['delta'][k]):.1f},A,,"),
    ]
Path("bridge.nmea").write_text("\n".join(lines) + "\n")
print(*lines[:4], sep="\n")

# %%
# What is in it, and a trial file drafted from it:

for topic in st.survey_log("bridge.nmea").topics:
    print(topic.topic, *(column.name for column in topic.columns))

# %%
print(st.draft_trial("bridge.nmea").text)
Path("bridge.nmea").unlink()
