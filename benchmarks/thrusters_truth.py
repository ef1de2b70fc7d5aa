"""Two fixed thrusters, simulated truth: errors of every coefficient over the Cramer-Rao bound, and coverage.

    python benchmarks/thrusters_truth.py [--runs 400] [--write DIR]

Three runs of steps of both thrusters (60 s at 10 Hz); each draw adds white noise to all six channels, estimates all
free coefficients without a guess and without priors, and notes whether the 95 % intervals hold. --write keeps the
records of the first draw as CSV files, those of examples/thrusters.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import replay

NOISE = {"u": 0.03, "v": 0.03, "r": 0.01, "psi": 0.01, "x0": 0.1, "y0": 0.1}
"""Standard deviations: m/s, m/s, rad/s, rad, m, m; of a small craft's receiver and compass."""
TRUTH = {
    "tau": 0.3, "tau_down": 0.15, "k_f": 1.6, "k_b": 1.1, "p_f": 1.6, "p_b": 1.4, "k_J": 0.15, "k_4": 0.05,
    "X_u": -0.1, "X_uu": -0.3, "Y_v": -0.6, "Y_vv": -1.5, "N_r": -0.1, "N_rr": -0.2, "N_ur": -0.2, "Y_uv": -0.5,
    "Y_NT": 0.1, "M_v": 1.6, "M_r": 0.15,
}  # fmt: skip
SETTINGS = EstimateSettings(method=FitCriterion.OUTPUT_ERROR)
SECONDS, STEP_S, DT = 60, 3, 0.1


def truth() -> Model:
    """Return the model with the true coefficients."""
    return model_named("thrusters").with_values(TRUTH)


def simulated_runs(model: Model, rng: np.random.Generator, count: int = 3) -> list[Record]:
    """Return runs of steps of both thrusters, without noise."""
    runs = []
    for k in range(count):
        commands = np.repeat(rng.uniform(-1.0, 1.0, size=(SECONDS // STEP_S, 2)), round(STEP_S / DT), axis=0)
        inputs = {"command_1": commands[:, 0], "command_2": commands[:, 1]}
        planned = Record.from_arrays(f"run_{k + 1}", DT * np.arange(len(commands)), inputs)
        start = dict.fromkeys(model.states, 0.0) | {"c_port": commands[0, 0], "c_starboard": commands[0, 1]}
        run = replay(model, planned, start)
        runs.append(replace(run, channels={n: run.channel(n) for n in (*NOISE, *inputs)}))
    return runs


def noisy(run: Record, rng: np.random.Generator) -> Record:
    """Return what instruments record of a run."""
    channels = dict(run.channels)
    for name, spread in NOISE.items():
        channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
    return replace(run, channels=channels)


def bound(model: Model, runs: list[Record]) -> Array:
    """Return the Cramer-Rao bound of each free coefficient at the truth: standard deviations, (free,)."""
    problem = output_error_problem(model, Runs.one_session_each(runs, 1.0), np.inf, SETTINGS)
    problem = replace(problem, noise=np.array([NOISE[c] for c in problem.data.outputs]))
    information = problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1]
    return np.sqrt(np.diag(np.linalg.inv(information)))


def write_table(record: Record, path: Path) -> None:
    """Write time and channels as a table with one header line, five significant digits."""
    columns = np.column_stack([record.time, *(c.values for c in record.channels.values())])
    np.savetxt(path, columns, "%.5g", ",", header=",".join(("time", *record.channels)), comments="")


def main() -> None:
    """Print errors over the bound and coverage."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    model = truth()
    clean = simulated_runs(model, np.random.default_rng(1))
    spread = bound(model, clean)
    names = model.parameters.free_names
    true = np.array([model.parameters[n].value for n in names])
    errors, held, failures = [], [], 0
    for k in range(arguments.runs):
        rng = np.random.default_rng([1, k])
        records = [noisy(run, rng) for run in clean]
        if k == 0 and arguments.write:
            arguments.write.mkdir(parents=True, exist_ok=True)
            for record in records:
                write_table(record, arguments.write / f"{record.name}.csv")
        try:
            estimation = estimate_model(
                model_named("thrusters"), Runs.one_session_each(records, 1.0), SETTINGS,
                EstimatorOptions(),
            )  # fmt: skip
        except InputError as error:
            failures += 1
            print(f"draw {k}: {error}")
            continue
        found = estimation.estimate.common_parameters[: len(names)]
        deviation = np.sqrt(np.diag(estimation.interval.covariance))[: len(names)]
        errors.append((found - true) / spread)
        held.append(np.abs(found - true) <= stdtrit(estimation.interval.degrees_of_freedom, 0.975) * deviation)
        if (k + 1) % 20 == 0:
            ratio = np.sqrt(np.mean(np.square(errors), axis=0))
            print(f"{k + 1} draws: median RMSE/bound {np.median(ratio):.3f}, coverage {np.mean(held):.3f}", flush=True)
    ratio, coverage = np.sqrt(np.mean(np.square(errors), axis=0)), np.mean(held, axis=0)
    for row in zip(names, true, spread, ratio, coverage, strict=True):
        print("{:10}{:10.4g}{:10.2g}{:8.3f}{:8.3f}".format(*row))
    outside = int(np.sum(np.max(np.abs(errors), axis=1) > 8.0))  # bounds: no draw of a normal law goes that far
    print(f"median RMSE/bound {np.median(ratio):.3f}, pooled coverage {np.mean(coverage):.3f}; "
          f"{outside} draws in another optimum, {failures} without an estimate")  # fmt: skip


if __name__ == "__main__":
    main()
