"""Trial files of a known ship in a known sea, written for a test."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from seatrial.physics.models.published import theoretical_coefficients
from seatrial_studies.seaway import FIN, SeawayScenario, ship, simulate_seaway_run

UNITS = {"F3": "N", "M5": "N m", "delta_f1": "rad", "z": "m", "theta": "rad", "zeta": "m"}
WITH_BOX = """
[excitation]
source = "box"
"""


def write_wave_trial(
    folder: Path, voyages: Sequence[SeawayScenario], channels: Sequence[str], extra: str = "", waves: str = ""
) -> Path:
    """A trial file with one record a voyage; the first trains, others validate."""
    for number, voyage in enumerate(voyages):
        made = simulate_seaway_run(
            voyage, np.random.default_rng(number), ship(90 if voyage.heading == 45 else voyage.heading)
        )
        record = made.with_sensor_noise(np.random.default_rng(100 + number), voyage)
        table = np.column_stack([record.time, *(record[c] for c in channels)])
        header = ",".join(["time", *channels])
        np.savetxt(folder / f"run{number}.csv", table, delimiter=",", header=header, comments="", fmt="%.9g")
    columns = "\n".join(f'{c} = {{ column = "{c}", unit = "{UNITS[c]}" }}' for c in channels)
    heading = 90 if voyages[0].heading == 45 else voyages[0].heading
    truth = "\n".join(f"{name} = {value!r}" for name, value in theoretical_coefficients(heading).values.items())
    path = folder / "trial.toml"
    path.write_text(
        f"""
[ship]
name = "ship in waves"
L = 60.0
B = 7.1366
d = 2.27
m = 4.42e5
I5 = 9.945e7
c33 = 3.15e6
c35 = 6.83e6
c53 = 6.83e6
c55 = 6.54e8
[[records]]
files = "run*.csv"
header_lines = 1
train = "run0"
validate = {[f"run{n}" for n in range(1, len(voyages))]}
time = {{ column = "time", unit = "s" }}
[records.channels]
{columns}
{waves}
[model]
name = "heave_pitch"
fixed = {{ lift_1 = {FIN["lift_1"]!r}, x_f1 = -25.0 }}
[truth]
{truth}
{extra}
"""
    )
    return path


def waves_table(heading: int, sea: str = "") -> str:
    """The waves of the records: heading at 18 knots, and the sea's spectrum where nobody recorded it."""
    known = f"\nsea = {{ {sea} }}" if sea else ""
    return (
        f'[records.waves]\nheading = {{ value = {heading}, unit = "deg" }}\n'
        f'speed = {{ value = 18, unit = "kn" }}{known}\n'
    )
