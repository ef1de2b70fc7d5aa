"""Validation runs predicted in windows: errors, share inside the band, and baselines over the same windows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.prediction import ChannelScore, WindowBaseline, WindowScore
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial.settings import WindowLength
from seatrial.estimation.estimate.time_scale import characteristic_time
from seatrial.estimation.information.discrepancy import Discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates
from seatrial.estimation.predict.left_out_runs import with_sensor_noise
from seatrial.estimation.predict.open_loop import has_moving_track, open_loop_runs
from seatrial.estimation.predict.prediction_intervals import window_spreads
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError

MAX_WINDOWS = 40
"""Windows of a run that are scored, evenly spread over it where there are more; chosen."""
DEFAULT_LENGTHS = (1.0, 5.0, 20.0)
"""Windows that are scored where none are required [ship lengths]: those that a run holds twice; chosen."""
THRUSTER_LENGTHS = (5.0, 10.0, 30.0)
"""The same of craft with thrusters, which turn on the spot [s]; chosen."""
_DEGREES = float(np.degrees(1.0))
# score -> channels and factor to its unit
_SCORES: Mapping[str, tuple[tuple[str, ...], float]] = {
    "psi_deg": (("psi",), _DEGREES), "position_m": (("x0", "y0"), 1.0), "theta_deg": (("theta",), _DEGREES),
    "phi_deg": (("phi",), _DEGREES), "z": (("z",), 1.0), "u": (("u",), 1.0), "v": (("v",), 1.0), "r": (("r",), 1.0),
}  # fmt: skip

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
    has_thrusters = bool(predictor.model.equations.layout)
    usual = [WindowLength(n, "s") for n in THRUSTER_LENGTHS]
    if not has_thrusters:
        usual = [_usual_length(n, unit, is_steered="psi" in predictor.model.states) for n in DEFAULT_LENGTHS]
    wanted = [(str(w), w.value * seconds_of[w.unit]) for w in lengths or usual if w.unit in seconds_of]
    if not lengths:
        wanted = [(name, seconds) for name, seconds in wanted if 2.0 * seconds <= record.duration]
        wanted = wanted or [("half of the run", 0.5 * record.duration)]
    return tuple(
        _score(predictor, windows.evenly_spread(MAX_WINDOWS), name, seconds, index, rng)
        for name, seconds in wanted
        if len(windows := Windows.cut([record], seconds))
    )


def _usual_length(many: float, unit: float | None, *, is_steered: bool) -> WindowLength:
    """So many ship lengths; of a ship that rolls or heaves about its rest, so many of its times `unit` [s]."""
    if is_steered or unit is None:
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
        for key, (channels, factor) in _SCORES.items()
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
    compared = {key: _SCORES[key] for key in scores if all(c in s for s in simulated for c in _SCORES[key][0])}
    return {key: _channel_score(windows, simulated, [], *channels) for key, channels in compared.items()}


def pooled_rms(windows: Sequence[Record], simulated: Sequence[Record], channels: Sequence[str]) -> float:
    """Return the rms of the errors over all windows, of several channels that of their norm; infinite if one diverges.

    In the channels' own unit.
    """
    return float(np.sqrt(sum(np.mean(_errors(windows, simulated, channel) ** 2) for channel in channels)))
