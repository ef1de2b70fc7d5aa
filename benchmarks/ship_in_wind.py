"""The ship in wind: what each method errs by inside and outside the distribution of its training runs.

    python benchmarks/ship_in_wind.py [--draws 5] [--write DIR]

Rivals: ARX and NARX models of all outputs, which see the wind off the bow. The fit begins at zero and GM 1 m and has
the equations of the truth, so that its errors are those of coefficients, of initial states and of what the sensors add.
--write keeps the records of the first draw as tables, in folders training, inside and outside, for other methods.
"""

import argparse
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from measure import Line, at_most
from thrusters_truth import write_table

from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.physics.models.published import s175
from seatrial.problems.ship_in_wind import (
    OUTPUTS,
    SETTINGS,
    Predictor,
    WindRecords,
    normalised,
    predicted_by,
    rivals,
    rms_behind_beginning,
    ship_in_wind,
    training_problem,
    wind_records,
    windows_of,
)

DRAWS = 5
SETS = ("inside", "outside")
LIMIT = 0.5
"""Error of the fit over that of the nearest rival, at most."""


def predictors(records: WindRecords) -> Mapping[str, Predictor]:
    """Return the fit and its rivals, trained."""
    truth = ship_in_wind()
    unknown = dict.fromkeys(truth.parameters.free_names, 0.0) | {"GM": 1.0, "C_X1": -0.5, "C_Y1": -0.5}
    runs = Runs.one_session_each(list(records.training), s175().ship.length)
    estimation = estimate_model(truth.with_values(unknown), runs, SETTINGS)
    template = training_problem(truth, records)
    fit = partial(predicted_by, template, estimation.model)
    return {"fit": fit, **rivals(truth, records.training)}


def errors(seed: int) -> dict[str, dict[str, tuple[float, dict[str, float]]]]:
    """Return method -> set -> normalised error and rms of each output, of one draw."""
    records = wind_records(ship_in_wind(), np.random.default_rng([3, seed]))
    tables: dict[str, dict[str, tuple[float, dict[str, float]]]] = {}
    for method, predict in predictors(records).items():
        for name in SETS:
            windows = windows_of(getattr(records, name))
            rms = rms_behind_beginning(windows, predict(windows))
            tables.setdefault(method, {})[name] = normalised(rms, windows), rms
    return tables


def lines(draws: Sequence[Mapping[str, Mapping[str, tuple[float, dict[str, float]]]]]) -> list[Line]:
    """Median normalised errors, and those of the fit over the nearest rival's."""
    found = []
    for name in SETS:
        medians = {m: float(np.median([d[m][name][0] for d in draws])) for m in draws[0]}
        found += [Line(f"{name}: {m}, error over the spread of the motion", value, "") for m, value in medians.items()]
        nearest = min(value for m, value in medians.items() if m != "fit")
        found.append(at_most(f"{name}: fit over its nearest rival", medians["fit"] / nearest, "", LIMIT))
    return found


def run() -> list[Line]:
    """One draw."""
    return lines([errors(0)])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=DRAWS)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if arguments.write:
        records = wind_records(ship_in_wind(), np.random.default_rng([3, 0]))
        for name in ("training", *SETS):
            (arguments.write / name).mkdir(parents=True, exist_ok=True)
            for record in getattr(records, name):
                write_table(record, arguments.write / name / f"{record.name}.csv")
    draws = [errors(seed) for seed in range(arguments.draws)]
    for method, sets in draws[0].items():
        for name, (_, rms) in sets.items():
            print(f"  {method:<28}{name:<9}" + "".join(f"{output} {rms[output]:<10.4g}" for output in OUTPUTS))
    for line in lines(draws):
        print(f"  {line.quantity:<64} {line.value:>8.3f} {line.verdict}")


if __name__ == "__main__":
    main()
