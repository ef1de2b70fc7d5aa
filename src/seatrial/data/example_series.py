"""A simulated trial series of a craft with known coefficients, and its files."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record, display_unit
from seatrial.core.values.files import write_atomically
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

__all__ = [
    "JET_VELOCITY",
    "SENSOR_NOISE",
    "SLEW_RATE",
    "demo_series",
    "simulate_run",
    "true_model",
    "with_sensor_noise",
    "write_csv",
    "write_demo",
]


# A simulated trial series of a craft whose coefficients are known: the embedded example, and the proof by truth.

# standard deviations in SI units; chosen: log, gyro and GNSS of a small craft
SENSOR_NOISE = {"u": 0.02, "v": 0.02, "r": math.radians(0.1), "psi": math.radians(0.2), "x0": 0.5, "y0": 0.5}
# jet velocity of the craft [m/s], Song et al. 2025
JET_VELOCITY = 1.866
# rate of the nozzle [rad/s], ours
SLEW_RATE = math.radians(4.0)
# step of the simulation [s], rate of the records [Hz], straight run before the first order [s], ours
FINE_STEP, SAMPLE_RATE, APPROACH_S = 0.01, 10.0, 10.0
HELD_OUT = ("zigzag:25/25", "turning-circle:20")
# rate [Hz] and seed of the records in examples/waterjet, ours
EXAMPLE_RATE, EXAMPLE_SEED = 2.0, 2025
EXAMPLE_COLUMNS = ("x0", "y0", "psi", "u", "v", "r", "delta", "v_j")


def true_model() -> Model:
    """Return the craft with the coefficients that estimates are compared with."""
    return waterjet()


def demo_series(seed: int, executes: int = 5) -> tuple[tuple[Record, ...], Model]:
    """Return records with sensor noise at 10 Hz, and the model that made them.

    The first record is for training: consecutive zigzags 10/10 to 30/30, `executes` of each (5: 2075 s).
    The others are held out: a 25/25 zigzag and a turning circle with 20 deg, where drift stays within the model's
    reach. The generator is finer than any fitted model: steps of 0.01 s under a continuously slewing nozzle (4 deg/s),
    of which the record keeps every tenth sample. Inputs are recorded without noise.

    Args:
        seed: every record has a stream of its own, so that one does not depend on the others' lengths.
        executes: executes of each zigzag angle.
    """
    craft = true_model()
    texts = (f"consecutive-zigzags:{executes}", *HELD_OUT)
    streams = np.random.SeedSequence(seed).spawn(len(texts))
    records = tuple(
        with_sensor_noise(simulate_run(craft, text), np.random.default_rng(stream), seed)
        for text, stream in zip(texts, streams, strict=True)
    )
    return records, craft


def simulate_run(craft: Model, programme_text: str) -> Record:
    """Return one noise-free manoeuvre of the series, sampled at 10 Hz, named after its programme."""
    orders, inputs = programme(programme_text), {"v_j": JET_VELOCITY}
    fine = manoeuvre(craft, orders, dt=FINE_STEP, inputs=inputs, slew_rate=SLEW_RATE, approach=APPROACH_S)
    kept = fine.resampled(SAMPLE_RATE)
    step = f"generated in steps of {FINE_STEP:g} s, every {round(1.0 / (FINE_STEP * SAMPLE_RATE))}th kept"
    return kept.renamed(file_name(programme_text)).with_step(step)


def with_sensor_noise(record: Record, rng: np.random.Generator, seed: int) -> Record:
    """Return the record with white Gaussian sensor noise (`SENSOR_NOISE`) on its measured channels."""
    channels = dict(record.channels)
    for symbol, deviation in SENSOR_NOISE.items():
        values = record[symbol] + deviation * rng.standard_normal(len(record))
        channels[symbol] = record.channel(symbol).with_values(values)
    return replace(record, channels=channels).with_step(f"sensor noise, seed {seed}")


def file_name(programme_text: str) -> str:
    """Return a programme's text as the name of a record or file."""
    return programme_text.replace(":", "_").replace("/", "_")


def write_csv(record: Record, path: Path, columns: Sequence[str] = EXAMPLE_COLUMNS) -> None:
    """Write time and `columns` in the units people read, header ``symbol [unit]``; whole or not at all.

    Raises:
        InputError: the place cannot be written.
    """
    header = ",".join(["time [s]", *(f"{s} [{display_unit(record.channel(s).unit)[1]}]" for s in columns)])
    values = [record.time, *(record[s] * display_unit(record.channel(s).unit)[0] for s in columns)]
    rows = [",".join(_number(value) for value in row) for row in zip(*values, strict=True)]
    write_atomically(path, ("\n".join([header, *rows]) + "\n").encode())


def _number(value: float) -> str:
    return f"{value + 0.0:.4g}" if abs(value) < 10.0 else f"{value:.2f}"


# The embedded example as a user would have it: record files and the trial file over them.

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


def main(folder: str) -> None:
    """Write the example series to `folder`."""
    for record in demo_series(EXAMPLE_SEED)[0]:
        path = Path(folder) / f"{record.name}.csv"
        write_csv(record.resampled(EXAMPLE_RATE), path)
        print(f"{path}: {record.duration:.0f} s, {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    import sys

    if len(sys.argv) != 2:
        sys.exit("usage: python -m seatrial.data.example_series FOLDER")
    main(sys.argv[1])
