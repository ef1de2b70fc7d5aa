"""Regressions of the next velocities on the last ones and the inputs: what a model without physics predicts.

What a physical model does not predict better than these it does not know. ARX and NARX: Ljung 1999, System
Identification, sections 4.2 and 5.4; run freely, not one step ahead. Ridge: Hoerl & Kennard 1970.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, Record
from seatrial.estimation.predict.windows import Windows, like_window
from seatrial.physics.simulate.replay import inputs_of

_LAG_S, _MIN_LAGS = 0.5, 2
"""Past that a regression sees: several time constants of a small craft's thrusters [s], two samples or more; chosen."""
_PENALTIES = 10.0 ** np.arange(-6, 6)
"""Ridge penalties tried on standardised features; that which predicts training windows best, run freely, is taken."""
_CHOICE_LENGTH = 10.0
"""Length of the training windows by which the penalty is chosen, in beginnings of a window; chosen."""
_MAX_ROWS, _MAX_CHOICE_WINDOWS, _MAX_CHOICES = 20_000, 40, 400
"""Samples of all runs that a regression is fitted to, windows of a run it is chosen by, and of all runs; chosen."""
_DEGREE = 2
"""Of the polynomial through a window's beginning: what a craft does in it is no more than to accelerate; chosen."""
_RATES = ("u", "v", "r", "p", "q", "w")
_INTEGRALS = {"psi": "r", "phi": "p", "theta": "q", "z": "w"}

Features = Callable[[Array, Array], Array]
"""Past velocities (..., lags, channels) and inputs (..., lags, nu), the last sample first -> features (..., k)."""


def linear_features(velocities: Array, inputs: Array) -> Array:
    """Return the past as it is: an ARX model."""
    shape = velocities.shape[:-2]
    return np.concatenate([velocities.reshape(*shape, -1), inputs.reshape(*shape, -1)], axis=-1)


def quadratic_features(velocities: Array, inputs: Array) -> Array:
    """Return the past, its signed squares and the products of the last sample's values: a NARX model."""
    past = linear_features(velocities, inputs)
    last = np.concatenate([velocities[..., 0, :], inputs[..., 0, :]], axis=-1)
    first, second = np.triu_indices(last.shape[-1])
    return np.concatenate([past, past * np.abs(past), last[..., first] * last[..., second]], axis=-1)


@dataclass(frozen=True, eq=False)
class AutoRegression:
    """A regression of the next step of some velocities, fitted to training runs.

    Attributes:
        channels: the velocities; lags: samples of the past that it sees.
        centre, scale, weights: of the standardised features, (k,), (k,), (k + 1, channels).
        limits: least and largest velocities of the training runs, where a prediction that runs away is held,
            (2, channels).
    """

    model: Model
    channels: tuple[str, ...]
    lags: int
    features: Features
    centre: Array
    scale: Array
    weights: Array
    limits: Array

    def predict(self, windows: Windows, seconds: float) -> list[Record]:
        """Return windows run freely behind their first seconds, over which a parabola stands for what was measured.

        So the regression is not credited with noise that it has seen. Heading and track follow from the rates.
        """
        beginning = max(self.lags, int(seconds / windows.dt))
        measured = np.stack([piece.matrix(self.channels) for piece in windows.pieces])
        velocities = self._run(measured, windows.inputs(self.model), self.weights[None], beginning)[0]
        return [
            _with_positions(piece, dict(zip(self.channels, y.T, strict=True)), beginning)
            for piece, y in zip(windows.pieces, velocities, strict=True)
        ]

    def _run(self, measured: Array, inputs: Array, weights: Array, beginning: int) -> Array:
        """Velocities (p, windows, n, channels) by each of p sets of weights, as measured up to row `beginning`."""
        y = np.repeat(measured[None], len(weights), axis=0)
        for k in range(beginning, y.shape[2]):
            past = slice(k - self.lags, k)
            u = np.broadcast_to(inputs[:, past][:, ::-1], (len(y), *inputs[:, past].shape))
            scaled = (self.features(y[:, :, past][:, :, ::-1], u) - self.centre) / self.scale
            step = scaled @ weights[:, :-1] + weights[:, -1:]
            y[:, :, k] = np.clip(y[:, :, k - 1] + step, *self.limits)
        return y


