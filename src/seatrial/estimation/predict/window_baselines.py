"""Predictions to beat: constant course and speed, coefficients that were not fitted, and ARX."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record, RecordKind
from seatrial.estimation.predict.open_loop import simulate_while_bounded
from seatrial.estimation.predict.window_scores import Predictor
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.simulate.channels import inputs_of

CONSTANT_COURSE, AT_REST = "constant course and speed", "no motion"
UNFITTED, ARX = "prior coefficients, unfitted", "ARX"
ARX_ORDER = 2
"""Past samples of outputs and inputs in ARX, as in Ljung 1999, System Identification, eq. (4.7); chosen."""
_RATES = ("u", "v", "r", "p", "q", "w")
_INTEGRALS = {"psi": "r", "phi": "p", "theta": "q", "z": "w"}


def window_baselines(template: OutputError, model: Model, train: Sequence[Record]) -> Mapping[str, Predictor]:
    """Return the baselines that these training runs allow, by name."""
    is_steered = "psi" in model.states
    baselines: dict[str, Predictor] = {CONSTANT_COURSE: constant_course} if is_steered else {AT_REST: at_rest}
    priors = {p.name: p.prior.mean for p in model.parameters.free if p.prior is not None}
    if priors:
        unfitted = model.with_values(priors)
        nothing = np.zeros(template.unknowns_per_session)
        baselines[UNFITTED] = lambda w, s: simulate_while_bounded(template, unfitted, w, nothing, s).record
    arx = fit_arx(model, train)
    if arx is not None:
        baselines[ARX] = arx.predict
    return baselines


def at_rest(window: Record, seconds: float) -> Record:
    """Return a window in which nothing moves; `seconds` are not used."""
    del seconds
    return _like(window, {c: np.zeros(len(window)) for c in window.channels})


def constant_course(window: Record, seconds: float) -> Record:
    """Return a window straight on: heading, speed and velocity over ground are means over its first seconds."""
    time = window.time - window.time[0]
    first = time <= max(seconds, 2.0 * window.dt)
    values = {c: np.full(len(window), _mean(window[c][first])) for c in ("psi", "u", "v") if c in window}
    if "r" in window:
        values["r"] = np.zeros(len(window))
    for c in ("x0", "y0"):
        known = first & np.isfinite(window[c]) if c in window else np.zeros(len(window), bool)
        if np.count_nonzero(known) >= 2:
            values[c] = np.polyval(np.polyfit(time[known], window[c][known], 1), time)
    return _like(window, values)


@dataclass(frozen=True, eq=False)
class AutoRegression:
    """y(t) = sum of A_i y(t - i) + B_i u(t - i) + c of several channels; `weights`: (rows, channels)."""

    model: Model
    channels: tuple[str, ...]
    weights: Array

    def predict(self, window: Record, seconds: float) -> Record:
        """Return a window simulated from its first samples alone; heading and track follow from the rates."""
        y, u = window.matrix(self.channels).copy(), inputs_of(self.model, window)
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(ARX_ORDER, len(y)):
                y[k] = _regressors(y, u, k) @ self.weights
        values = dict(zip(self.channels, y.T, strict=True))
        for angle, rate in _INTEGRALS.items():
            if angle in window and rate in values:
                values[angle] = _mean(window[angle][:1]) + _integral(values[rate], window.dt)
        if {"psi", "u"} <= set(values) and {"x0", "y0"} <= set(window.channels):
            values |= _track(window, values, seconds)
        return _like(window, values)


def fit_arx(model: Model, train: Sequence[Record]) -> AutoRegression | None:
    """Return ARX of the velocities and rates that all runs hold, by least squares; None where there are none."""
    channels = tuple(c for c in _RATES if all(c in r and np.isfinite(r[c]).all() and np.ptp(r[c]) > 0.0 for r in train))
    if not channels:
        return None
    rows, targets = [], []
    for record in train:
        y, u = record.matrix(channels), inputs_of(model, record)
        rows += [_regressors(y, u, k) for k in range(ARX_ORDER, len(y))]
        targets.append(y[ARX_ORDER:])
    return AutoRegression(model, channels, np.linalg.lstsq(np.array(rows), np.concatenate(targets), rcond=None)[0])


def _regressors(y: Array, u: Array, k: int) -> Array:
    past = slice(k - ARX_ORDER, k)
    return np.concatenate([y[past].ravel(), u[past].ravel(), [1.0]])


def _integral(rate: Array, dt: float) -> Array:
    return np.concatenate([[0.0], np.cumsum(0.5 * dt * (rate[1:] + rate[:-1]))])


def _track(window: Record, values: Mapping[str, Array], seconds: float) -> dict[str, Array]:
    del seconds
    psi, u, v = values["psi"], values["u"], values.get("v", np.zeros(len(window)))
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    starts = (_mean(window[c][:1]) for c in ("x0", "y0"))
    return {c: s + _integral(w, window.dt) for c, s, w in zip(("x0", "y0"), starts, (north, east), strict=True)}


def _mean(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return float(np.mean(finite)) if len(finite) else float("nan")


def _like(window: Record, values: Mapping[str, Array]) -> Record:
    channels = {c: window.channel(c).with_values(v) for c, v in values.items() if c in window}
    return replace(window, channels=channels, kind=RecordKind.SIMULATED)
