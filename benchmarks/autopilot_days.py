"""Days under autopilot in gusts: do intervals hold K and T, by a fine compass and by one in whole degrees?

    python benchmarks/autopilot_days.py [SEEDS]

`python benchmarks/run.py autopilot_days` is the short form. The simulator states its equations below and takes Euler
steps of 0.1 s, none of the package's own. The autopilot sees heading and rate as they are, whatever the log shows.
"""

import math
import sys

import numpy as np
from measure import Line, at_least, machine

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.physics.models import nomoto

K, T, LENGTH = 0.045, 14.0, 88.0  # 1/s, s, m: a coaster
SECONDS, STEP, A_SAMPLE = 4700.0, 0.1, 10  # s, s, steps
GUST, MEMORY = 3e-4, 20.0  # rad/s^2 rms, s
LIMIT, SLEW, ORDERS = 0.35, math.radians(2.5), math.radians(0.5)  # rad, rad/s, rad: orders are in half degrees
CHANGES = np.radians([-45.0, -25.0, -15.0, 15.0, 25.0, 40.0, 60.0])  # of the course, each 300 to 700 s
COMPASSES = {"compass of 0.01 deg": 0.01, "compass of whole degrees": 1.0}  # as heading and rudder are logged
LEAST_HELD = 0.8  # share of intervals, required


def day(seed: int, step_deg: float) -> Record:
    """Return a log at 1 Hz: T r' + r = K delta + T g, a proportional-derivative autopilot, a gust of first order."""
    rng = np.random.default_rng(seed)
    r = delta = gust = bias = 0.0
    psi = course = rng.uniform(0.0, 2.0 * math.pi)
    change, rows = 400.0, []
    for k in range(round(SECONDS / STEP)):
        if k * STEP > change:
            course, change = course + rng.choice(CHANGES), change + rng.uniform(300.0, 700.0)
        error = math.remainder(course - psi, 2.0 * math.pi)
        bias = float(np.clip(bias + 0.002 * error * STEP, -0.05, 0.05))
        order = round(float(np.clip(error - 14.0 * r + bias, -LIMIT, LIMIT)) / ORDERS) * ORDERS
        delta += float(np.clip(order - delta, -SLEW * STEP, SLEW * STEP))
        gust += -gust * STEP / MEMORY + GUST * math.sqrt(2.0 * STEP / MEMORY) * rng.standard_normal()
        r += STEP * ((K * delta - r) / T + gust)
        psi += STEP * r
        if k % A_SAMPLE == 0:
            rows.append((psi, delta))
    unit = math.radians(step_deg)
    shown = np.round(np.array(rows) / unit) * unit
    time = A_SAMPLE * STEP * np.arange(len(rows), dtype=np.float64)
    return Record.from_arrays(f"day {seed}", time, {"psi": shown[:, 0], "delta": shown[:, 1]})


def held(seed: int, step_deg: float) -> list[bool]:
    """Return whether the intervals of K and T hold the truth."""
    runs = Runs.one_session_each([day(seed, step_deg)], LENGTH)
    fit = estimate_model(nomoto(), runs, options=EstimatorOptions(workers=1))
    values, half = fit.estimate.common_parameters[:2], fit.interval.half_width[:2]
    print(f"  day {seed}, {step_deg} deg: K {values[0]:.4f} +- {half[0]:.4f}, T {values[1]:.1f} +- {half[1]:.1f}")
    return [bool(abs(v - true) <= h) for v, h, true in zip(values, half, (K, T), strict=True)]


def judged(seeds: range) -> list[Line]:
    """Return the share of intervals that hold the truth by each compass."""
    return [
        at_least(f"{name}: intervals that hold K and T", float(np.mean([held(s, step) for s in seeds])), "", LEAST_HELD)
        for name, step in COMPASSES.items()
    ]


def run() -> list[Line]:
    """Return a short sample: four days."""
    return judged(range(4))


if __name__ == "__main__":
    print(machine())
    for line in judged(range(int(sys.argv[1]) if len(sys.argv) > 1 else 12)):
        print(f"{line.quantity}: {line.value:.2f} {line.verdict}")
