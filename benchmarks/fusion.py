"""What captive points do for a prediction from zigzags: how far the tactical diameter moves with the prior's width.

KVLCC2 at full scale with its published coefficients is the truth. Two zigzags 10/10, first to either side, train, with
the noise of GNSS and gyro and in a gusty wind that nobody records. All coefficients of hull, rudder interaction and
added masses are free; their prior means lie 10-20 % off the truth, to either side. The 35 deg turn in calm air is
predicted with priors of 10, 30 and 100 %, without and with a table of captive points of 3 % noise, everything over
several draws. (With zigzags 20/20 as well the records alone suffice: the diameter moves by some 1 point only.)
`python benchmarks/fusion.py` alone; `--draws 3` for a quicker look.

Where SEATRIAL_DATA is set, the same with the recorded zigzags of the 7 m KVLCC2 (examples/kvlcc2_hsva.toml) and points
simulated from the published coefficients, about which the priors are centred too: what real model error does.
"""

import argparse
import math
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from measure import Line, at_most, machine

from seatrial.core.equations import Model
from seatrial.core.values import ForcePoints, Prior, Record
from seatrial.data.trial import EstimateMethod, EstimateSettings, Role, load_records, load_trial
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.identify import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.mmg import HULL, mmg
from seatrial.physics.models.published import esso_osaka, kvlcc2_full
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre

SEED, DRAWS, RATE, REVOLUTIONS = 11, 8, 1.0, 1.54
TRAINING = ("zigzag:10/10", "zigzag:10/10:port")
TURN = "turning-circle:35"
# log, gyro and differential GNSS of a ship
NOISE = {"u": 0.05, "v": 0.05, "r": math.radians(0.02), "psi": math.radians(0.2), "x0": 1.0, "y0": 1.0}
# areas of a laden tanker, chosen; wind coefficients of the Esso Osaka (Miyauchi et al. 2022)
WIND = {"A_T": 1100.0, "A_L": 2500.0}
WIND_SPEED, GUST, GUST_SECONDS = 6.0, 0.25, 60.0
RUDDER_AND_MASSES = ("a_H", "gamma_R_plus", "gamma_R_minus", "l_R_prime", "t_R", "m_x_prime", "m_y_prime", "J_z_prime")
FREE = (*HULL, *RUDDER_AND_MASSES)
OFF_CENTRE = (0.1, 0.2)
SPREADS = (10.0, 30.0, 100.0)
FORCE_NOISE_PERCENT = 3.0
DRIFT = (-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0)
YAW = (-0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8)
RUDDER = (-10.0, 10.0, 20.0, 35.0)
LIMIT = 4.0


@dataclass(frozen=True)
class DiameterSpread:
    """Predicted tactical diameter in ship lengths by prior sd in per cent, and the true one."""

    predicted: Mapping[float, float]
    truth: float

    @property
    def points(self) -> float:
        """Range of the predictions in percentage points of the truth."""
        return 100.0 * float(np.ptp(list(self.predicted.values()))) / self.truth

    @property
    def error(self) -> float:
        """Largest error of a prediction in per cent."""
        return 100.0 * max(abs(p / self.truth - 1.0) for p in self.predicted.values())


def simulate_calm(model: Model, text: str) -> Record:
    """One manoeuvre in calm air at constant propeller rate."""
    return manoeuvre(model, programme(text), dt=1.0 / RATE, inputs={"n": REVOLUTIONS}, approach=30.0)


def with_wind(model: Model, record: Record, rng: np.random.Generator) -> Record:
    """The same rudder angles in a wind of random direction with gusts (first-order), of which no record is left."""
    keep, gust = math.exp(-1.0 / (RATE * GUST_SECONDS)), np.zeros(len(record))
    for i, draw in enumerate(rng.standard_normal(len(record) - 1)):
        gust[i + 1] = keep * gust[i] + math.sqrt(1.0 - keep**2) * draw
    wind = np.maximum(WIND_SPEED * (1.0 + GUST * gust), 0.0)
    direction = np.full(len(record), rng.uniform(-math.pi, math.pi))
    channels = (("wind_speed", wind), ("wind_direction", direction))
    for symbol, values in channels:
        record = record.with_channel(symbol, record.channel(symbol).with_values(values))
    blown = {n: v for n, v in esso_osaka().values.items() if n.startswith("C_") and n[2] in "XYN"}
    return replay(model.with_values({**WIND, **blown}), record).without("wind_speed", "wind_direction", "thrust")


