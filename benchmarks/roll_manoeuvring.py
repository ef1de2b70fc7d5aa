"""Simulated truth of a ship that turns and rolls: errors over the Cramer-Rao bound, coverage, speed of simulation.

    python benchmarks/roll_manoeuvring.py [--runs 200]

The container ship S175 (Son & Nomoto 1981) in two zigzags, two turns and two roll decays under way, sampled at 1 Hz;
each draw adds white noise to positions, heading, heel, velocities and rates and estimates the 20 free coefficients, GM
and the damping of roll among them, from zero and GM 1 m. The others are known. Limits are those of a simulated truth.
"""

import argparse

import numpy as np
from measure import Line, at_least, at_most, fastest
from thrusters_truth import Draws, bound

from seatrial.core.equations import Model
from seatrial.physics.models.published import container_ship, s175
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.problems.rolling_ship import NOISE, SETTINGS, noisy, trial_runs

POOLED, EACH = (0.93, 0.97), 0.90
"""Coverage of 95 % intervals: of all coefficients together, and of each at least."""
RATIO, RATIO_EACH = (0.9, 1.1), (0.85, 1.2)
"""RMSE over the bound: rms over all coefficients, and of each."""
SAMPLE = 20
"""Draws that `make bench` runs."""
STEPS, DT = 50_000, 0.1  # s
SPEED = 3.0  # million Runge-Kutta steps a second


def without_guess(truth: Model) -> Model:
    """The model with its free coefficients at zero and GM 1 m, a value that fits no ship in particular."""
    return truth.with_values(dict.fromkeys(truth.parameters.free_names, 0.0) | {"GM": 1.0})


def estimated(count: int) -> Draws:
    """Return what estimates of so many draws missed."""
    truth = container_ship()
    clean, length = trial_runs(truth), s175().ship.length
    draws = Draws.of(truth, bound(truth, length, clean, NOISE))
    draws.add(
        range(count), lambda rng: [noisy(run, rng) for run in clean], without_guess(truth), length, SETTINGS
    )  # fmt: skip
    return draws


def speed(model: Model) -> float:
    """Return Runge-Kutta steps a second, in millions, of a ship whose rudder goes from side to side."""
    time = DT * np.arange(STEPS)
    inputs = np.zeros((STEPS, len(model.inputs)))
    inputs[:, model.input_names.index("n")] = 70.0 / 60.0
    inputs[:, model.input_names.index("delta")] = np.radians(10.0) * np.sign(np.sin(0.02 * time))
    batch = SegmentBatch(model, inputs, np.array([0, STEPS]), DT, model.states)
    start = np.zeros((1, len(model.states)))
    start[0, 0] = 7.33
    values = model.parameters.values[None]
    return STEPS / fastest(lambda: batch.simulate(0, 1, start, values, np.empty((1, 0)))) / 1e6


def lines(draws: Draws) -> list[Line]:
    """Coverage and errors against their limits."""
    share, each = float(np.mean(draws.is_held)), np.mean(draws.is_held, axis=0)
    pooled = float(np.sqrt(np.mean(np.square(draws.errors))))
    low, high = POOLED
    least, most = RATIO
    inside = bool(np.all((draws.ratio >= RATIO_EACH[0]) & (draws.ratio <= RATIO_EACH[1])))
    return [
        Line(f"{len(draws.errors)} draws: coverage, pooled", share, "", f"{low:g} to {high:g}", low <= share <= high),
        at_least("coverage of the least covered coefficient", float(np.min(each)), "", EACH),
        Line("RMSE over the bound, pooled", pooled, "", f"{least:g} to {most:g}", least <= pooled <= most),
        Line("largest RMSE of a coefficient over its bound", float(np.max(draws.ratio)), "",
             f"each {RATIO_EACH[0]:g} to {RATIO_EACH[1]:g}", inside),
        at_most("draws without an estimate", len(draws.refusals), "", 0),
    ]  # fmt: skip


def run() -> list[Line]:
    """A sample of the draws, and the speed of simulation."""
    return [
        *lines(estimated(SAMPLE)),
        at_least("S175 with roll: Runge-Kutta steps", speed(container_ship()), "M/s", SPEED),
    ]


def main() -> None:
    """Print errors over the bound and coverage."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=200)
    arguments = parser.parse_args()
    draws = estimated(arguments.runs)
    print("\n".join(draws.refusals))
    print(f"{'':12}{'true':>10}{'bound':>10}{'ratio':>8}{'z':>7}{'inside':>8}\n{draws.table()}")
    for line in [*lines(draws), at_least("S175 with roll: Runge-Kutta steps", speed(container_ship()), "M/s", SPEED)]:
        print(f"  {line.quantity:<60} {line.value:>8.3f} {line.verdict}")


if __name__ == "__main__":
    main()
