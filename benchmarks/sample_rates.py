"""Coefficients from logs at several sample rates, of craft simulated by their own equations in fine steps.

    python benchmarks/sample_rates.py [SEEDS]

`python benchmarks/run.py sample_rates` is the short form.

A roll decay of 5 s, a boat with two thrusters that loses its speed within seconds, and a boat that answers its rudder
within a second. Each simulator states its equations below and takes Runge-Kutta steps of 5 ms (`STEP`), none of the
package's own. For each rate: the share of 95 % intervals that hold the truth, the largest error in standard errors, and
the Runge-Kutta steps that the estimate takes in a sample.
"""

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from measure import Line, at_least

from seatrial.core.values import Array, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.physics.models import model_named

STEP = 0.005  # s, of the simulators; chosen: a hundredth of the fastest time constant below
Rates = Callable[[Array, Array], Array]


def simulated(rates: Rates, start: list[float], inputs: Array, dt: float, step: float = STEP) -> Array:
    """Return states at the samples (rows, nx); inputs (rows, nu) are held over each sample of `dt` [s].

    step: of the simulator [s].
    """
    x, states, count = np.array(start), [np.array(start)], round(dt / step)
    h = dt / count
    for u in inputs[:-1]:
        for _ in range(count):
            k1 = rates(x, u)
            k2 = rates(x + 0.5 * h * k1, u)
            k3 = rates(x + 0.5 * h * k2, u)
            x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rates(x + h * k3, u))
        states.append(x)
    return np.array(states)


ROLL = {"b_1": 0.04, "b_2": 0.25, "c_1": (2.0 * math.pi / 5.0) ** 2, "c_3": -0.3}


def roll_rates(x: Array, _: Array) -> Array:
    """A hull that rolls in 5 s, heeled by nothing."""
    phi, p = x
    return np.array([p, -ROLL["b_1"] * p - ROLL["b_2"] * p * abs(p) - ROLL["c_1"] * phi - ROLL["c_3"] * phi**3])


def roll_runs(rate: float, rng: np.random.Generator) -> list[Record]:
    """Three releases of 90 s, roll to 0.1 deg."""
    rows, runs = round(90.0 * rate) + 1, []
    for k, angle in enumerate((15.0, -12.0, 10.0)):
        states = simulated(roll_rates, [math.radians(angle), 0.0], np.zeros((rows, 1)), 1.0 / rate)
        phi = states[:, 0] + math.radians(0.1) * rng.standard_normal(rows)
        runs.append(Record.from_arrays(f"decay_{k}", np.arange(rows) / rate, {"phi": phi}))
    return runs


NOMOTO = {"K": 1.4, "T": 0.9, "alpha": 4.0}


def nomoto_rates(x: Array, u: Array) -> Array:
    """A boat that turns within a second, its gain falling as the rudder goes farther over (Norrbin)."""
    r = x[0]
    return np.array([(NOMOTO["K"] * u[0] - r - NOMOTO["alpha"] * r**3) / NOMOTO["T"], r])


def nomoto_runs(rate: float, rng: np.random.Generator) -> list[Record]:
    """Two runs of 200 s of rudder steps, each of 4 to 9 s; yaw rate to 0.2 deg/s, heading to 0.5 deg."""
    rows, runs = round(200.0 * rate) + 1, []
    for k in range(2):
        order = np.radians(np.repeat(rng.uniform(-30.0, 30.0, 50), rng.integers(4, 10, 50) * round(rate))[:rows])
        states = simulated(nomoto_rates, [0.0, 0.0], order[:, None], 1.0 / rate)
        noisy = states + np.radians([0.2, 0.5]) * rng.standard_normal(states.shape)
        channels = {"r": noisy[:, 0], "psi": noisy[:, 1], "delta": order}
        runs.append(_held(Record.from_arrays(f"steps_{k}", np.arange(rows) / rate, channels), ["delta"]))
    return runs


USV = {
    "X_u": -0.1, "X_uu": -0.35, "Y_v": -0.9, "Y_vv": -1.2, "N_r": -0.35, "N_rr": -0.3, "M_v": 1.5, "M_r": 0.35,
    "k_f": 1.0, "p_f": 2.0, "k_J": 0.2, "k_b": 0.7, "p_b": 2.0, "k_4": 0.2, "tau": 0.3, "tau_down": 0.3,
}  # fmt: skip
LEVER = 0.3  # m, of the thrusters to either side


def thrust(c: float, w: float) -> float:
    """Thrust of a propeller of share `c` of full command in a flow of `w` m/s along it."""
    if c < 0.0:
        return -USV["k_b"] * abs(c) ** USV["p_b"] * math.exp(-USV["k_4"] * w**2)
    full = USV["k_f"] * c ** USV["p_f"]
    return full - USV["k_J"] * math.sqrt(full) * w


def usv_rates(x: Array, u: Array) -> Array:
    """A boat of 2 m with two thrusters behind a lag, on each kg of m + m_x (Fossen 2021, ch. 6)."""
    surge, sway, r, psi, _, _, *c = x
    p, port, starboard = USV, thrust(c[0], surge + LEVER * r), thrust(c[1], surge - LEVER * r)
    X = port + starboard + p["X_u"] * surge + p["X_uu"] * surge * abs(surge)
    Y = p["Y_v"] * sway + p["Y_vv"] * sway * abs(sway)
    N = LEVER * (port - starboard) + p["N_r"] * r + p["N_rr"] * r * abs(r) - (p["M_v"] - 1.0) * surge * sway
    north = surge * math.cos(psi) - sway * math.sin(psi)
    east = surge * math.sin(psi) + sway * math.cos(psi)
    return np.array([
        X + p["M_v"] * sway * r, (Y - surge * r) / p["M_v"], N / p["M_r"], r, north, east, *((u - c) / p["tau"])
    ])  # fmt: skip