def noisy(record: Record, rng: np.random.Generator) -> Record:
    """White sensor noise on every measured channel."""
    made = dict(record.channels)
    for symbol, sd in NOISE.items():
        made[symbol] = made[symbol].with_values(record[symbol] + sd * rng.standard_normal(len(record)))
    return replace(record, channels=made)


def simulate_captive_points(
    model: Model,
    rng: np.random.Generator,
    speed: float,
    revolutions: float = REVOLUTIONS,
    percent: float = FORCE_NOISE_PERCENT,
) -> ForcePoints:
    """Points over drift and yaw rate with rudder amidships and over the rudder angle straight ahead and in a turn."""
    length = model.parameters["L"].value
    grid = [(b, r, 0.0) for b, r in product(DRIFT, YAW)]
    grid += [(b, r, d) for (b, r), d in product(((0.0, 0.0), (10.0, 0.4), (20.0, 0.8)), RUDDER)]
    beta, r, delta = np.array(grid).T
    beta, delta = np.radians(beta), np.radians(delta)
    motion = {
        "u": speed * np.cos(beta), "v": -speed * np.sin(beta), "r": r * speed / length,
        "delta": delta, "n": np.full(len(beta), revolutions),
    }  # fmt: skip
    blank = np.zeros(len(beta))
    empty = ForcePoints("captive", motion, {"X": blank, "Y": blank, "N": blank}, {"X": 1.0, "Y": 1.0, "N": 1.0})
    exact = StaticForces(model, empty).forces(model.parameters.values)
    sd = np.maximum(percent, 1e-6) / 100.0 * np.ptp(exact, axis=0)
    measured = exact + percent / 100.0 * np.ptp(exact, axis=0) * rng.standard_normal(exact.shape)
    return replace(
        empty,
        forces=dict(zip("XYN", measured.T, strict=True)),
        sd=dict(zip("XYN", sd.tolist(), strict=True)),
    )


def off_centre_means(model: Model, rng: np.random.Generator) -> dict[str, float]:
    """Prior means 10-20 % beside the truth, to either side."""
    shift = rng.uniform(*OFF_CENTRE, len(FREE)) * rng.choice((-1.0, 1.0), len(FREE))
    return {name: model.parameters[name].value * (1.0 + s) for name, s in zip(FREE, shift, strict=True)}


def with_priors(model: Model, means: Mapping[str, float], percent: float) -> Model:
    """The model free in these parameters, starting from the prior means."""
    parameters = model.parameters.only_free(means).with_values(means)
    priors = {n: Prior(m, percent / 100.0 * parameters[n].characteristic_scale, "off-centre") for n, m in means.items()}
    return model.with_parameters(parameters.with_priors(priors))


def diameter(model: Model) -> float:
    """Tactical diameter of the 35 deg turn in ship lengths."""
    return measures(simulate_calm(model, TURN), model.parameters["L"].value)["tactical_diameter_L"]


def diameter_spread(
    runs: list[Record],
    means: Mapping[str, float],
    truth: Model,
    points: tuple[ForcePoints, ...],
    spreads: tuple[float, ...] = SPREADS,
    method: EstimateMethod = EstimateMethod.AUTO,
) -> DiameterSpread:
    """Fit with each prior width and predict the turn."""
    data = replace(Runs.one_session_each(runs, truth.parameters["L"].value), forces=points)
    settings, options = EstimateSettings(channels=tuple(NOISE), method=method), EstimatorOptions(workers=1)
    made = {}
    for percent in spreads:
        found = estimate_model(with_priors(truth, means, percent), data, settings, options)
        made[percent] = diameter(found.model)
    return DiameterSpread(made, diameter(truth))


def compare_with_captive(
    seed: int = SEED,
    training: tuple[str, ...] = TRAINING,
    spreads: tuple[float, ...] = SPREADS,
    method: EstimateMethod = EstimateMethod.AUTO,
) -> tuple[DiameterSpread, DiameterSpread]:
    """Without and with captive points, from the same records and priors."""
    truth = kvlcc2_full().applied_to(mmg())
    streams = [np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3)]
    calm = [simulate_calm(truth, text) for text in training]
    runs = [noisy(with_wind(truth, record, streams[0]), streams[0]) for record in calm]
    means = off_centre_means(truth, streams[1])
    points = simulate_captive_points(truth, streams[2], float(calm[0]["u"][0]))
    alone = diameter_spread(runs, means, truth, (), spreads, method)
    return alone, diameter_spread(runs, means, truth, (points,), spreads, method)


