"""The embedded example as a user would have it: record files and the trial file over them."""

from pathlib import Path

from seatrial.core.values.files import write_atomically
from seatrial.data.example_series.series import HELD_OUT, demo_series, file_name, write_csv

_TRIAL = """\
# Simulated trials of a waterjet craft with known coefficients (Song et al. 2025), seed {seed}.
question = "Do noisy zigzags give back known coefficients, and predict manoeuvres that were not fitted?"

[ship]
name = "waterjet craft"
source = "Song et al. 2025, doi 10.19693/j.issn.1673-3185.03832, table 1"
L = 9.8
d = 0.71
m = 5540.0

[[records]]
files = "*.csv"
header_lines = 1
validate = [{validate}]
source = "simulated in steps of 0.01 s with sensor noise"
kind = "simulated"
time = {{ column = "time [s]", unit = "s" }}

[records.channels]
x0 = {{ column = "x0 [m]", unit = "m" }}
y0 = {{ column = "y0 [m]", unit = "m" }}
psi = {{ column = "psi [deg]", unit = "deg" }}
u = {{ column = "u [m/s]", unit = "m/s" }}
v = {{ column = "v [m/s]", unit = "m/s" }}
r = {{ column = "r [deg/s]", unit = "deg/s" }}
delta = {{ column = "delta [deg]", unit = "deg", positive = "starboard" }}
v_j = {{ column = "v_j [m/s]", unit = "m/s" }}

[model]
name = "waterjet"

[truth]
{truth}
"""


def write_demo(folder: Path, seed: int) -> Path:
    """Make the trial series and write it to `folder`; returns the trial file.

    Raises:
        InputError: the folder cannot be written.
    """
    records, craft = demo_series(seed)
    for record in records:
        write_csv(record, folder / f"{record.name}.csv")
    validate = ", ".join(f'"{file_name(text)}"' for text in HELD_OUT)
    truth = "\n".join(f"{p.name} = {p.value!r}" for p in craft.parameters.free)
    path = folder / "trial.toml"
    write_atomically(path, _TRIAL.format(seed=seed, validate=validate, truth=truth).encode())
    return path
