"""Baselines without physics: constant velocity, regressions of the next velocities on the last ones and the commands.

Scored on the same windows as a model, so that its errors can be judged: what a model does not predict better than these
it does not know. ARX and NARX: Ljung 1999, System Identification, sections 4.2 and 5.4; run freely, not one step ahead.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index, Record
from seatrial.estimation.predict.holdout_windows import HoldoutProtocol, split_windows

VELOCITIES = ("u", "v", "r")
_LAG_S = 0.5
"""Length of the past that a regression sees [s]: several time constants of a small craft's thrusters; chosen."""
_PENALTIES = tuple(10.0**k for k in range(-2, 6))
"""Ridge penalties tried on standardised features; the one that predicts training windows best, run freely, is taken."""
_CHOICE_S = 10.0
"""Length of the training windows by which the penalty is chosen [s]; chosen."""

Features = Callable[[Array, Array], Array]
"""Past velocities (n, 3 lags) and commands (n, nu lags) -> features (n, k)."""


def linear_features(velocities: Array, commands: Array) -> Array:
    """Return the past as it is: an ARX model."""
    return np.concatenate([velocities, commands], axis=1)


def quadratic_features(velocities: Array, commands: Array) -> Array:
    """Return the past, its signed squares and the products of the last sample's values: a NARX model."""
    past = np.concatenate([velocities, commands], axis=1)
    last = np.concatenate([velocities[:, :3], commands[:, : commands.shape[1]]], axis=1)
    upper = np.triu_indices(last.shape[1])
    products = last[:, upper[0]] * last[:, upper[1]]
    return np.concatenate([past, past * np.abs(past), products], axis=1)


@dataclass(frozen=True, eq=False)
class BlackBox:
    """A regression of the next velocities, fitted to training runs; without features they stay as they are.

    Attributes:
        inputs: channels of the commands; lags: samples of the past that it sees.
        centre, scale, weights: of the standardised features, (k,), (k,), (k + 1, 3).
        limits: least and largest velocities of the training runs, where a prediction that runs away is held, (2, 3).
    """

    inputs: tuple[str, ...]
    lags: int
    features: Features | None
    centre: Array
    scale: Array
    weights: Array
    limits: Array

    def run(self, velocities: Array, commands: Array, beginning: int) -> Array:
        """Return velocities (windows, n, 3): as measured up to sample `beginning`, then from commands and its own.

        velocities: (windows, n, 3); commands: (windows, n, inputs).
        """
        y = velocities.copy()
        if self.features is None:
            y[:, beginning:] = y[:, beginning - self.lags : beginning].mean(axis=1, keepdims=True)
            return y
        for k in range(beginning, y.shape[1]):
            past = [a[:, k - self.lags : k][:, ::-1].reshape(len(y), -1) for a in (y, commands)]
            y[:, k] = np.clip(y[:, k - 1] + self._step(self.features(past[0], past[1])), *self.limits)
        return y

    def _step(self, features: Array) -> Array:
        scaled = (features - self.centre) / self.scale
        return scaled @ self.weights[:-1] + self.weights[-1]


def constant_velocity(inputs: Sequence[str], dt: float) -> BlackBox:
    """Return the baseline that keeps the mean velocities of the last half second."""
    return BlackBox(tuple(inputs), _lags(dt), None, np.zeros(0), np.ones(0), np.zeros((1, 3)), np.zeros((2, 3)))


def fit_black_box(records: Sequence[Record], inputs: Sequence[str], features: Features) -> BlackBox:
    """Return the ridge regression of velocity steps on features of the past half second."""
    from sklearn.linear_model import Ridge

    lags = _lags(records[0].dt)
    rows, steps, reached = [], [], []
    for record in records:
        y, u = _velocities(record), _commands(record, tuple(inputs))
        k = np.arange(lags, len(y))
        rows.append(features(_past(y, lags, k), _past(u, lags, k)))
        reached += [y.min(axis=0), y.max(axis=0)]
        steps.append(np.diff(y, axis=0)[lags - 1 :])
    table, target = np.concatenate(rows), np.concatenate(steps)
    centre, scale = table.mean(axis=0), np.maximum(table.std(axis=0), np.finfo(float).tiny)
    limits = np.stack([np.min(reached, axis=0), np.max(reached, axis=0)])
    size = np.maximum(np.ptp(limits, axis=0), np.finfo(float).tiny)

    def fitted(penalty: float) -> BlackBox:
        ridge = Ridge(penalty).fit((table - centre) / scale, target)
        weights = np.concatenate([ridge.coef_.T, np.atleast_1d(ridge.intercept_)[None]])
        return BlackBox(tuple(inputs), lags, features, centre, scale, weights, limits)

    def free_run_error(box: BlackBox) -> float:
        errors = black_box_errors(box, records, _CHOICE_S, _LAG_S)
        return float(sum(np.mean((errors[c] / s) ** 2) for c, s in zip(VELOCITIES, size, strict=True)))

    return min((fitted(penalty) for penalty in _PENALTIES), key=free_run_error)


def black_box_errors(box: BlackBox, records: Sequence[Record], window_s: float, initial_s: float) -> dict[str, Array]:
    """Return errors over all windows of records, channel -> (rows,): u, v, r, psi, x0, y0 as far as measured.

    Heading and track are those of the predicted velocities, from what is measured at the end of a window's beginning.
    """
    protocol = HoldoutProtocol(window_s, initial_s)
    windows = [window for record in records for window in split_windows(record, protocol)]
    beginning = max(box.lags, round(initial_s / windows[0].dt))
    measured = np.stack([_velocities(window) for window in windows])
    runs = box.run(measured, np.stack([_commands(window, box.inputs) for window in windows]), beginning)
    predicted = [
        dict(zip(VELOCITIES, y.T, strict=True)) | _track(window, y, beginning)
        for window, y in zip(windows, runs, strict=True)
    ]
    return {
        channel: np.concatenate([p[channel] - window[channel] for p, window in zip(predicted, windows, strict=True)])
        for channel in predicted[0]
    }


def _track(window: Record, y: Array, beginning: int) -> dict[str, Array]:
    """Heading and positions along velocities (n, 3), by the trapezoidal rule, from sample `beginning` on."""
    if not {"psi", "x0", "y0"} <= set(window.channels):
        return {}

    def integrated(measured: Array, rate: Array) -> Array:
        values = measured.copy()
        steps = 0.5 * window.dt * (rate[beginning - 1 : -1] + rate[beginning:])
        values[beginning:] = measured[beginning - 1] + np.cumsum(steps)
        return values

    u, v, r = y.T
    psi = integrated(window["psi"], r)
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    return {"psi": psi, "x0": integrated(window["x0"], north), "y0": integrated(window["y0"], east)}


def _lags(dt: float) -> int:
    return max(1, round(_LAG_S / dt))


def _velocities(record: Record) -> Array:
    return np.stack([record[c] for c in VELOCITIES], axis=1)


def _commands(record: Record, inputs: tuple[str, ...]) -> Array:
    return np.stack([record[name] for name in inputs], axis=1)


def _past(values: Array, lags: int, rows: Index) -> Array:
    """The `lags` samples before each row, the last first, (len(rows), columns lags)."""
    return np.concatenate([values[rows - 1 - lag] for lag in range(lags)], axis=1)
