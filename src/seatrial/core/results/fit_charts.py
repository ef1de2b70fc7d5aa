"""Charts of a fit: its coefficients with their intervals, and one run measured and simulated."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.figures.bands import BAND
from seatrial.core.figures.chart import Axis, Chart, LegendEntry, tiles
from seatrial.core.figures.marks import (
    ACCENT,
    GREY,
    SECOND,
    Anchor,
    Line,
    Mark,
    Marker,
    Points,
    Rule,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.figures.rows import row_panel
from seatrial.core.figures.run import ChannelPanel, TimeCurve, channel_panel, run_chart
from seatrial.core.results.fit import Coefficient, Prediction
from seatrial.core.values import Record, display_unit
from seatrial.core.values.channel_text import channel_label, reading_order
from seatrial.core.values.record_chart import PLAIN, has_track, is_constant, record_track, time_curve

# least and largest reach of the axis of coefficients [% of the estimate]
NARROWEST, WIDEST = 1.0, 120.0
MEASURED, SIMULATED = Stroke(GREY, 3.0), Stroke(ACCENT, 1.4, "5 2.5")  # px, chosen
MAX_PANELS = 9  # px, chosen
# points of a curve over the whole width of a page
FINE_POINTS = 1600
_PRIOR, _INTERVAL, _ZERO = Stroke("#d3dae0", 9.0), Stroke(ACCENT, 2.2), Stroke("#999999", 0.9)  # px, chosen
_ESTIMATE = Marker(Shape.CIRCLE, 3.4, ACCENT, ACCENT, 0.0)  # px, chosen
_TRUTH = Marker(Shape.DIAMOND, 3.4, SECOND, "#ffffff", 1.4)  # px, chosen
# quantile of the standard normal distribution for 95 %, two-sided
NORMAL_95 = 1.96


def coefficients_chart(coefficients: Sequence[Coefficient]) -> Chart | None:
    """Return each free coefficient's interval, prior and known value [% from its estimate]; None where none is free."""
    free = [c for c in coefficients if not c.fixed and c.estimate != 0 and c.lower is not None and c.upper is not None]
    if not free:
        return None
    ends = [abs(_deviation(c, x)) for c in free for x in (c.lower, c.upper, c.truth) if x is not None]
    reach = float(np.clip(1.12 * max(ends), NARROWEST, WIDEST))  # 12 % more than the widest interval
    x = Axis((-reach, reach), "deviation from the estimate, per cent of the estimate", tick_count=8)
    marks = [mark for row, c in enumerate(free) for mark in _coefficient_marks(c, row, reach)]
    legend = [LegendEntry("estimate, 95 % interval", _INTERVAL)]
    legend += [LegendEntry("prior, 95 %", _PRIOR)] if any(c.prior_mean is not None for c in free) else []
    legend += [LegendEntry("known value", _TRUTH)] if any(c.truth is not None for c in free) else []
    panel = row_panel([c.name for c in free], x, [Rule(0.0, _ZERO, is_vertical=True), *marks], top=4.0)
    return Chart("95 % intervals of the free coefficients", (panel,), tuple(legend))


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
    marks += [Text(np.sign(end) * reach, row, sign, Anchor.MIDDLE, colour=ACCENT, dx=5.0 * np.sign(end), dy=4.0)
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
    measured, simulated = prediction.measured, prediction.simulated
    names = [s for s in reading_order(list(measured.channels)) if s in inputs or s in simulated]
    names = [s for s in names if not is_constant(measured, s)][:MAX_PANELS]
    reference, model = prediction.reference_word, prediction.model_word
    title = f"{prediction.record}: {reference} and {model}"
    origin = " (simulated)" if prediction.is_reference_simulated else ""
    legend = [LegendEntry(f"{reference}{origin}", MEASURED), LegendEntry(f"{model}, open loop", SIMULATED)]
    if len(names) == 1 and names[0] not in inputs and not has_track(measured):
        return _single_channel(prediction, names[0], title, legend)
    legend += [LegendEntry("95 % band", BAND)] if has_band(prediction) else []
    channels = [_channel(prediction, name, is_input=name in inputs) for name in names]
    return run_chart(title, channels, _tracks(prediction), length, legend)


def has_band(prediction: Prediction) -> bool:
    """Return whether any channel of the simulated run has a 95 % band."""
    return any(np.isfinite(half).any() for half in prediction.half_width.values())


def _tracks(prediction: Prediction) -> list:
    measured, simulated = prediction.measured, prediction.simulated
    if not (has_track(measured) and has_track(simulated)):
        return []
    half = prediction.half_width
    band_track = replace(record_track(simulated, SIMULATED), half_north=half.get("x0"), half_east=half.get("y0"))
    return [record_track(measured, MEASURED, "#d4d4d4"), band_track]


def _channel(prediction: Prediction, name: str, *, is_input: bool) -> ChannelPanel:
    measured, simulated = prediction.measured, prediction.simulated
    unit = measured.channel(name).unit
    if is_input or name not in simulated:
        label = channel_label(name, unit) + (", input" if is_input else "")
        return ChannelPanel(label, (time_curve(measured, name, PLAIN if is_input else MEASURED),))
    curves = (time_curve(measured, name, MEASURED), _simulated_curve(measured, simulated, name))
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


def _single_channel(prediction: Prediction, name: str, title: str, legend: Sequence[LegendEntry]) -> Chart:
    """The only channel over the whole width, with its error below."""
    measured, unit = prediction.measured, prediction.measured.channel(name).unit
    curves = (time_curve(measured, name, MEASURED), _simulated_curve(measured, prediction.simulated, name))
    error = TimeCurve(measured.time, curves[1].values - curves[0].values, PLAIN)
    above, below = tiles(2, 1, 190.0, left=56.0, top=6.0)  # px, chosen
    # ticks, chosen
    panels = (
        channel_panel(
            ChannelPanel(channel_label(name, unit), curves), above, is_last=False, x_ticks=8, points=FINE_POINTS
        ),
        channel_panel(
            ChannelPanel(f"error {channel_label('', unit)}", (error,)),
            replace(below, height=70.0),  # px, chosen
            x_ticks=8,  # ticks, chosen
            y_ticks=3,
            points=FINE_POINTS,
        ),
    )
    return Chart(title, panels, tuple(legend))