RECORDED = Path(__file__).parents[1] / "examples" / "kvlcc2_hsva.toml"


def compare_on_records(seed: int = SEED) -> tuple[DiameterSpread, DiameterSpread]:
    """Without and with simulated captive points, from the recorded zigzags; errors are against the published turn."""
    trial = load_trial(RECORDED)
    found = [r for r in load_records(trial)[0] if r.role is Role.TRAIN]
    train = [replace(r, record=r.record.resampled(trial.estimate.rate or RATE)) for r in found]
    runs = [r.record for r in train]
    published, length = trial.model.with_parameters(trial.model.parameters.without_priors()), trial.ship.length
    speed, n = (float(np.median(np.concatenate([r[s][:10] for r in runs]))) for s in ("u", "n"))
    points = simulate_captive_points(published, np.random.default_rng(seed), speed, revolutions=n)
    means = {p.name: p.value for p in published.parameters.free}

    def turn(model: Model) -> float:
        slew = SOLAS_SLEW_RATE * math.sqrt(trial.ship.scale)
        made = manoeuvre(model, programme(TURN), dt=0.1, inputs={"n": n}, slew_rate=slew)
        return measures(made, length)["tactical_diameter_L"]

    def spread_with(forces: tuple[ForcePoints, ...]) -> DiameterSpread:
        data = replace(training_runs(trial, train), forces=forces)
        models = {p: with_priors(published, means, p) for p in SPREADS}
        return DiameterSpread(
            {p: turn(estimate_model(m, data, trial.estimate).model) for p, m in models.items()},
            turn(published),
        )

    return spread_with(()), spread_with((points,))


def recorded_lines(pair: tuple[DiameterSpread, DiameterSpread]) -> list[Line]:
    """The table of the recorded zigzags."""
    alone, fused = pair
    table = [Line("recorded zigzags: the published coefficients' diameter", fused.truth, "L")]
    for label, made in (("alone", alone), ("with captive points", fused)):
        table += [Line(f"recorded zigzags {label}, prior {p:g} %", v, "L") for p, v in made.predicted.items()]
    return [
        *table,
        Line("recorded zigzags alone: diameter moves", alone.points, "points"),
        at_most("recorded zigzags with captive points: diameter moves", fused.points, "points", LIMIT),
    ]


def lines(pairs: list[tuple[DiameterSpread, DiameterSpread]]) -> list[Line]:
    """The table over all draws; the target holds for the largest move."""
    table = [Line("true tactical diameter", pairs[0][0].truth, "L")]
    for label, of in (("zigzags alone", [a for a, _ in pairs]), ("zigzags and captive points", [b for _, b in pairs])):
        largest = max(m.points for m in of)
        what = f"{label}: diameter moves, largest of {len(of)} draws"
        held = label != "zigzags alone"
        table += [
            Line(f"{label}: diameter moves, median", float(np.median([m.points for m in of])), "points"),
            at_most(what, largest, "points", LIMIT) if held else Line(what, largest, "points"),
        ]
        for p in SPREADS:
            errors = [100.0 * (m.predicted[p] / m.truth - 1.0) for m in of]
            table.append(
                Line(
                    f"{label}, prior {p:g} %: error of the diameter, rms",
                    float(np.sqrt(np.mean(np.square(errors)))),
                    "%",
                )
            )
    return table


def run(draws: int = DRAWS, seed: int = SEED) -> list[Line]:
    """All draws of noise, wind, prior means and points."""
    table = lines([compare_with_captive(seed + i) for i in range(draws)])
    return [*table, *recorded_lines(compare_on_records(seed))] if os.environ.get("SEATRIAL_DATA") else table


def main(arguments: list[str]) -> int:
    """Print the table; 1 if the target is missed."""
    parser = argparse.ArgumentParser(description="tactical diameter from zigzags, without and with captive points")
    parser.add_argument("--draws", type=int, default=DRAWS)
    parser.add_argument("--seed", type=int, default=SEED)
    given = parser.parse_args(arguments)
    print(machine())
    table = run(given.draws, given.seed)
    for line in table:
        print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}")
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
