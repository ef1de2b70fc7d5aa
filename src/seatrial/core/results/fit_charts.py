"""Charts of a fit: its coefficients with their intervals, and one run measured and simulated."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    SECOND,
    WIDTH,
    Anchor,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Points,
    Rule,
    Shape,
    Stroke,
    Text,
    tiles,
)
from seatrial.core.figures.panels import row_panel
from seatrial.core.figures.run import BAND, ChannelPanel, RunView, TimeCurve, channel_panel, run_chart
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.prediction import Prediction
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_label, reading_order
from seatrial.core.values.record_chart import PLAIN, has_moving_track, has_track, is_constant, record_track, time_curve

# least and largest reach of the axis of coefficients [% of the estimate]
NARROWEST, WIDEST = 1.0, 120.0
TICKS_OF_WIDTH = 8  # of that axis over the whole width of a page; chosen
MEASURED, SIMULATED = Stroke(GREY, 3.0), Stroke(ACCENT, 1.4, "5 2.5")  # px, chosen
MAX_PANELS = 9  # px, chosen
_ERROR = "error of "
# letters of the channels that say most of a run, the first that it has
_HEADLINE = ("ψ", "θ", "φ", "z", "u")
# points of a curve over the whole width of a page
FINE_POINTS = 1600
_PRIOR, _INTERVAL, _ZERO = Stroke("#d3dae0", 9.0), Stroke(ACCENT, 2.2), Stroke("#999999", 0.9)  # px, chosen
_ESTIMATE = Marker(Shape.CIRCLE, 3.4, ACCENT, ACCENT, 0.0)  # px, chosen
_TRUTH = Marker(Shape.DIAMOND, 3.4, SECOND, "#ffffff", 1.4)  # px, chosen
# quantile of the standard normal distribution for 95 %, two-sided
NORMAL_95 = 1.96


def coefficients_chart(coefficients: Sequence[Coefficient], width: float = WIDTH) -> Chart | None:
    """Return each free coefficient's interval, prior and known value [% from its estimate]; None where none is free.

    width: px.
    """
    free = [c for c in coefficients if not c.fixed and c.estimate != 0 and c.lower is not None and c.upper is not None]
    if not free:
        return None
    ends = [abs(_deviation(c, x)) for c in free for x in (c.lower, c.upper, c.truth) if x is not None]
    reach = float(np.clip(1.12 * max(ends), NARROWEST, WIDEST))  # 12 % more than the widest interval
    ticks = max(2, round(TICKS_OF_WIDTH * width / WIDTH))
    x = Axis((-reach, reach), "deviation from the estimate, per cent of the estimate", tick_count=ticks)
    marks = [mark for row, c in enumerate(free) for mark in _coefficient_marks(c, row, reach)]
    legend = [LegendEntry("estimate, 95 % interval", _INTERVAL)]
    legend += [LegendEntry("prior, 95 %", _PRIOR)] if any(c.prior_mean is not None for c in free) else []
    legend += [LegendEntry("known value", _TRUTH)] if any(c.truth is not None for c in free) else []
    panel = row_panel([c.name for c in free], x, [Rule(0.0, _ZERO, is_vertical=True), *marks], top=4.0, width=width)
    return Chart("95 % intervals of the free coefficients", (panel,), tuple(legend), width)


def _deviation(c: Coefficient, value: float) -> float:
    return 100.0 * (value - c.estimate) / abs(c.estimate)


def _coefficient_marks(c: Coefficient, row: int, reach: float) -> list[Mark]:
    assert c.lower is not None and c.upper is not None
    marks: list[Mark] = []
    if c.prior_mean is not None and c.prior_standard_deviation is not None:
        spread = NORMAL_95 * c.prior_standard_deviation
        marks.append(_interval(_deviation(c, c.prior_mean - spread), _deviation(c, c.prior_mean + spread), row, _PRIOR))
    lower, upper = _deviation(c, c.lower), _deviation(c, c.upper)
    marks.append(_interval(lower, upper, row, _INTERVAL))
    # px, chosen
    marks += [Text(np.sign(end) * reach, row, sign, Anchor.MIDDLE, colour=ACCENT, dx=-3.0 * np.sign(end), dy=4.0)
              for end, sign in ((lower, "‹"), (upper, "›")) if abs(end) > reach]  # fmt: skip
    row_array = np.array([float(row)])
    marks.append(Points(np.zeros(1), row_array, _ESTIMATE))
    if c.truth is not None:
        marks.append(Points(np.array([_deviation(c, c.truth)]), row_array, _TRUTH))
    return marks


def _interval(lower: float, upper: float, row: int, stroke: Stroke) -> Line:
    return Line(np.array([lower, upper]), np.full(2, float(row)), stroke)


def prediction_chart(prediction: Prediction, length: float, inputs: Sequence[str]) -> Chart:
    """Return track and channels of one run, measured and simulated.

    Args:
        length: of the ship [m], for hulls along the track.
        inputs: channels that are given to the model, shown as measured only.
    """
    view = prediction_view(prediction, length, inputs)
    if len(view.channels) == 2 and view.channels[-1].label.startswith(_ERROR):
        return _single_channel(view)
    return run_chart(view)


def prediction_view(prediction: Prediction, length: float, inputs: Sequence[str]) -> RunView:
    """Return what a figure of one run shows; arguments as of `prediction_chart`. A channel alone has its error too."""
    measured, simulated = prediction.measured, prediction.simulated
    names = [s for s in reading_order(list(measured.channels)) if s in inputs or s in simulated]
    names = [s for s in names if not is_constant(measured, s)][:MAX_PANELS]
    reference, model = prediction.reference_word, prediction.model_word
    origin = " (simulated)" if prediction.is_reference_simulated else ""
    legend = [LegendEntry(f"{reference}{origin}", MEASURED), LegendEntry(f"{model}, open loop", SIMULATED)]
    legend += [LegendEntry("95 % band", BAND)] if has_band(prediction) else []
    channels = [_channel(prediction, name, is_input=name in inputs) for name in names]
    if len(names) == 1 and names[0] not in inputs and not has_track(measured):
        channels.append(_error_panel(channels[0]))
    title = f"{prediction.record}: {reference} and {model}"
    return RunView(title, tuple(channels), tuple(_tracks(prediction)), length, tuple(legend))


def headline_view(prediction: Prediction, length: float, inputs: Sequence[str]) -> RunView:
    """Return the track and the channel that says most of a run, heading, else pitch, roll, heave, the first one.

    Below it stands its error, where a model is compared.
    """
    view = prediction_view(prediction, length, inputs)
    by_label = {channel.label.partition(" ")[0]: channel for channel in view.channels}
    first = next((by_label[letter] for letter in _HEADLINE if letter in by_label), None)
    headline = view.channels[:1] if first is None else (first,)
    compared = [channel for channel in headline if len(channel.curves) > 1]
    return replace(view, channels=(*headline, *map(_error_panel, compared)))


def has_band(prediction: Prediction) -> bool:
    """Return whether any channel of the simulated run has a 95 % band."""
    return any(np.isfinite(half).any() for half in prediction.half_width.values())


def has_modelled_position(prediction: Prediction) -> bool:
    """Return whether the simulated position moves: that of a steering model without a speed stays where it is."""
    return has_moving_track(prediction.simulated)


def _tracks(prediction: Prediction) -> list:
    measured, simulated = prediction.measured, prediction.simulated
    if not (has_track(measured) and has_track(simulated)):
        return []
    if not has_modelled_position(prediction):
        return [record_track(measured, MEASURED, "#d4d4d4")]
    half = prediction.half_width
    band_track = replace(record_track(simulated, SIMULATED), half_north=half.get("x0"), half_east=half.get("y0"))
    return [record_track(measured, MEASURED, "#d4d4d4"), band_track]


def _channel(prediction: Prediction, name: str, *, is_input: bool) -> ChannelPanel:
    measured, simulated = prediction.measured, prediction.simulated
    unit = measured.channel(name).unit
    if is_input or name not in simulated:
        label = channel_label(name, unit) + (", input" if is_input else "")
        stroke, words = (PLAIN, "input") if is_input else (MEASURED, prediction.reference_word)
        return ChannelPanel(label, (time_curve(measured, name, stroke, words),))
    curves = (
        time_curve(measured, name, MEASURED, prediction.reference_word),
        replace(_simulated_curve(measured, simulated, name), name=prediction.model_word),
    )
    half = prediction.half_width.get(name)
    if half is None:
        return ChannelPanel(channel_label(name, unit), curves)
    width = half * display_unit(unit)[0]
    return ChannelPanel(channel_label(name, unit), curves, curves[1].values - width, curves[1].values + width)


def _simulated_curve(measured: Record, simulated: Record, name: str) -> TimeCurve:
    """The simulated channel; a heading on the measured one's turn."""
    curve = time_curve(simulated, name, SIMULATED)
    reference = time_curve(measured, name, MEASURED).values
    if name != "psi" or not np.isfinite(curve.values).any() or not np.isfinite(reference).any():
        return curve
    first = curve.values[np.isfinite(curve.values)][0] - reference[np.isfinite(reference)][0]
    return replace(curve, values=curve.values - 360.0 * np.round(first / 360.0))


def _error_panel(channel: ChannelPanel) -> ChannelPanel:
    """The record less the model, with the model's band about zero."""
    reference, model = channel.curves
    error = TimeCurve(reference.time, reference.values - model.values, PLAIN, "record less model")
    label = f"{_ERROR}{channel.label}"
    if channel.lower is None or channel.upper is None:
        return ChannelPanel(label, (error,))
    return ChannelPanel(label, (error,), channel.lower - model.values, channel.upper - model.values)


def _single_channel(view: RunView) -> Chart:
    """The only channel over the whole width, with its error below."""
    above, below = tiles(2, 1, 190.0, left=56.0, top=6.0)  # px, chosen
    # ticks, chosen
    panels = (
        channel_panel(view.channels[0], above, is_last=False, x_ticks=8, points=FINE_POINTS),
        channel_panel(view.channels[1], replace(below, height=70.0), x_ticks=8, y_ticks=3, points=FINE_POINTS),
    )
    return Chart(view.title, panels, view.legend)
