"""Write the logs of docs/ten-minutes.md: sea trials of a tanker, simulated, as a voyage data recorder would log them.

    python benchmarks/ship_logs.py FOLDER

It prints the measures of the turning circle that the page predicts.

Zigzags 10/10 and 20/20 and a turning circle of 35 degrees to each side at 1 Hz, with the published coefficients of
the KVLCC2 at full scale (Yasukawa & Yoshimura 2015), a rudder indicator with a zero error, and a light current.
"""

import sys
from pathlib import Path

import numpy as np
from pymap3d import ned2geodetic

import seatrial as st
from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres import measures
from seatrial.physics.models import parameter_set
from seatrial.physics.simulate import replay

MANOEUVRES = {
    "zigzag_10_10": ("zigzag:10/10", 900.0),
    "zigzag_20_20": ("zigzag:20/20", 1200.0),
    "circle_35_port": ("turning-circle:35:port", 900.0),
    "circle_35_starboard": ("turning-circle:35", 900.0),
}
"""Log -> manoeuvre and duration [s]."""
PREDICTED = "turning-circle:25:port"
RATE = 1.0  # Hz of a voyage data recorder
APPROACH = 7.97  # m/s through the water, 15.5 kn, the design speed of the KVLCC2 (SIMMAN 2008)
SHAFT = 1.73  # 1/s, about what holds that speed at full scale; chosen
CURRENT = {"current_north": 0.15, "current_east": -0.1}  # m/s, light; chosen
RUDDER_ZERO = 0.4  # deg, error of the rudder's indicator; chosen
ORIGIN = (57.62, 10.95)  # deg, a trial area in the Kattegat; chosen
ON_THE_APPROACH = 60  # samples of straight running before each manoeuvre, a minute; chosen
NOISE = {"position": 0.6, "psi": 0.1, "r": 0.015, "speed": 0.03, "delta": 0.05, "n": 0.2}
"""Standard deviations: m, deg, deg/s, m/s, deg, 1/min; of usual bridge sensors, chosen."""
COLUMNS = "UTC,Latitude,Longitude,Heading [deg],ROT [deg/min],Speed fwd [kn],Speed stbd [kn],Rudder [deg],Shaft [rpm]"
"""Header of a log."""


def tanker() -> Model:
    """Return the model whose records are simulated."""
    return parameter_set("kvlcc2-full").applied_to(st.models.mmg())


def simulated(name: str) -> Record:
    """Return a manoeuvre of the tanker with a straight run before it."""
    manoeuvre, duration = MANOEUVRES[name]
    model = tanker().with_values(CURRENT)
    run = st.simulate(model, manoeuvre, speed=APPROACH, inputs={"n": SHAFT}, duration=duration).resampled(RATE)
    inputs = {c: np.concatenate([np.full(ON_THE_APPROACH, run[c][0]), run[c]]) for c in ("delta", "n")}
    planned = Record.from_arrays(name, np.arange(len(run) + ON_THE_APPROACH) / RATE, inputs)
    return replay(model, planned, {state: float(run[state][0]) for state in model.states})


def rows(run: Record, start: np.datetime64, rng: np.random.Generator) -> list[str]:
    """Return the lines of a log in the units of its columns."""
    count = len(run)

    def noisy(values: Array, sd: float) -> Array:
        return values + sd * rng.standard_normal(count)

    north, east = (noisy(run[name], NOISE["position"]) for name in ("x0", "y0"))
    latitude, longitude, _ = ned2geodetic(north, east, np.zeros(count), *ORIGIN, 0.0)
    knot = 1852.0 / 3600.0  # m/s
    cells = zip(
        start + np.round(1000.0 * run.time).astype("timedelta64[ms]"), latitude, longitude,
        np.mod(noisy(np.degrees(run["psi"]), NOISE["psi"]), 360.0),
        60.0 * noisy(np.degrees(run["r"]), NOISE["r"]),
        noisy(run["u"], NOISE["speed"]) / knot, noisy(run["v"], NOISE["speed"]) / knot,
        noisy(np.degrees(run["delta"]), NOISE["delta"]) + RUDDER_ZERO, noisy(60.0 * run["n"], NOISE["n"]),
        strict=True,
    )  # fmt: skip
    return [
        f"{np.datetime_as_string(t, 's')}Z,{a:.7f},{o:.7f},{h:.1f},{w:.1f},{u:.2f},{v:.2f},{d:.1f},{n:.1f}"
        for t, a, o, h, w, u, v, d, n in cells
    ]


def main() -> None:
    """Write the logs into the folder."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for k, name in enumerate(MANOEUVRES):
        start = np.datetime64("2026-05-12T08:00:00.000") + np.timedelta64(45 * k, "m")
        lines = [COLUMNS, *rows(simulated(name), start, np.random.default_rng([21, k]))]
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    circle = st.simulate(tanker(), PREDICTED, inputs={"n": SHAFT})
    for name, value in measures(circle, tanker().parameters["L"].value).items():
        print(f"{name} {value:.4g}")


if __name__ == "__main__":
    main()
