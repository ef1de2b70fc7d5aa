"""What a designed manoeuvre does: orders over time, the drift angle against its limit, the track with the sea room."""

import math

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Anchor,
    Array,
    Chart,
    LegendEntry,
    Mark,
    Panel,
    Region,
    Rule,
    Stroke,
    Text,
)
from seatrial.core.figures.run import (
    TRACK_SIDE,
    ChannelPanel,
    RunView,
    TimeCurve,
    Track,
    is_slender,
    strip_height,
    track_panel,
)
from seatrial.core.results import Actuator, Design
from seatrial.core.results.design import has_drift
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_label, channel_unit, display_values
from seatrial.core.values.record_chart import has_moving_track, record_track

ORDERED, EXECUTED, LIMIT = Stroke(GREY, 2.6), Stroke(ACCENT, 1.3), Stroke(SECOND, 1.0, "6 3")  # px, chosen
LEFT, RIGHT = 64.0, 12.0  # px, chosen
# a sea room larger than the track by this ratio is not drawn
LARGEST_ROOM_RATIO = 2.0
# least height of a strip [px]
MIN_STRIP = 70.0


def order_view(design: Design) -> RunView:
    """Return a panel for each input that is moved and one for the drift angle; the track where there are positions."""
    executed = design.designed.executed
    drift = drift_angle(executed) if has_drift(design) else None
    panels = [_order_panel(design, actuator) for actuator in design.actuators]
    panels += [] if drift is None else [_drift_panel(design, drift)]
    tracks = (record_track(executed, EXECUTED),) if has_moving_track(executed) else ()
    length = design.model.parameters.value_of("L", 0.0)
    legend = (LegendEntry("ordered", ORDERED), LegendEntry("moved, ship as assumed", EXECUTED),
              LegendEntry("limit", LIMIT))  # fmt: skip
    return RunView(f"orders of {design.designed.name}", tuple(panels), tracks, length, legend)


def drift_angle(record: Record) -> Array | None:
    """Return the drift angle [rad], positive when the bow points to starboard of the course; None without u and v."""
    return np.arctan2(-record["v"], record["u"]) if {"u", "v"} <= set(record.channels) else None


def _order_panel(design: Design, actuator: Actuator) -> ChannelPanel:
    name, unit = actuator.name, channel_unit(actuator.name)
    factor, executed = display_unit(unit)[0], design.designed.executed
    ordered = [(order.time, order.values[name]) for order in design.orders if name in order.values]
    curves = [TimeCurve(executed.time, display_values(name, executed[name], unit), EXECUTED, "moved")]
    if ordered:
        times, values = np.array(ordered).T
        latest = np.searchsorted(times, executed.time - executed.time[0], side="right") - 1
        held = np.where(latest >= 0, factor * values[np.maximum(latest, 0)], math.nan)
        curves.insert(0, TimeCurve(executed.time, held, ORDERED, "ordered"))
    limits = tuple(Rule(factor * limit, LIMIT) for limit in (actuator.lower, actuator.upper))
    return ChannelPanel(channel_label(name, unit), tuple(curves), limits=limits)


def _drift_panel(design: Design, drift: Array) -> ChannelPanel:
    limit = math.degrees(design.limits.drift)
    limits = tuple(Rule(end, LIMIT) for end in (-limit, limit)) if math.isfinite(limit) else ()
    curve = TimeCurve(design.designed.executed.time, np.degrees(drift), Stroke(INK, 1.1), "drift")  # px, chosen
    return ChannelPanel("drift β [deg]", (curve,), limits=limits)


def track_chart(design: Design) -> Chart | None:
    """Return the track from above within the sea room; None where the model has no position that moves."""
    executed = design.designed.executed
    if not has_moving_track(executed):
        return None
    parameters, room = design.model.parameters, design.limits.sea_room
    length = parameters.value_of("L", 0.0)
    is_near = room < LARGEST_ROOM_RATIO * float(np.hypot(executed["x0"], executed["y0"]).max())
    track, circle = record_track(executed, EXECUTED), [_circle(room)] if is_near else []
    is_strip = is_slender([track, *circle])
    width = WIDTH - LEFT - RIGHT if is_strip else TRACK_SIDE
    height = max(MIN_STRIP, strip_height([track, *circle], width, length)) if is_strip else width
    # px and ticks, chosen
    panel = track_panel([track], length, Region(LEFT, 12.0, width, height), room=circle, x_ticks=7 if is_strip else 5,
                        y_ticks=3 if is_strip else 5)  # fmt: skip
    note: tuple[Mark, ...] = ()
    if math.isfinite(room):
        words = f"sea room {room:.4g} m" + ("" if is_near else ", beyond the picture")
        corner = panel.y.ends[0] if panel.is_y_down else panel.y.ends[1]
        note = (Text(panel.x.ends[1], corner, words, Anchor.END, 10.0, SECOND, dx=-4.0, dy=12.0),)  # px, chosen
    annotated = Panel(panel.box, panel.x, panel.y, (*panel.marks, *note), is_y_down=panel.is_y_down)
    return Chart("track of the designed manoeuvre", (annotated,), width=LEFT + width + RIGHT)


def _circle(radius: float) -> Track:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)  # points of a curve, chosen
    return Track(radius * np.cos(angle), radius * np.sin(angle), None, LIMIT)