def fit_auto_regression(
    model: Model, train: Sequence[Record], features: Features, seconds: float
) -> AutoRegression | None:
    """Return the ridge regression of the velocities that all runs hold; None where they hold none.

    seconds: of a window's beginning; the penalty is chosen by windows `_CHOICE_LENGTH` times as long.
    """
    channels = tuple(c for c in _RATES if all(c in r and np.isfinite(r[c]).all() and np.ptp(r[c]) > 0.0 for r in train))
    lags = max(_MIN_LAGS, round(_LAG_S / train[0].dt))
    if not channels or any(len(record) <= lags for record in train):
        return None
    tables, steps, limits = [], [], []
    every = max(1, sum(len(record) for record in train) // _MAX_ROWS)
    for record in train:
        y, u, rows = record.matrix(channels), inputs_of(model, record), np.arange(lags, len(record), every)
        tables.append(features(_past(y, lags, rows), _past(u, lags, rows)))
        steps.append(y[rows] - y[rows - 1])
        limits += [y.min(axis=0), y.max(axis=0)]
    table, target = np.concatenate(tables), np.concatenate(steps)
    scale = np.where(np.ptp(table, axis=0) > 0.0, table.std(axis=0), 1.0)
    bounds = np.stack([np.min(limits, axis=0), np.max(limits, axis=0)])
    weights = _ridge((table - table.mean(axis=0)) / scale, target)
    box = AutoRegression(model, channels, lags, features, table.mean(axis=0), scale, weights[0], bounds)
    return _with_best_penalty(box, train, weights, seconds)


def _with_best_penalty(box: AutoRegression, train: Sequence[Record], weights: Array, seconds: float) -> AutoRegression:
    """The regression with those of the weights (p, k + 1, channels) that predict training windows best."""
    length = min(_CHOICE_LENGTH * seconds, 0.5 * min(record.duration for record in train))
    cut = Windows.cut(train, length)
    of_run = [np.flatnonzero(cut.run == i) for i in range(len(train))]
    spread = [rows[np.linspace(0, len(rows) - 1, min(len(rows), _MAX_CHOICE_WINDOWS)).round().astype(np.int64)]
              for rows in of_run]  # fmt: skip
    windows = cut.selected(np.concatenate(spread)).evenly_spread(_MAX_CHOICES)
    if not len(windows) or windows.steps <= box.lags:
        return replace(box, weights=weights[0])
    measured = np.stack([piece.matrix(box.channels) for piece in windows.pieces])
    runs = box._run(measured, windows.inputs(box.model), weights, box.lags)
    errors = np.sum(np.square((runs - measured) / np.ptp(box.limits, axis=0)), axis=(1, 2, 3))
    return replace(box, weights=weights[int(np.argmin(errors))])


def _ridge(table: Array, target: Array) -> Array:
    """Weights and intercept for each penalty, (p, k + 1, channels), of standardised features (rows, k)."""
    size, axes = np.linalg.eigh(table.T @ table)
    mean = target.mean(axis=0)
    projected = axes.T @ (table.T @ (target - mean))
    shrunk = 1.0 / (np.maximum(size, 0.0) + _PENALTIES[:, None])
    weights = np.einsum("ij,pj,jc->pic", axes, shrunk, projected)
    return np.concatenate([weights, np.broadcast_to(mean, (len(weights), 1, len(mean)))], axis=1)


def _past(values: Array, lags: int, rows: Index) -> Array:
    """The `lags` samples before each row, the last first, (rows, lags, columns)."""
    return np.stack([values[rows - 1 - lag] for lag in range(lags)], axis=1)


def _with_positions(window: Record, velocities: Mapping[str, Array], beginning: int) -> Record:
    """The window with predicted velocities, and with angles, heave and track integrated from row `beginning` on."""

    def integrated(channel: str, rate: Array) -> Array:
        values = _smoothed_beginning(window[channel], beginning)
        steps = 0.5 * window.dt * (rate[beginning - 1 : -1] + rate[beginning:])
        values[beginning:] = values[beginning - 1] + np.cumsum(steps)
        return values

    values = {channel: _smoothed_beginning(y, beginning) for channel, y in velocities.items()}
    for position, rate in _INTEGRALS.items():
        if position in window and rate in values:
            values[position] = integrated(position, values[rate])
    if {"psi", "u"} <= set(values) and {"x0", "y0"} <= set(window.channels):
        psi, u, v = values["psi"], values["u"], values.get("v", np.zeros(len(window)))
        values["x0"] = integrated("x0", u * np.cos(psi) - v * np.sin(psi))
        values["y0"] = integrated("y0", u * np.sin(psi) + v * np.cos(psi))
    return like_window(window, values)


def _smoothed_beginning(values: Array, beginning: int) -> Array:
    """Values (n,) with a parabola through the measured ones of the first `beginning` rows; a line through a few."""
    rows = np.arange(beginning)
    seen = rows[np.isfinite(values[:beginning])]
    smoothed = values.copy()
    smoothed[:beginning] = np.nan
    if len(seen):
        degree = min(_DEGREE, max(len(seen) - 2, 0))
        smoothed[:beginning] = np.polyval(np.polyfit(seen, values[seen], degree), rows)
    return smoothed
