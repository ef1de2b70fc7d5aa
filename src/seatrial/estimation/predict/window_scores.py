"""Validation runs predicted in windows: errors, share inside the band, and baselines over the same windows."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.results.window_scores import ChannelScore, WindowBaseline, WindowScore
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.signal import sample_noise
from seatrial.estimation.estimate.time_scale import characteristic_time
from seatrial.estimation.information.discrepancy import Discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty
from seatrial.estimation.predict.open_loop import has_moving_track, simulate_while_bounded
from seatrial.estimation.predict.prediction_intervals import window_spread
from seatrial.estimation.problem.output_error import OutputError

MAX_WINDOWS = 40
"""Windows of a run that are scored, evenly spread over it where there are more; chosen."""
DEFAULT_LENGTHS = (1.0, 5.0, 20.0)
"""Windows that are scored where none are required [ship lengths]: those that a run holds twice; chosen."""
_INITIAL_SHARE = 0.2  # of a window, from which its initial state is estimated at most; chosen
_DEGREES = float(np.degrees(1.0))
# score -> channels and factor to its unit
_SCORES: Mapping[str, tuple[tuple[str, ...], float]] = {
    "psi_deg": (("psi",), _DEGREES), "position_m": (("x0", "y0"), 1.0), "theta_deg": (("theta",), _DEGREES),
    "phi_deg": (("phi",), _DEGREES), "z": (("z",), 1.0), "u": (("u",), 1.0), "v": (("v",), 1.0), "r": (("r",), 1.0),
}  # fmt: skip

Predictor = Callable[[Record, float], Record]
"""A window and the seconds of its beginning that may be used -> the window predicted; NaN where it diverges."""


@dataclass(frozen=True)
class WindowLength:
    """Length of a window; `unit`: s, or L for the time of a ship length at the run's speed."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit}"


def window_lengths(text: str) -> tuple[WindowLength, ...]:
    """Return the lengths that a text such as ``10s,5L`` names.

    Raises:
        InputError: a part is no positive number with s or L.
    """
    lengths = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        match = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*([sL])", part)
        if match is None or not float(match[1]) > 0.0:
            raise InputError(f"--windows: '{part}' is no length of a window; write seconds or ship lengths, as 10s,5L")
        lengths.append(WindowLength(float(match[1]), match[2]))
    return tuple(lengths)


@dataclass(frozen=True, eq=False)
class WindowPredictor:
    """What windows are predicted with: the fit, what its bands are made of, and baselines by name."""

    template: OutputError
    model: Model
    nuisances: Array
    uncertainty: PredictionUncertainty
    discrepancy: Discrepancy
    baselines: Mapping[str, Predictor]
    length: float
    seconds: float


def window_scores(
    predictor: WindowPredictor, record: Record, lengths: Sequence[WindowLength], index: float, rng: np.random.Generator
) -> tuple[WindowScore, ...]:
    """Return the scores of a validation run over windows of each length that it holds.

    Args:
        lengths: none: `DEFAULT_LENGTHS` as far as the run holds two of each, else halves of the run.
        index: extrapolation index of the run, with which the model discrepancy in the bands grows.
    """
    try:
        unit = characteristic_time(predictor.model, [record], predictor.length)
    except InputError:  # no speed was recorded: windows in seconds only
        unit = None
    seconds_of = {"s": 1.0} | ({} if unit is None else {"L": unit})
    wanted = [(str(w), w.value * seconds_of[w.unit]) for w in lengths if w.unit in seconds_of]
    if not lengths:
        wanted = [(f"{n:g} L", n * unit) for n in DEFAULT_LENGTHS if unit and 2.0 * n * unit <= record.duration]
        wanted = wanted or [("half of the run", 0.5 * record.duration)]
    return tuple(
        _score(predictor, windows, name, seconds, index, rng)
        for name, seconds in wanted
        if (windows := _windows(record, seconds))
    )


