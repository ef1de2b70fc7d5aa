"""Predictions to beat: constant course and speed, no motion, unfitted coefficients, regressions without physics."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.predict.auto_regression import fit_auto_regression, linear_features, quadratic_features
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.window_scores import Predictor
from seatrial.estimation.predict.windows import Windows, like_window
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.sensors.measured_outputs import SENSOR_SOURCE

CONSTANT_COURSE, AT_REST, STAYS = "constant course and speed", "no motion", "stays where it is"
UNFITTED, ARX, NARX = "prior coefficients, unfitted", "ARX", "NARX"


def window_baselines(
    template: OutputError, model: Model, train: Sequence[Record], seconds: float
) -> Mapping[str, Predictor]:
    """Return the baselines that these training runs allow, by name.

    seconds: of a window's beginning, for its initial state; ten times as long are the windows that regressions are
    chosen by.
    """
    without_fit: Mapping[str, Callable[[Record, float], Record]] = (
        {CONSTANT_COURSE: constant_course, STAYS: stays} if "psi" in model.states else {AT_REST: at_rest}
    )
    baselines: dict[str, Predictor] = {name: partial(_each, predict) for name, predict in without_fit.items()}
    expected = prior_means(model)
    if expected:
        baselines[UNFITTED] = partial(_unfitted, template, model.with_values(expected))
    for name, features in ((ARX, linear_features), (NARX, quadratic_features)):
        regression = fit_auto_regression(model, train, features, seconds)
        if regression is not None:
            baselines[name] = regression.predict
    return baselines


def prior_means(model: Model) -> dict[str, float]:
    """Return the means of all priors where every free coefficient of the craft itself has one; else nothing.

    Start values are no knowledge of a craft, and priors of its instruments alone say nothing of how it moves.
    """
    priors = {p.name: p.prior.mean for p in model.parameters.free if p.prior is not None}
    of_craft = {p.name for p in model.parameters.free if p.source != SENSOR_SOURCE}
    return priors if of_craft and of_craft <= priors.keys() else {}


def _each(predict: Callable[[Record, float], Record], windows: Windows, seconds: float) -> list[Record]:
    return [predict(piece, seconds) for piece in windows.pieces]


def _unfitted(template: OutputError, model: Model, windows: Windows, seconds: float) -> list[Record]:
    nothing = np.zeros((len(windows.records), template.unknowns_per_session))
    return [run.record for run in open_loop_runs(template, model, windows, nothing, seconds)]


def at_rest(window: Record, seconds: float) -> Record:
    """Return a window in which nothing moves; `seconds` are not used."""
    del seconds
    return like_window(window, {c: np.zeros(len(window)) for c in window.channels})


def stays(window: Record, seconds: float) -> Record:
    """Return a window in which the craft keeps the mean place and heading of its first seconds, without speed."""
    first = window.time - window.time[0] <= max(seconds, 2.0 * window.dt)
    kept = {c: np.full(len(window), _mean(window[c][first])) for c in ("psi", "x0", "y0") if c in window}
    return like_window(window, kept | {c: np.zeros(len(window)) for c in ("u", "v", "r") if c in window})


def constant_course(window: Record, seconds: float) -> Record:
    """Return a window straight on: heading, speed and velocity over ground are means over its first seconds."""
    time = window.time - window.time[0]
    first = time <= max(seconds, 2.0 * window.dt)
    values = {c: np.full(len(window), _mean(window[c][first])) for c in ("psi", "u", "v") if c in window}
    if "r" in window:
        values["r"] = np.zeros(len(window))
    for c in ("x0", "y0"):
        measured = first & np.isfinite(window[c]) if c in window else np.zeros(len(window), bool)
        if np.count_nonzero(measured) >= 2:
            values[c] = np.polyval(np.polyfit(time[measured], window[c][measured], 1), time)
    return like_window(window, values)


def _mean(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return float(np.mean(finite)) if len(finite) else float("nan")
