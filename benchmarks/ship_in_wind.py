"""The ship in wind: what each method errs by inside and outside the distribution of its training runs.

    python benchmarks/ship_in_wind.py [--draws 5] [--write DIR]

Rivals: ARX and NARX models and a small neural network of all outputs, which see the wind off the bow. Like them, the
network predicts the step of a second from ten seconds and runs freely; it is scikit-learn's, trained with seed 0, a
tenth of the samples kept to stop by. The fit begins at zero and GM 1 m and has
the equations of the truth, so that its errors are those of coefficients, of initial states and of what the sensors add.
--write keeps the records of the first draw as tables, in folders training, inside and outside, for other methods.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from measure import Line, at_most
from sklearn.neural_network import MLPRegressor
from thrusters_truth import write_table

from seatrial.core.values import Array, Record
from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.estimation.predict.windows import Windows
from seatrial.physics.models.published import s175
from seatrial.problems.ship_in_wind import (
    BEGINNING_S,
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


NETWORK = "neural network, 32 and 32"
# units of its layers, samples of the past, passes; the past is the best of 3, 10 and 20 by the first draw
LAYERS, LAGS, EPOCHS = (32, 32), 10, 400


@dataclass(frozen=True, eq=False)
class Network:
    """A network of the next step, what it sees and what it answers in standard deviations.

    Attributes:
        centre, scale: of what it sees, (k,); step: standard deviations of the steps, (channels,).
        limits: least and largest outputs of the training runs, where a prediction is held, (2, channels).
    """

    network: MLPRegressor
    centre: Array
    scale: Array
    step: Array
    limits: Array

    def predict(self, windows: Windows) -> list[Record]:
        """Return windows run freely behind their beginning."""
        y = np.stack([piece.matrix(OUTPUTS) for piece in windows.pieces])
        u = np.stack([seen_inputs(piece) for piece in windows.pieces])
        for k in range(round(BEGINNING_S / windows.dt), y.shape[1]):
            seen = (past(y, u, k) - self.centre) / self.scale
            y[:, k] = np.clip(y[:, k - 1] + self.step * self.network.predict(seen), *self.limits)
        return [
            Record.from_arrays(piece.name, piece.time, dict(zip(OUTPUTS, values.T, strict=True)))
            for piece, values in zip(windows.pieces, y, strict=True)
        ]


def seen_inputs(record: Record) -> Array:
    """Return orders, wind ahead and wind abeam, (n, 4)."""
    side = record["wind_direction"] - record["psi"]
    wind = record["wind_speed"] * np.stack([np.cos(side), np.sin(side)])
    return np.stack([record["n"], record["delta"], *wind], axis=1)


def past(y: Array, u: Array, k: int) -> Array:
    """Return outputs and inputs of the samples before row k, (windows, lags * channels)."""
    rows = slice(k - LAGS, k)
    return np.concatenate([y[:, rows].reshape(len(y), -1), u[:, rows].reshape(len(u), -1)], axis=1)


def network(training: Sequence[Record]) -> Network:
    """Return the network, trained on single steps."""
    y, u = np.stack([r.matrix(OUTPUTS) for r in training]), np.stack([seen_inputs(r) for r in training])
    rows = range(LAGS, y.shape[1])
    table = np.concatenate([past(y, u, k) for k in rows])
    steps = np.concatenate([y[:, k] - y[:, k - 1] for k in rows])
    centre, scale, step = table.mean(axis=0), table.std(axis=0), steps.std(axis=0)
    found = MLPRegressor(
        hidden_layer_sizes=LAYERS, activation="tanh", max_iter=EPOCHS, early_stopping=True, random_state=0
    )
    found.fit((table - centre) / scale, steps / step)
    return Network(found, centre, scale, step, np.stack([y.min(axis=(0, 1)), y.max(axis=(0, 1))]))


def predictors(records: WindRecords) -> Mapping[str, Predictor]:
    """Return the fit and its rivals, trained."""
    truth = ship_in_wind()
    unknown = dict.fromkeys(truth.parameters.free_names, 0.0) | {"GM": 1.0, "C_X1": -0.5, "C_Y1": -0.5}
    runs = Runs.one_session_each(list(records.training), s175().ship.length)
    estimation = estimate_model(truth.with_values(unknown), runs, SETTINGS)
    template = training_problem(truth, records)
    fit = partial(predicted_by, template, estimation.model)
    return {"fit": fit, **rivals(truth, records.training), NETWORK: network(records.training).predict}


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
