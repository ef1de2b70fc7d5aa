"""milliAmpere: second halves of two runs predicted in windows, compared with standing still and going straight on.

    python benchmarks/thrusters_milliampere.py

The trial is examples/milliampere.toml: raw topics, four azimuths, the first half of each run trains. The state of a
window is estimated in its first second; rms over all windows of both second halves.
"""

from pathlib import Path

import numpy as np

from seatrial.core.values import Record
from seatrial.data.trial import Role, checked_records, load_trial
from seatrial.estimation.estimate import estimate_model
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.estimation.predict.window_scores import Predictor, pooled_rms, window_baselines
from seatrial.estimation.predict.windows import Windows, like_window

TRIAL = Path(__file__).parents[1] / "examples" / "milliampere.toml"
WINDOWS_S = (10.0, 30.0)
"""Lengths of windows [s]."""
INITIAL_S = 1.0
"""Length of a window's beginning from which its state is estimated [s]."""


def scores(windows: Windows, predict: Predictor) -> dict[str, float]:
    """Return rms errors over all windows: u, v [m/s], heading [deg], position [m]."""
    predicted = predict(windows, INITIAL_S)
    groups = {"u": ("u",), "v": ("v",), "psi_deg": ("psi",), "position_m": ("x0", "y0")}
    rms = {
        name: pooled_rms(windows.pieces, predicted, channels) if set(channels) <= set(predicted[0].channels) else np.nan
        for name, channels in groups.items()
    }
    return rms | {"psi_deg": float(np.degrees(rms["psi_deg"]))}


def standing_still(windows: Windows, seconds: float) -> list[Record]:
    """Return windows that stay at the mean pose of their first seconds."""
    held = []
    for piece in windows.pieces:
        first = piece.time - piece.time[0] <= seconds
        pose = {c: np.full(len(piece), np.nanmean(piece[c][first])) for c in ("psi", "x0", "y0")}
        held.append(like_window(piece, pose | {c: np.zeros(len(piece)) for c in ("u", "v") if c in piece}))
    return held


def main() -> None:
    """Print the table."""
    trial = load_trial(TRIAL)
    checked = checked_records(trial).records
    fit = estimate_model(trial.model, training_runs(trial, checked), trial.estimate)
    problem = fit.estimate.problem

    def model(windows: Windows, seconds: float) -> list[Record]:
        offsets = np.stack([new_session_offsets(fit.estimate, record).expected for record in windows.records])
        return [run.record for run in open_loop_runs(problem, fit.model, windows, offsets, seconds)]

    train = [r.record for r in checked if r.role is Role.TRAIN]
    predictors: dict[str, Predictor] = {"model": model, "constant position": standing_still}
    predictors |= window_baselines(problem, trial.model, train, INITIAL_S)
    print("coefficients: " + ", ".join(
        f"{n} {v:.3g} ({e:.1g})"
        for n, v, e in zip(problem.free, fit.estimate.common_parameters, fit.interval.standard_error, strict=False)
    ))  # fmt: skip
    for length in WINDOWS_S:
        windows = Windows.cut([r.record for r in checked if r.role is Role.VALIDATE], length)
        rows = {name: scores(windows, predict) for name, predict in predictors.items()}
        columns = list(next(iter(rows.values())))
        print(f"\n{len(windows)} windows of {length:g} s" + "".join(f"{c:>12}" for c in columns))
        for name, row in rows.items():
            print(f"{name:28}" + "".join(f"{row[c]:12.4f}" for c in columns))


if __name__ == "__main__":
    main()
