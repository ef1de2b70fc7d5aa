"""Days under autopilot in gusts: do intervals hold K and T, by a fine compass and by one in whole degrees?

    python benchmarks/autopilot_days.py [SEEDS]

`python benchmarks/run.py autopilot_days` is the short form. The simulator states its equations below and takes Euler
steps of 0.1 s, none of the package's own. The autopilot sees heading and rate as they are, whatever the log shows.

Two days with positions, speed and course over ground are drafted and fitted as those of a user are. Heading and course
are in whole degrees, and waves yaw the ship: both are in the velocities that the heading turns, as its own error.
"""

import math
import sys
import tempfile
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most, machine

import seatrial as st
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
# m/s, m forward of midship where the ship turns about, m of latitude in a degree, rad and rad/s of the yaw in waves
SPEED, PIVOT, A_DEGREE, YAW, SWELL = 7.8, 0.35 * LENGTH, 111195.0, math.radians(0.35), 0.72
KNOT, SPEED_NOISE = 0.514444, 0.05  # m/s, kn
MOST_MISSED = 2.0  # deg of heading over one length, required; chosen: twice a step of the log


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


def write_log(seed: int, path: Path) -> None:
    """Write a day as a bridge logs it: position, speed and course over ground, heading and rudder."""
    fine, rng = day(seed, 0.001), np.random.default_rng(seed)
    psi, delta, time = fine["psi"], fine["delta"], fine.time
    sway = -PIVOT * np.gradient(psi, time)
    north = SPEED * np.cos(psi) - sway * np.sin(psi)
    east = SPEED * np.sin(psi) + sway * np.cos(psi)
    lat = 56.0 + (np.cumsum(north) + rng.normal(0.0, 1.5, len(psi))) / A_DEGREE
    lon = 3.0 + (np.cumsum(east) + rng.normal(0.0, 1.5, len(psi))) / (A_DEGREE * np.cos(np.radians(lat)))
    heading = psi + YAW * np.sin(SWELL * time + np.sin(0.04 * time))
    speed = np.hypot(north, east) / KNOT + rng.normal(0.0, SPEED_NOISE, len(psi))
    course = np.degrees(np.arctan2(east, north)) % 360.0
    columns = [time, lat, lon, speed, course, np.degrees(heading) % 360.0, np.degrees(delta)]
    header = "Time [s],Latitude,Longitude,SOG (kn),COG (deg T),HDG (deg T),Rudder (deg)"
    np.savetxt(path, np.stack(columns, axis=1), "%.0f,%.5f,%.5f,%.1f,%.0f,%.0f,%.0f", header=header, comments="")


def missed_over_ground(seed: int) -> float:
    """Return by how much the heading of a day that was kept out is missed over one length [deg]."""
    with tempfile.TemporaryDirectory() as folder:
        logs = [Path(folder) / f"day{k}.csv" for k in range(2)]
        for k, log in enumerate(logs):
            write_log(2 * seed + k, log)
        draft = st.draft_trial(*logs, folder=folder, length=LENGTH)
        trial = Path(folder) / "trial.toml"
        trial.write_text(draft.text, encoding="utf-8")
        prediction = st.identify(trial).validation[0]
    missed = next(w for w in prediction.windows if w.window == "1 L").scores["psi_deg"].rms
    print(f"  days {2 * seed} and {2 * seed + 1} over ground: {missed:.2f} deg over one length")
    return missed


def judged(seeds: range) -> list[Line]:
    """Return the share of intervals that hold the truth by each compass."""
    return [
        at_least(f"{name}: intervals that hold K and T", float(np.mean([held(s, step) for s in seeds])), "", LEAST_HELD)
        for name, step in COMPASSES.items()
    ]


def over_ground(seeds: range) -> Line:
    """Return the worst error of heading over one length, of days with velocities over ground."""
    worst = max(missed_over_ground(seed) for seed in seeds)
    return at_most("heading over one length, velocities over ground in whole degrees", worst, "deg", MOST_MISSED)


def run() -> list[Line]:
    """Return a short sample: four days, and two with velocities over ground."""
    return [*judged(range(4)), over_ground(range(1))]


if __name__ == "__main__":
    print(machine())
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    for line in [*judged(range(count)), over_ground(range(max(count // 4, 1)))]:
        print(f"{line.quantity}: {line.value:.2f} {line.verdict}")
