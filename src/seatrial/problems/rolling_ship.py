"""The container ship S175 as Son & Nomoto published it, in zigzags, turns and roll decays under a ship's sensors."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.published import SON_NOMOTO, container_ship, s175
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw, off_centre_box, scaled_values

# m, m, rad, m/s, m/s, rad/s, rad, rad/s: standard deviations of a ship's receiver, log, compass and gyros; chosen
NOISE: Mapping[str, float] = {
    "x0": 1.0, "y0": 1.0, "psi": math.radians(0.1), "u": 0.05, "v": 0.05, "r": math.radians(0.01),
    "phi": math.radians(0.1), "p": math.radians(0.02),
}  # fmt: skip
# programme -> screw [rpm]; initial heel [deg] -> screw [rpm]; chosen
MANOEUVRES = {"zigzag:10/10": 70.0, "zigzag:20/20": 100.0, "turning-circle:35": 85.0, "turning-circle:15": 100.0}
DECAYS = {10.0: 70.0, -10.0: 40.0}
DT, APPROACH_S, SECONDS, DECAY_S = 1.0, 60.0, 900.0, 400.0  # s: sample, approach, longest manoeuvre, decay; chosen
SPEED_OVER_RPM = 7.33 / 70.0  # m/s over rpm of a straight course, which the model is proportional in
# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.1, 0.5
# evaluations, each a simulation of six runs; chosen
_BUDGET = 1000
SETTINGS = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)


def trial_runs(model: Model) -> list[Record]:
    """Return zigzags, turns and decays of a ship under way, without noise; all motions and inputs."""
    runs = [
        manoeuvre(model, programme(text), dt=DT, duration=SECONDS, approach=APPROACH_S, inputs={"n": rpm / 60.0})
        for text, rpm in MANOEUVRES.items()
    ]
    runs += [_decay(model, heel, rpm) for heel, rpm in DECAYS.items()]
    return [replace(run, channels={c: run.channel(c) for c in (*NOISE, "n", "delta")}) for run in runs]


def _decay(model: Model, heel: float, rpm: float) -> Record:
    """A ship under way let go from a heel [deg], rudder amidships."""
    time = np.arange(0.0, DECAY_S + DT, DT)
    inputs = {"n": np.full(len(time), rpm / 60.0), "delta": np.zeros(len(time))}
    start = dict.fromkeys(model.states, 0.0) | {"u": SPEED_OVER_RPM * rpm, "phi": math.radians(heel)}
    return replay(model, Record.from_arrays(f"decay_{heel:g}", time, inputs), start)


def noisy(run: Record, rng: np.random.Generator) -> Record:
    """Return what instruments record of a run."""
    channels = dict(run.channels)
    for name, spread in NOISE.items():
        channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
    return replace(run, channels=channels)


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem."""
    title = "container ship with roll, 4 manoeuvres and 2 decays, box ±50 % off centre"
    noise = "x0, y0 1 m, psi, phi 0.1 deg, u, v 0.05 m/s, r 0.01 deg/s, p 0.02 deg/s, white"
    return (BenchmarkProblem("s175-trials", 1, title, SON_NOMOTO, noise, _BUDGET, _draw),)


def _draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    model = container_ship()
    names = model.parameters.free_names
    truth = np.array([model.parameters[name].value for name in names])
    if placement is Placement.SHIFTED:
        truth = scaled_values(truth, _SCALE, rng)
        model = model.with_values(dict(zip(names, truth.tolist(), strict=True)))
    clean = trial_runs(model)
    starts = [{name: float(run[name][0]) for name in model.states} for run in clean]
    records = [noisy(run, rng) for run in clean]
    box = off_centre_box(truth, _HALF_WIDTH, rng)
    craft = KnownCraft(s175().ship, model, records, NOISE, starts, SETTINGS)
    return craft_draw(craft, box, 0.5 * (box.lower + box.upper))
