"""Station keeping on a craft that is known: tuned on the identified craft, tried on the true one.

    python benchmarks/station.py [--model results/station/model.toml] [--write DIR]

The craft has a thruster at each corner, set at 45 degrees to the bow; its coefficients are chosen, and its runs are
steps of all commands with a small craft's noise: those of examples/station, which --write makes anew. Printed are the
circle that holds the craft 95 % of the time, its rms distance and that of its heading: by linear theory, by the
identified craft, by the true one under the same controller, and by the true one under the controller tuned on it.
"""

import argparse
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from thrusters_truth import write_table

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.station.craft import StationCraft, generalised_inverse
from seatrial.control.station.station_loop import StationLoop, station_point
from seatrial.control.station.trial import StationSetting, StationSimulator
from seatrial.control.station.tune_station import station_craft, station_disturbances, tune_station
from seatrial.control.task import StationDemand, TuningTask
from seatrial.core.results.station import StationKeeping, StationTrial
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.thruster_layout import CommandInput, Damping, Thruster, ThrusterLayout
from seatrial.physics.simulate.craft_control import StationController, StationGains
from seatrial.problems.thruster_craft import KnownThrusterCraft, noisy, simulated_runs

ROOT = Path(__file__).parents[1]
SEED = 1
"""Of the runs and their noise."""


def cross_drive() -> KnownThrusterCraft:
    """Return the craft: 1.2 m, 50 kg, thrusters of 60 N; values chosen."""
    # forward and to starboard of the origin [m]
    x, y = 0.45, 0.35
    corners = (("port_bow", x, -y, 1), ("starboard_bow", x, y, -1), ("starboard_stern", -x, y, 1),
               ("port_stern", -x, -y, -1))  # fmt: skip
    # thrust at full command [N], length [m], mass [kg]
    bollard, length, mass = 60.0, 1.2, 50.0
    four = tuple(
        Thruster(name, x, y, CommandInput(f"command_{k}"), side * math.pi / 4.0, bollard=bollard if k == 1 else 0.0,
                 same_as="" if k == 1 else "port_bow")
        for k, (name, x, y, side) in enumerate(corners, start=1)
    )  # fmt: skip
    values = {
        "tau": 0.3, "tau_down": 0.2, "k_b": 45.0, "p_f": 1.8, "p_b": 1.6, "k_J": 0.8, "k_4": 0.05, "X_u": -8.0,
        "X_uu": -30.0, "Y_v": -20.0, "Y_vv": -90.0, "N_r": -5.0, "N_rr": -6.0, "N_ur": -6.0, "N_uv": 12.0,
        "Y_uv": -30.0, "Y_NT": 0.0, "M_u": 60.0, "M_v": 90.0, "M_r": 9.0,
    }  # fmt: skip
    ranges = {f"command_{k}": (-0.8, 0.8) for k in range(1, 5)}
    return KnownThrusterCraft(ThrusterLayout(four, Damping.FULL, length, mass), values, ranges)


def tried_on(own: StationCraft, made: StationKeeping, task: TuningTask, demand: StationDemand) -> StationTrial:
    """Return the trial of a craft under the controller of another, rebuilt from what the tuning says of it."""
    inverse = np.concatenate([one.inverse for one in made.thrusters])
    gains = StationGains(made.KP, made.KI, made.KD, made.filter_lag)
    sampling = Sampling(made.sample_s, demand.dead_time)
    controller = StationController(gains, sampling, made.thrusters)
    loop = StationLoop(
        station_point(own, demand.current, 0.0, inverse),
        gains,
        inverse,
        made.dead_time,
        np.ones(len(inverse)),
        np.ones(1),
    )
    setting = StationSetting(demand.current, made.trial.directions, station_disturbances(task, demand, own))
    return StationSimulator(loop, controller, setting, 0).respond(0)


def main() -> None:
    """Print what the tuning predicts and what the true craft does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--model", type=Path, default=ROOT / "results" / "station" / "model.toml")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    craft, rng = cross_drive(), np.random.default_rng(SEED)
    if arguments.write:
        arguments.write.mkdir(parents=True, exist_ok=True)
        for run in simulated_runs(craft, rng):
            write_table(noisy(run, rng), arguments.write / f"{run.name}.csv")
        return
    task = tuning_task(ROOT / "examples" / "station_keeping.toml", model_file=arguments.model)
    demand = task.station
    assert demand is not None
    made = tune_station(task, demand, 0, print)
    true = StationCraft(craft.truth, np.empty((0, 0)), demand.limit)
    on_true = tried_on(true, made, task, demand)
    best = tune_station(task, replace(demand, model=craft.truth, covariance=np.empty((0, 0))), 0, print)
    off = np.abs(made.KP - best.KP).max() / best.KP.max()
    print(f"{'':44}{'radius, m':>10}{'rms, m':>10}{'heading, deg':>14}")
    expected = made.predicted
    print(f"{'linear theory':44}{'':10}{expected.position:10.3f}{math.degrees(expected.heading):14.2f}")
    for name, trial in (
        ("identified craft", made.trial), ("true craft, same controller", on_true), ("true craft, its own", best.trial)
    ):  # fmt: skip
        print(f"{name:44}{trial.radius:10.3f}{trial.position:10.3f}{math.degrees(trial.heading):14.2f}")
    print(f"K_p is {100.0 * off:.2f} % off that of the true craft, the least current held "
          f"{100.0 * (made.capability.current.min() / best.capability.current.min() - 1.0):+.2f} %")  # fmt: skip
    assert np.allclose(generalised_inverse(station_craft(demand)), generalised_inverse(true), rtol=0.01, atol=1e-3)


if __name__ == "__main__":
    main()
