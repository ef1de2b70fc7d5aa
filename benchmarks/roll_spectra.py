"""Roll in waves that nobody measured: do the intervals of natural period and damping hold those of the ship?

    python benchmarks/roll_spectra.py [SEEDS]

A cell is a sea and the damping of a ship that rolls linearly, half an hour at 5 Hz. Roll is a sum of waves of random
phase and height through the ship's response (Price & Bishop 1974, section 6.2), with 0.1 deg of noise. The whole of
`identify` runs, as for a user who has the roll angle alone. 20 seeds are what the documentation rests on.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np

import seatrial as st

DURATION, STEP = 1800.0, 0.2  # s
ROLL, NOISE = math.radians(4.0), math.radians(0.1)  # rad, rms
G = 9.81  # m/s^2


@dataclass(frozen=True)
class Sea:
    """Peak period over the natural period of the ship; peakedness (JONSWAP); loss of slope in short waves [s^2]."""

    ratio: float
    gamma: float = 3.3
    loss: float = 0.0


SEAS = (Sea(0.8, 1.0), Sea(0.8, loss=0.5), Sea(0.9, loss=0.3), Sea(1.0, 1.0), Sea(1.0), Sea(1.2), Sea(1.3, loss=0.3))
DAMPING = (0.05, 0.1)  # 1/s, b_1
NATURAL_PERIOD = 10.0  # s


def record(sea: Sea, b_1: float, rng: np.random.Generator) -> st.Record:
    """Return the roll of a run."""
    rows = round(DURATION / STEP)
    omega = 2.0 * math.pi * np.fft.rfftfreq(2 * rows, STEP)[1:]
    peak, c_1 = 2.0 * math.pi / (sea.ratio * NATURAL_PERIOD), (2.0 * math.pi / NATURAL_PERIOD) ** 2
    width = np.where(omega < peak, 0.07, 0.09)  # Hasselmann et al. 1973
    peaked = sea.gamma ** np.exp(-0.5 * ((omega / peak - 1.0) / width) ** 2)
    elevation = omega**-5 * np.exp(-1.25 * (peak / omega) ** 4) * peaked
    slope = np.sqrt(elevation * np.exp(-sea.loss * omega**2)) * omega**2 / G
    response = c_1 / (c_1 - omega**2 + 1j * b_1 * omega)
    lines = slope * response * (rng.standard_normal(len(omega)) + 1j * rng.standard_normal(len(omega)))
    roll = np.fft.irfft(np.concatenate([[0.0], lines]), 2 * rows)[:rows]
    roll *= ROLL / np.std(roll)
    time = STEP * np.arange(rows)
    return st.Record.from_arrays("sea", time, {"phi": roll + NOISE * rng.standard_normal(rows)})


def cell(sea: Sea, b_1: float, seeds: int) -> tuple[int, int, int, float]:
    """Print a row; return fits, those whose intervals hold damping and restoring, and the median half width of b_1."""
    truth = {"b_1": b_1, "c_1": (2.0 * math.pi / NATURAL_PERIOD) ** 2}
    held = dict.fromkeys(truth, 0)
    widths: list[float] = []
    for seed in range(seeds):
        run = record(sea, b_1, np.random.default_rng([seed, round(1e3 * b_1)]))
        try:
            fit = st.identify(st.Trial(st.Ship("ship", {"L": 60.0}), (st.Run(run),), st.models.roll()))
        except st.InputError:
            continue
        found = {c.name: (c.lower, c.upper) for c in fit.coefficients if not c.fixed}
        for name, value in truth.items():
            low, high = found[name]
            held[name] += low is not None and high is not None and low <= value <= high
        low, high = found["b_1"]
        widths.append(0.5 * math.log(high / low))
    width = float(np.median(widths)) if widths else math.nan
    print(
        f"peak {sea.ratio:g} of the natural period, gamma {sea.gamma:g}, loss {sea.loss:g} s^2, b_1 {b_1:g}: "
        f"{len(widths)} of {seeds} fitted; hold b_1 {held['b_1']}, c_1 {held['c_1']}; half width of ln b_1 {width:.2f}",
        flush=True,
    )
    return len(widths), held["b_1"], held["c_1"], width


def main(seeds: int) -> None:
    """Print a row for each sea and damping, and what is pooled."""
    cells = np.array([cell(sea, b_1, seeds) for sea in SEAS for b_1 in DAMPING])
    fitted, damping, restoring = cells[:, :3].sum(axis=0)
    print(f"all: hold b_1 {damping / fitted:.3f}, c_1 {restoring / fitted:.3f} of {fitted:.0f} fits")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
