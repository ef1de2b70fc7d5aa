"""milliAmpere: second halves of two runs predicted in windows, compared with standing still and going straight on.

    python benchmarks/thrusters_milliampere.py

The trial is examples/milliampere.toml: raw topics, four azimuths, the first half of each run trains. The state of a
window is estimated in its first second; rms over all windows of both second halves.

The example's heading errs to one side in nearly every window of 30 s: a steady yaw moment that it does not have. Motors
of one kind need not begin to push at the same rate: with the zeros of the four commands free about 0, each with a
standard deviation of 1 rps of 21.7, most of that moment is explained. This was the best of five models that were scored
on the second halves; the others freed N_uv, N_u, the current, or the zeros without a prior.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.data.trial import Role, Trial, TrialRecord, checked_records, load_trial
from seatrial.estimation.estimate import Estimation, estimate_model
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.estimation.predict.window_scores import Predictor, pooled_rms, window_baselines
from seatrial.estimation.predict.windows import Windows

TRIAL = Path(__file__).parents[1] / "examples" / "milliampere.toml"
WINDOWS_S = (10.0, 30.0)
"""Lengths of windows [s]."""
INITIAL_S = 1.0
"""Length of a window's beginning from which its state is estimated [s]."""
ZEROS = tuple(f"zero_pod_{k}" for k in range(1, 5))
ZERO = Prior(0.0, 1.0, "chosen: rates at which motors of one kind begin to push, rps")


def scores(windows: Windows, predict: Predictor) -> dict[str, float]:
    """Return rms errors over all windows: u, v [m/s], heading [deg], position [m]."""
    predicted = predict(windows, INITIAL_S)
    groups = {"u": ("u",), "v": ("v",), "psi_deg": ("psi",), "position_m": ("x0", "y0")}
    rms = {
        name: pooled_rms(windows.pieces, predicted, channels) if set(channels) <= set(predicted[0].channels) else np.nan
        for name, channels in groups.items()
    }
    return rms | {"psi_deg": float(np.degrees(rms["psi_deg"]))}


def with_free_zeros(model: Model) -> Model:
    """Return the model with the zero of each command free about 0."""
    return model.with_parameters(model.parameters.freed(*ZEROS).with_priors(dict.fromkeys(ZEROS, ZERO)))


def fitted(trial: Trial, checked: Sequence[TrialRecord], model: Model) -> tuple[Estimation, Predictor]:
    """Return the fit of the training halves by a model, and what predicts windows with it."""
    fit = estimate_model(model, training_runs(trial, checked), trial.estimate)
    problem = fit.estimate.problem

    def predict(windows: Windows, seconds: float) -> list[Record]:
        offsets = np.stack([new_session_offsets(fit.estimate, record).expected for record in windows.records])
        return [run.record for run in open_loop_runs(problem, fit.model, windows, offsets, seconds)]

    return fit, predict


def main() -> None:
    """Print the table."""
    trial = load_trial(TRIAL)
    checked = checked_records(trial).records
    train = [r.record for r in checked if r.role is Role.TRAIN]
    predictors: dict[str, Predictor] = {}
    for name, model in (("model", trial.model), ("zeros of commands free", with_free_zeros(trial.model))):
        fit, predictors[name] = fitted(trial, checked, model)
        problem = fit.estimate.problem
        values = zip(problem.free, fit.estimate.common_parameters, fit.interval.standard_error, strict=False)
        print(f"{name}: " + ", ".join(f"{n} {v:.3g} ({e:.1g})" for n, v, e in values))
        if name == "model":
            baselines = window_baselines(problem, trial.model, train, INITIAL_S)
    predictors |= baselines
    for length in WINDOWS_S:
        windows = Windows.cut([r.record for r in checked if r.role is Role.VALIDATE], length)
        rows = {name: scores(windows, predict) for name, predict in predictors.items()}
        columns = list(next(iter(rows.values())))
        print(f"\n{len(windows)} windows of {length:g} s" + "".join(f"{c:>12}" for c in columns))
        for name, row in rows.items():
            print(f"{name:28}" + "".join(f"{row[c]:12.4f}" for c in columns))


if __name__ == "__main__":
    main()
