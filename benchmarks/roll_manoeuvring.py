"""Simulated truth of ships that turn and roll: errors over the Cramer-Rao bound, coverage, speed of simulation.

    python benchmarks/roll_manoeuvring.py [--family son_nomoto | mmg_roll | abkowitz_roll] [--runs 200]

Two zigzags, two turns and two roll decays under way; each draw adds white noise to positions, heading, heel, velocities
and rates and estimates all free coefficients, GM and the damping of roll among them, from zero and GM 1 m.
Whatever is fixed is known. son_nomoto is the container ship S175 as published; what the others are is in
`problems.rolling_ship`.
"""

import argparse
from collections.abc import Callable, Mapping

import numpy as np
from measure import Line, at_least, at_most, fastest
from thrusters_truth import Draws, bound

from seatrial.core.equations import Model
from seatrial.physics.models.published import container_ship
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.problems.rolling_ship import (
    SETTINGS,
    RollingShip,
    rolling_container_ship,
    rolling_expansion,
    rolling_tanker,
)

POOLED, EACH = (0.93, 0.97), 0.90
"""Coverage of 95 % intervals: of all coefficients together, and of each at least."""
RATIO, RATIO_EACH = (0.9, 1.1), (0.85, 1.2)
"""RMSE over the bound: rms over all coefficients, and of each."""
SAMPLE = 20
"""Draws that `make bench` runs."""
STEPS, DT = 50_000, 0.1  # s
SPEED = 3.0  # million Runge-Kutta steps a second


FAMILIES: Mapping[str, Callable[[], RollingShip]] = {
    "son_nomoto": rolling_container_ship, "mmg_roll": rolling_tanker, "abkowitz_roll": rolling_expansion,
}  # fmt: skip


def without_guess(truth: Model) -> Model:
    """The model with its free coefficients at zero and GM 1 m, a value that fits no ship in particular."""
    return truth.with_values(dict.fromkeys(truth.parameters.free_names, 0.0) | {"GM": 1.0})


def estimated(ship: RollingShip, count: int) -> Draws:
    """Return what estimates of so many draws missed."""
    clean = ship.runs()
    draws = Draws.of(ship.model, bound(ship.model, ship.length, clean, ship.noise))
    fitted = without_guess(ship.model)
    draws.add(range(count), lambda rng: [ship.noisy(run, rng) for run in clean], fitted, ship.length, SETTINGS)
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


def speed_line() -> Line:
    """Speed of the published ship."""
    return at_least("S175 with roll: Runge-Kutta steps", speed(container_ship()), "M/s", SPEED)


def run() -> list[Line]:
    """A sample of the draws of the published ship, and the speed of simulation."""
    return [*lines(estimated(rolling_container_ship(), SAMPLE)), speed_line()]


def main() -> None:
    """Print errors over the bound and coverage."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--family", choices=tuple(FAMILIES), default="son_nomoto")
    parser.add_argument("--runs", type=int, default=200)
    arguments = parser.parse_args()
    draws = estimated(FAMILIES[arguments.family](), arguments.runs)
    print("\n".join(draws.refusals))
    print(f"{'':12}{'true':>10}{'bound':>10}{'ratio':>8}{'z':>7}{'inside':>8}\n{draws.table()}")
    for line in [*lines(draws), speed_line()]:
        print(f"  {line.quantity:<60} {line.value:>8.3f} {line.verdict}")


if __name__ == "__main__":
    main()
