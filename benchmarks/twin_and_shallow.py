"""Simulated truth of two screws, two jets and shallow water: errors over the bound, coverage, speed of simulation.

    python benchmarks/twin_and_shallow.py [--ship twin-screws | twin-jets | shallow-water] [--runs 40]

Each draw adds white noise to positions, heading, velocities and yaw rate of every run and estimates all free
coefficients from zero. twin-screws: two zigzags, a turn and a run of kicks with shafts against each other and
rudders apart. twin-jets: the same of the published waterjet craft, with buckets down on one side and on both.
shallow-water: the same manoeuvres in deep water and at 1.5 draughts; the shares of the change of four
linear derivatives and of the resistance are free beside the hull's coefficients. Whatever is fixed is known. The ships
are in `problems.twin_ships`.
"""

import argparse
from collections.abc import Callable, Mapping

import numpy as np
from measure import Line, at_least, fastest
from roll_manoeuvring import SAMPLE, lines
from thrusters_truth import Draws, bound

from seatrial.core.equations import Model
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.problems.twin_ships import KnownTrials, shallow_water_trials, twin_jet_trials, twin_screw_trials

SETTINGS = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
SHIPS: Mapping[str, Callable[[], KnownTrials]] = {
    "twin-screws": twin_screw_trials, "twin-jets": twin_jet_trials, "shallow-water": shallow_water_trials,
}  # fmt: skip
STEPS, DT = 50_000, 0.1  # s
SPEED = 3.0  # million Runge-Kutta steps a second


def without_guess(truth: Model) -> Model:
    """Return the model with its free coefficients at zero."""
    return truth.with_values(dict.fromkeys(truth.parameters.free_names, 0.0))


def estimated(ship: KnownTrials, count: int) -> Draws:
    """Return what estimates of so many draws missed."""
    draws = Draws.of(ship.model, bound(ship.model, ship.length, ship.runs, ship.noise))
    draws.add(range(count), ship.noisy, without_guess(ship.model), ship.length, SETTINGS)
    return draws


def speed(model: Model, **held: float) -> float:
    """Return Runge-Kutta steps a second, in millions, of a ship whose rudder goes from side to side."""
    inputs = np.zeros((STEPS, len(model.inputs)))
    for name, value in held.items():
        inputs[:, model.input_names.index(name)] = value
    inputs[:, model.input_names.index("delta")] = np.radians(10.0) * np.sign(np.sin(0.02 * DT * np.arange(STEPS)))
    batch = SegmentBatch(model, inputs, np.array([0, STEPS]), DT, model.states)
    start = np.zeros((1, len(model.states)))
    start[0, 0] = 1.2
    values = model.parameters.values[None]
    return STEPS / fastest(lambda: batch.simulate(0, 1, start, values, np.empty((1, 0)))) / 1e6


def speed_lines() -> list[Line]:
    """Speed of both ships, and of the same method with one screw in deep water."""
    twin, shallow = twin_screw_trials().model, shallow_water_trials(depths=()).model
    return [
        at_least("mmg, one screw, deep: Runge-Kutta steps", speed(kvlcc2(), n=10.4), "M/s", SPEED),
        at_least("mmg_twin: Runge-Kutta steps", speed(twin, n=8.0, n_difference=1.0), "M/s", SPEED),
        at_least("mmg_shallow: Runge-Kutta steps", speed(shallow, n=10.4, depth=0.69), "M/s", SPEED),
    ]


def run() -> list[Line]:
    """A sample of the draws of two screws, and the speed of simulation."""
    return [*lines(estimated(twin_screw_trials(), SAMPLE)), *speed_lines()]


def main() -> None:
    """Print errors over the bound and coverage."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ship", choices=tuple(SHIPS), default="twin-screws")
    parser.add_argument("--runs", type=int, default=40)
    arguments = parser.parse_args()
    draws = estimated(SHIPS[arguments.ship](), arguments.runs)
    print("\n".join(draws.refusals))
    print(f"{'':12}{'true':>10}{'bound':>10}{'ratio':>8}{'z':>7}{'inside':>8}\n{draws.table()}")
    for line in [*lines(draws), *speed_lines()]:
        print(f"  {line.quantity:<60} {line.value:>8.3f} {line.verdict}")


if __name__ == "__main__":
    main()