def usv_runs(rate: float, rng: np.random.Generator) -> list[Record]:
    """Two runs of 200 s of steps of both thrusters; rates to 1 % and 1 deg/s, heading to 1 deg, position to 0.1 m."""
    rows, runs = round(200.0 * rate) + 1, []
    spread = np.array([0.02, 0.02, math.radians(1.0), math.radians(1.0), 0.1, 0.1])
    for k in range(2):
        order = np.repeat(rng.uniform(-1.0, 1.0, (50, 2)), rng.integers(3, 8, 50) * round(rate), axis=0)[:rows]
        order[:1] = 0.0
        states = simulated(usv_rates, [0.0] * 8, order, 1.0 / rate)[:, :6]
        noisy = states + spread * rng.standard_normal(states.shape)
        channels = dict(zip(("u", "v", "r", "psi", "x0", "y0"), noisy.T, strict=True))
        channels |= {"command_1": order[:, 0], "command_2": order[:, 1]}
        made = Record.from_arrays(f"steps_{k}", np.arange(rows) / rate, channels)
        runs.append(_held(made, ["command_1", "command_2"]))
    return runs


def _held(record: Record, names: list[str]) -> Record:
    """The record with inputs known to be held from sample to sample."""
    runs = {name: replace(record.channel(name), between="held") for name in names}
    return replace(record, channels={**record.channels, **runs})


@dataclass(frozen=True)
class Craft:
    """A simulator, the model that is to find its coefficients, and the rates of its logs [Hz]."""

    model: str
    truth: dict[str, float]
    runs: Callable[[float, np.random.Generator], list[Record]]
    length: float
    rates: tuple[float, ...]


CRAFTS = {
    "roll decay, 5 s": Craft("roll", ROLL, roll_runs, 30.0, (1.0, 2.0, 10.0)),
    "boat with a rudder, 0.9 s": Craft("nomoto", NOMOTO, nomoto_runs, 2.0, (1.0, 5.0, 10.0)),
    "boat with two thrusters": Craft("thrusters", USV, usv_runs, 1.2, (1.0, 2.0, 10.0)),
}
NUISANCES = {"roll": ("phi_0",)}
"""What the estimate frees besides the truth's coefficients."""


def estimated(craft: Craft, rate: float, seed: int) -> Estimation:
    """Return the estimate of a craft's coefficients from its logs, of known timing."""
    model = model_named(craft.model)
    model = model.with_parameters(model.parameters.only_free([*craft.truth, *NUISANCES.get(craft.model, ())]))
    records = craft.runs(rate, np.random.default_rng([seed, round(10 * rate)]))
    settings = EstimateSettings().with_known_timing(model.input_names)
    runs = Runs.one_session_each(records, craft.length)
    return estimate_model(model, runs, settings, options=EstimatorOptions())


def standardised(craft: Craft, made: Estimation) -> Array:
    """Return errors over half widths of the 95 % intervals, (k,)."""
    free = made.estimate.problem.free
    error = made.estimate.common_parameters[: len(free)] - np.array([craft.truth.get(n, np.nan) for n in free])
    return (error / made.interval.half_width[: len(free)])[[n in craft.truth for n in free]]


def coverage(craft: Craft, rate: float, seeds: range) -> tuple[float, float, int]:
    """Return the share of intervals that hold the truth, the largest error over a half width, steps in a sample."""
    made = [estimated(craft, rate, seed) for seed in seeds]
    away = np.abs([standardised(craft, one) for one in made])
    return float(np.mean(away <= 1.0)), float(np.max(away)), max(one.estimate.problem.substeps for one in made)


LEAST_COVERAGE = 0.85
"""Of the 69 intervals of the short sample, 95 % each: four standard errors below, so that a fault fails it; chosen."""


def run() -> list[Line]:
    """Return the coverage of each craft with one seed, and that of all intervals."""
    shares = {name: [coverage(one, rate, range(1))[0] for rate in one.rates] for name, one in CRAFTS.items()}
    counts = np.array([len(CRAFTS[name].truth) * len(of_rates) for name, of_rates in shares.items()])
    means = np.array([np.mean(of_rates) for of_rates in shares.values()])
    lines = [
        Line(f"{name}, intervals that hold the truth", float(mean), "1")
        for name, mean in zip(shares, means, strict=True)
    ]
    pooled = float(counts @ means) / float(counts.sum())
    return [
        *lines,
        at_least("all three craft at 1 to 10 Hz, intervals that hold the truth", pooled, "1", LEAST_COVERAGE),
    ]


def main(seeds: int) -> None:
    """Print a line for each craft and rate."""
    for name, craft in CRAFTS.items():
        for rate in craft.rates:
            began = time.process_time()
            held, largest, steps = coverage(craft, rate, range(seeds))
            seconds = (time.process_time() - began) / seeds
            print(
                f"{name}, {rate:g} Hz: {100.0 * held:.0f} % of {len(craft.truth) * seeds} intervals hold the truth, "
                f"largest error {largest:.2f} half widths, {steps} steps in a sample, {seconds:.1f} s", flush=True,
            )  # fmt: skip


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
