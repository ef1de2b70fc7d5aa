"""BlueBoat, leave one run out: errors of windows of 10 s of the runs left out, next to baselines without physics.

    python benchmarks/thrusters_blueboat.py [--window 10] [--free N_uv]

Model, priors and settings are those of examples/blueboat.toml; every run is left out once, all windows of it are
predicted open loop from a state estimated in their first second, and rms errors are averaged over the runs. --free
estimates coefficients that the example holds.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import Line, at_most

from seatrial.core.values import InputError, Record
from seatrial.data.trial import checked_records, load_trial
from seatrial.estimation.estimate import estimate_model
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.estimate.fit import Estimation, with_segment_seconds
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.estimation.predict.window_scores import Predictor, pooled_rms, window_baselines
from seatrial.estimation.predict.windows import Windows

TRIAL = Path(__file__).parents[1] / "examples" / "blueboat.toml"
LIMITS = {"u": 0.11, "v": 0.06, "r": 0.045, "position_m": 1.0}
"""Mean over left-out runs to be reached at 10 s: m/s, m/s, rad/s, m."""
WINDOW_S = 10.0  # s, the length for which the limits stand
INITIAL_S = 1.0
"""Length of a window's beginning from which its state is estimated [s]."""


@dataclass(frozen=True)
class Row:
    """Errors of one predictor on one run left out."""

    predictor: str
    run: str
    scores: dict[str, float]


def scores(windows: Windows, predict: Predictor) -> dict[str, float]:
    """Return rms errors over all windows: u, v [m/s], r [rad/s], heading [deg], position [m]."""
    predicted = predict(windows, INITIAL_S)
    rms = {c: pooled_rms(windows.pieces, predicted, (c,)) for c in ("u", "v", "r")}
    rms["psi_deg"] = float(np.degrees(pooled_rms(windows.pieces, predicted, ("psi",))))
    return rms | {"position_m": pooled_rms(windows.pieces, predicted, ("x0", "y0"))}


def leave_one_run_out(window_s: float, further: Sequence[str] = ()) -> list[Row]:
    """Return errors of the model and of each baseline on every run left out of its fit; further: coefficients freed."""
    trial = load_trial(TRIAL)
    trial = replace(trial, model=trial.model.with_parameters(trial.model.parameters.freed(*further)))
    runs = training_runs(trial, checked_records(trial).records)
    settings = with_segment_seconds(trial.estimate, trial.model, runs)
    rows = []
    for left_out, record in enumerate(runs.records):
        began = time.perf_counter()
        kept = runs.selected([i for i in range(len(runs)) if i != left_out])
        estimation = estimate_model(trial.model, kept, settings)

        def model(windows: Windows, seconds: float, fit: Estimation = estimation) -> list[Record]:
            found = fit.estimate
            offsets = np.stack([new_session_offsets(found, record).expected for record in windows.records])
            return [run.record for run in open_loop_runs(found.problem, fit.model, windows, offsets, seconds)]

        predictors = {"model": model} | window_baselines(
            estimation.estimate.problem, trial.model, kept.records, INITIAL_S
        )
        windows = Windows.cut([record], window_s)
        rows += [Row(name, record.name, scores(windows, predict)) for name, predict in predictors.items()]
        print(f"{record.name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
    return rows


def run() -> list[Line]:
    """Errors at 10 s of runs left out, mean over them, beside their limits; no line without the records."""
    try:
        rows = leave_one_run_out(WINDOW_S)
    except InputError as error:
        print(error, file=sys.stderr)
        return []
    mine = [r.scores for r in rows if r.predictor == "model"]
    units = {"position_m": "m", "u": "m/s", "v": "m/s", "r": "rad/s"}
    return [
        at_most(f"{c.removesuffix('_m')} at 10 s, mean of runs left out", float(np.mean([m[c] for m in mine])), unit,
                LIMITS[c])
        for c, unit in units.items()
    ]  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--window", type=float, default=WINDOW_S, help="s")
    parser.add_argument("--free", nargs="*", default=(), metavar="NAME", help="coefficients that the example holds")
    arguments = parser.parse_args()
    window_s = arguments.window
    rows = leave_one_run_out(window_s, arguments.free)
    columns = tuple(rows[0].scores)
    print(f"\nrms over windows of {window_s:g} s, mean over {len({r.run for r in rows})} runs left out")
    print(f"{'':20}" + "".join(f"{c:>12}" for c in columns))
    for predictor in dict.fromkeys(r.predictor for r in rows):
        means = [np.mean([r.scores[c] for r in rows if r.predictor == predictor]) for c in columns]
        print(f"{predictor:20}" + "".join(f"{m:12.3f}" for m in means))
    if window_s == WINDOW_S:
        print(f"{'limit':20}" + "".join(f"{LIMITS[c]:12.3f}" if c in LIMITS else f"{'':12}" for c in columns))
    print("\nmodel, run by run")
    for row in rows:
        if row.predictor == "model":
            print(f"{row.run:20}" + "".join(f"{row.scores[c]:12.3f}" for c in columns))


if __name__ == "__main__":
    main()
