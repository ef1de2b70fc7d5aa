"""BlueBoat, leave one run out: errors of windows of 10 s of the runs left out, next to baselines without physics.

    python benchmarks/thrusters_blueboat.py [--window 10]

Model, priors and settings are those of examples/blueboat.toml; every run is left out once, all windows of it are
predicted open loop from a state estimated in their first second, and rms errors are averaged over the runs.
"""

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Record
from seatrial.data.trial import checked_records, load_trial
from seatrial.estimation.estimate import estimate_model
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.estimate.runs import training_runs
from seatrial.estimation.predict.black_box import (
    BlackBox,
    black_box_errors,
    constant_velocity,
    fit_black_box,
    linear_features,
    quadratic_features,
)
from seatrial.estimation.predict.horizon_errors import INITIAL_S, predict_windows
from seatrial.estimation.predict.open_loop import mean_nuisances

TRIAL = Path(__file__).parents[1] / "examples" / "blueboat.toml"
LIMITS = {"u": 0.11, "v": 0.06, "r": 0.045, "position_m": 1.0}
"""Mean over left-out runs to be reached at 10 s: m/s, m/s, rad/s, m."""


@dataclass(frozen=True)
class Row:
    """Errors of one predictor on one run left out."""

    predictor: str
    run: str
    scores: dict[str, float]


def black_box_scores(box: BlackBox, record: Record, window_s: float) -> dict[str, float]:
    """Return rms errors of a baseline on a run's windows."""
    errors = black_box_errors(box, [record], window_s, INITIAL_S)
    scores = {c: float(np.sqrt(np.mean(errors[c] ** 2))) for c in ("u", "v", "r")}
    scores["psi_deg"] = float(np.degrees(np.sqrt(np.mean(errors["psi"] ** 2))))
    return scores | {"position_m": float(np.sqrt(np.mean(errors["x0"] ** 2 + errors["y0"] ** 2)))}


def leave_one_run_out(window_s: float) -> list[Row]:
    """Return errors of the model and of each baseline on every run left out of its fit."""
    trial = load_trial(TRIAL)
    runs = training_runs(trial, checked_records(trial).records)
    settings = with_segment_seconds(trial.estimate, trial.model, runs)
    rows = []
    for left_out, record in enumerate(runs.records):
        began = time.perf_counter()
        kept = runs.selected([i for i in range(len(runs)) if i != left_out])
        estimation = estimate_model(trial.model, kept, settings)
        problem = estimation.estimate.problem
        nuisances = mean_nuisances(problem, estimation.estimate.common_parameters)
        windows = predict_windows(problem, estimation.model, [record], [nuisances], window_s)
        rows.append(Row("model", record.name, windows.rms()))
        inputs, dt = trial.model.input_names, record.dt
        boxes = {
            "constant velocity": constant_velocity(inputs, dt),
            "linear ARX": fit_black_box(kept.records, inputs, linear_features),
            "NARX ridge": fit_black_box(kept.records, inputs, quadratic_features),
        }
        rows += [Row(name, record.name, black_box_scores(box, record, window_s)) for name, box in boxes.items()]
        print(f"{record.name}: {time.perf_counter() - began:.0f} s", flush=True)
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--window", type=float, default=10.0, help="s")
    window_s = parser.parse_args().window
    rows = leave_one_run_out(window_s)
    columns = tuple(rows[0].scores)
    print(f"\nrms over windows of {window_s:g} s, mean over {len({r.run for r in rows})} runs left out")
    print(f"{'':20}" + "".join(f"{c:>12}" for c in columns))
    for predictor in dict.fromkeys(r.predictor for r in rows):
        means = [np.mean([r.scores[c] for r in rows if r.predictor == predictor]) for c in columns]
        print(f"{predictor:20}" + "".join(f"{m:12.3f}" for m in means))
    if window_s == 10.0:
        print(f"{'limit':20}" + "".join(f"{LIMITS[c]:12.3f}" if c in LIMITS else f"{'':12}" for c in columns))
    print("\nmodel, run by run")
    for row in rows:
        if row.predictor == "model":
            print(f"{row.run:20}" + "".join(f"{row.scores[c]:12.3f}" for c in columns))


if __name__ == "__main__":
    main()
