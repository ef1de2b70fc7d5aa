"""Validation runs predicted in windows: errors, share inside the band, and baselines over the same windows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.prediction import ERROR_CHANNELS, ChannelScore, WindowBaseline, WindowScore
from seatrial.core.values import Array, Index, InputError, Record
from seatrial.data.trial.settings import WindowLength
from seatrial.estimation.estimate.settings import characteristic_time, shows_speed
from seatrial.estimation.information.discrepancy import Discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates
from seatrial.estimation.predict.open_loop import has_moving_track, open_loop_runs
from seatrial.estimation.predict.prediction_intervals import window_spreads, with_sensor_noise
from seatrial.estimation.predict.windows import Windows, like_window
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.sensors.measured_outputs import SENSOR_SOURCE
from seatrial.physics.simulate.replay import inputs_of

# Regressions of the next velocities on the last ones and the inputs: what a model without physics predicts.

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
    model: Model, train: Sequence[Record], features: Features, seconds: float, channels: Sequence[str] = _RATES
) -> AutoRegression | None:
    """Return the ridge regression of those of the channels that all runs hold; None where they hold none.

    seconds: of a window's beginning; the penalty is chosen by windows `_CHOICE_LENGTH` times as long.
    """
    channels = tuple(
        c for c in channels if all(c in r and np.isfinite(r[c]).all() and np.ptp(r[c]) > 0.0 for r in train)
    )
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
        if position in window and rate in values and position not in values:
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


# Validation runs predicted in windows: errors, share inside the band, and baselines over the same windows.

MAX_WINDOWS = 40
"""Windows of a run that are scored, evenly spread over it where there are more; chosen."""
DEFAULT_LENGTHS = (1.0, 5.0, 20.0)
"""Windows that are scored where none are required [ship lengths]: those that a run holds twice; chosen."""
THRUSTER_LENGTHS = (5.0, 10.0, 30.0)
"""The same of craft with thrusters, which turn on the spot [s]; chosen."""
_DEGREES = float(np.degrees(1.0))
Predictor = Callable[[Windows, float], Sequence[Record]]
"""Windows and the seconds of their beginning that may be used -> the windows predicted; NaN where one diverges."""


@dataclass(frozen=True, eq=False)
class WindowPredictor:
    """What windows are predicted with: the fit, what its bands are made of, and baselines by name.

    discrepancy: by the length of the windows [s].
    """

    template: OutputError
    model: Model
    nuisances: Array
    uncertainty: PredictionUncertainty
    discrepancy: Callable[[float], Discrepancy]
    baselines: Mapping[str, Predictor]
    length: float
    seconds: float


def window_scores(
    predictor: WindowPredictor, record: Record, lengths: Sequence[WindowLength], index: float, rng: np.random.Generator
) -> tuple[WindowScore, ...]:
    """Return the scores of a validation run over windows of each length that it holds.

    Args:
        lengths: none: `DEFAULT_LENGTHS`, of craft with thrusters `THRUSTER_LENGTHS`, as far as the run holds two of
            each, else halves of the run.
        index: extrapolation index of the run, with which the model discrepancy in the bands grows.
    """
    try:
        unit = characteristic_time(predictor.model, [record], predictor.length)
    except InputError:  # no speed was recorded: windows in seconds only
        unit = None
    seconds_of = {"s": 1.0} | ({} if unit is None else {"L": unit})
    has_thrusters = predictor.model.has_thrusters
    usual = [WindowLength(n, "s") for n in THRUSTER_LENGTHS]
    if not has_thrusters:
        in_lengths = predictor.model.has_heading and shows_speed(record)
        usual = [_usual_length(n, unit, in_lengths=in_lengths) for n in DEFAULT_LENGTHS]
    wanted = [(str(w), w.value * seconds_of[w.unit]) for w in lengths or usual if w.unit in seconds_of]
    if not lengths:
        wanted = [(name, seconds) for name, seconds in wanted if 2.0 * seconds <= record.duration]
        wanted = wanted or [("half of the run", 0.5 * record.duration)]
    return tuple(
        _score(predictor, windows.evenly_spread(MAX_WINDOWS), name, seconds, index, rng)
        for name, seconds in wanted
        if len(windows := Windows.cut([record], seconds))
    )


def _usual_length(many: float, unit: float | None, *, in_lengths: bool) -> WindowLength:
    """So many ship lengths; of a ship whose way is not recorded, so many of its times `unit` [s]."""
    if in_lengths or unit is None:
        return WindowLength(many, "L")
    return WindowLength(float(f"{many * unit:.2g}"), "s")


def _score(
    p: WindowPredictor, windows: Windows, name: str, seconds: float, index: float, rng: np.random.Generator
) -> WindowScore:
    initial, nuisances, pieces = windows.initial_seconds(p.seconds), p.nuisances[None], windows.pieces
    runs = open_loop_runs(p.template, p.model, windows, nuisances, initial)
    simulated, starts = [run.record for run in runs], StartStates.joined([run.start for run in runs])
    spreads = window_spreads(p.template, p.model, windows, simulated, starts, nuisances, p.uncertainty, rng)
    t = two_sided_quantile(STORED_LEVEL, p.uncertainty.degrees_of_freedom)
    discrepancy, halves = p.discrepancy(seconds), []
    for piece, run, spread in zip(pieces, runs, spreads, strict=True):
        sds = with_sensor_noise(piece, spread if run.divergence is None else {})
        halves.append({c: t * discrepancy.channel_sd(c, sd, piece.dt, index) for c, sd in sds.items()})
    scores = {
        key: _channel_score(pieces, simulated, halves, channels, factor)
        for key, (channels, factor) in ERROR_CHANNELS.items()
        if _is_compared(pieces, simulated, channels)
    }
    rivals = [
        WindowBaseline(n, _baseline_scores(predict(windows, initial), pieces, scores))
        for n, predict in p.baselines.items()
    ]
    diverged = sum(run.divergence is not None for run in runs)
    return WindowScore(name, seconds, len(windows), scores, tuple(r for r in rivals if r.scores), diverged)


def _is_compared(windows: list[Record], simulated: list[Record], channels: tuple[str, ...]) -> bool:
    pairs = list(zip(windows, simulated, strict=True))
    held = all(c in w and c in s and np.isfinite(w.measured(c)).any() for w, s in pairs for c in channels)
    return held and (channels != ("x0", "y0") or any(has_moving_track(s) for s in simulated))


def _errors(windows: Sequence[Record], simulated: Sequence[Record], channel: str) -> Array:
    """Errors where something was measured, (n,); infinite after a divergence."""
    read = [w.measured(channel) for w in windows]
    pairs = [(s[channel] - w, np.isfinite(w)) for w, s in zip(read, simulated, strict=True)]
    errors = np.concatenate([e[measured] for e, measured in pairs])
    return np.where(np.isfinite(errors), errors, np.inf)


def _channel_score(
    windows: list[Record],
    simulated: Sequence[Record],
    halves: list[dict[str, Array]],
    channels: tuple[str, ...],
    factor: float,
) -> ChannelScore:
    """Score of some channels together; halves: half widths of the band in each window, none: no band.

    The share inside the band is that of windows with one, where most have one.
    """
    mean_square, variance, inside, widths = 0.0, 0.0, [], []
    for channel in channels:
        errors = _errors(windows, simulated, channel)
        is_read = [np.isfinite(w.measured(channel)) for w in windows]
        mean_square += float(np.mean(errors**2))
        variance += float(np.var(np.concatenate([w[channel][m] for w, m in zip(windows, is_read, strict=True)])))
        with_band = [h for h in halves if channel in h]
        if 2 * len(with_band) > len(windows):
            half = [h.get(channel, np.full(len(m), np.nan))[m] for h, m in zip(halves, is_read, strict=True)]
            judged = np.isfinite(np.concatenate(half))
            inside.append((np.abs(errors) <= np.concatenate(half))[judged])
            widths.append(float(np.mean(np.square(np.concatenate(half)[judged]))))
    share = mean_square / variance if variance > 0.0 else np.inf
    return ChannelScore(
        factor * float(np.sqrt(mean_square)),
        100.0 * (1.0 - float(np.sqrt(share))),  # MathWorks, System Identification Toolbox, compare: NRMSE
        1.0 - share,
        float(np.mean(np.concatenate(inside))) if inside else None,
        float(np.sqrt(sum(widths) / variance)) if widths and variance > 0.0 else None,
    )


def _baseline_scores(
    simulated: Sequence[Record], windows: list[Record], scores: Mapping[str, ChannelScore]
) -> dict[str, ChannelScore]:
    """Scores of a baseline in those of the fit's that it predicts."""
    return {
        key: _channel_score(windows, simulated, [], channels, factor)
        for key, (channels, factor) in ERROR_CHANNELS.items()
        if key in scores and all(c in s for s in simulated for c in channels)
    }


def pooled_rms(windows: Sequence[Record], simulated: Sequence[Record], channels: Sequence[str]) -> float:
    """Return the rms of the errors over all windows, of several channels that of their norm; infinite if one diverges.

    In the channels' own unit.
    """
    return float(np.sqrt(sum(np.mean(_errors(windows, simulated, channel) ** 2) for channel in channels)))


# Predictions to beat: constant course and speed, no motion, unfitted coefficients, regressions without physics.

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
        {CONSTANT_COURSE: constant_course, STAYS: stays} if model.has_heading else {AT_REST: at_rest}
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