def _windows(record: Record, seconds: float) -> list[Record]:
    steps = max(round(seconds / record.dt), 4)  # five samples at least, from which an initial state is estimated
    count = (len(record) - 1) // steps
    chosen = np.unique(np.linspace(0, count - 1, min(count, MAX_WINDOWS)).round().astype(int)) if count else []
    return [record.rows(slice(int(k) * steps, (int(k) + 1) * steps + 1)) for k in chosen]


def _score(
    p: WindowPredictor, windows: list[Record], name: str, seconds: float, index: float, rng: np.random.Generator
) -> WindowScore:
    initial = min(p.seconds, _INITIAL_SHARE * seconds)
    t = float(stdtrit(p.uncertainty.degrees_of_freedom, 0.975))
    simulated, halves = [], []
    for window in windows:
        run = simulate_while_bounded(p.template, p.model, window, p.nuisances, initial)
        lasts = run.divergence is None
        spread = window_spread(p.template, p.model, window, run, p.nuisances, p.uncertainty, rng) if lasts else {}
        simulated.append(run.record)
        sds = {c: p.discrepancy.channel_sd(c, sd, window.dt, index) for c, sd in spread.items()}
        # a measured sample lies about the true one by its sensor's noise
        halves.append({c: t * np.hypot(sd, sample_noise(window[c])) for c, sd in sds.items() if c in window})
    scores = {
        key: _channel_score(windows, simulated, halves, channels, factor)
        for key, (channels, factor) in _SCORES.items()
        if _is_compared(windows, simulated, channels)
    }
    rivals = [WindowBaseline(n, _baseline_rms(predict, windows, initial, scores)) for n, predict in p.baselines.items()]
    return WindowScore(name, seconds, len(windows), scores, tuple(r for r in rivals if r.rms))


def _is_compared(windows: list[Record], simulated: list[Record], channels: tuple[str, ...]) -> bool:
    pairs = list(zip(windows, simulated, strict=True))
    held = all(c in w and c in s and np.isfinite(w[c]).any() for w, s in pairs for c in channels)
    return held and (channels != ("x0", "y0") or any(has_moving_track(s) for s in simulated))


def _errors(windows: list[Record], simulated: list[Record], channel: str) -> Array:
    """Errors where something was measured, (n,); infinite after a divergence."""
    pairs = [(s[channel] - w[channel], np.isfinite(w[channel])) for w, s in zip(windows, simulated, strict=True)]
    errors = np.concatenate([e[measured] for e, measured in pairs])
    return np.where(np.isfinite(errors), errors, np.inf)


def _channel_score(
    windows: list[Record],
    simulated: list[Record],
    halves: list[dict[str, Array]],
    channels: tuple[str, ...],
    factor: float,
) -> ChannelScore:
    squares, about_mean, inside = 0.0, 0.0, []
    for channel in channels:
        errors = _errors(windows, simulated, channel)
        measured = np.concatenate([w[channel][np.isfinite(w[channel])] for w in windows])
        squares += float(errors @ errors)
        about_mean += float(np.sum((measured - np.mean(measured)) ** 2))
        if all(channel in half for half in halves):
            half = np.concatenate([h[channel][np.isfinite(w[channel])] for h, w in zip(halves, windows, strict=True)])
            inside.append(np.abs(errors) <= half)
    count = sum(int(np.isfinite(w[channels[0]]).sum()) for w in windows)
    share = squares / about_mean if about_mean > 0.0 else np.inf
    return ChannelScore(
        factor * float(np.sqrt(squares / count)),
        100.0 * (1.0 - float(np.sqrt(share))),  # MathWorks, System Identification Toolbox, compare: NRMSE
        1.0 - share,
        float(np.mean(np.concatenate(inside))) if inside else None,
    )


def _baseline_rms(
    predict: Predictor, windows: list[Record], initial: float, scores: Mapping[str, ChannelScore]
) -> dict[str, float]:
    simulated = [predict(window, initial) for window in windows]
    rms = {}
    for key in scores:
        channels, factor = _SCORES[key]
        if all(c in s for s in simulated for c in channels):
            errors = [_errors(windows, simulated, c) for c in channels]
            rms[key] = factor * float(np.sqrt(np.mean(np.sum(np.square(errors), axis=0))))
    return rms
