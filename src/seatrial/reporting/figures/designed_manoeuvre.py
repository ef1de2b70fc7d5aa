"""What a designed manoeuvre does: orders over time, the drift angle against its limit, the track with the sea room."""

import math

import numpy as np

from seatrial.core.figures.chart import WIDTH, Axis, Chart, Panel, Region, tiles
from seatrial.core.figures.marks import ACCENT, GREY, INK, SECOND, Anchor, Array, Line, Mark, Rule, Stroke, Text
from seatrial.core.figures.ticks import decimated, span
from seatrial.core.figures.tracks import Track, is_slender, strip_height, track_panel
from seatrial.core.results import Actuator, Design
from seatrial.core.results.design import has_drift
from seatrial.core.values import Record, display_unit
from seatrial.core.values.channel_text import channel_label, channel_unit, display_values
from seatrial.core.values.record_chart import has_track, record_track

ORDERED, EXECUTED, LIMIT = Stroke(GREY, 2.6), Stroke(ACCENT, 1.3), Stroke(SECOND, 1.0, "6 3")  # px, chosen
HEIGHT, POINTS = 120.0, 700  # px, chosen
LEFT, RIGHT = 64.0, 12.0  # px, chosen
# a sea room larger than the track by this ratio is not drawn
LARGEST_ROOM_RATIO = 2.0
# share of the page's width that a track takes which is no strip; least height of a strip [px]
SQUARE_SHARE, MIN_STRIP = 0.62, 70.0


def order_chart(design: Design) -> Chart:
    """Return a panel for each input that is moved and one for the drift angle, if there is one, over one time axis."""
    drift = drift_angle(design.designed.executed) if has_drift(design) else None
    count = len(design.actuators) + (drift is not None)
    boxes = tiles(count, 1, HEIGHT, left=LEFT, right=RIGHT, gap=30.0, top=6.0)  # px, chosen
    panels = []
    for k, box in enumerate(boxes):
        x = Axis((0.0, design.duration), "t [s]" if k == count - 1 else "", tick_count=9)  # px and ticks, chosen
        is_order = k < len(design.actuators)
        panels.append(
            _order_panel(design, design.actuators[k], box, x) if is_order else _drift_panel(design, drift, box, x)
        )
    return Chart("orders over time", tuple(panels))


def drift_angle(record: Record) -> Array | None:
    """Return the drift angle [rad], positive when the bow points to starboard of the course; None without u and v."""
    return np.arctan2(-record["v"], record["u"]) if {"u", "v"} <= set(record.channels) else None


def _order_panel(design: Design, actuator: Actuator, box: Region, x: Axis) -> Panel:
    name, unit = actuator.name, channel_unit(actuator.name)
    factor, executed = display_unit(unit)[0], design.designed.executed
    ordered = [(order.time, order.values[name]) for order in design.orders if name in order.values]
    limits = factor * np.array([actuator.lower, actuator.upper])
    marks: list[Mark] = [Rule(float(limit), LIMIT) for limit in limits]
    if ordered:
        times = np.repeat(np.array([time for time, _ in ordered] + [design.duration]), 2)[1:-1]
        marks.append(Line(times, np.repeat([value * factor for _, value in ordered], 2), ORDERED))
    marks.append(Line(*decimated(executed.time, display_values(name, executed[name], unit), POINTS), EXECUTED))
    # px and ticks, chosen
    return Panel(box, x, Axis(span([limits], 0.1), channel_label(name, unit), tick_count=3), tuple(marks))


def _drift_panel(design: Design, drift: Array | None, box: Region, x: Axis) -> Panel:
    degrees, limit = np.degrees(np.zeros(0) if drift is None else drift), math.degrees(design.limits.drift)
    limits = np.array([-limit, limit]) if math.isfinite(limit) else np.empty(0)
    marks: list[Mark] = [Rule(float(end), LIMIT) for end in limits]
    marks.append(Line(*decimated(design.designed.executed.time, degrees, POINTS), Stroke(INK, 1.1)))  # px, chosen
    return Panel(box, x, Axis(span([degrees, limits], 0.1), "drift β [deg]", tick_count=3), tuple(marks))


def track_chart(design: Design) -> Chart | None:
    """Return the track from above within the sea room; None where the model has no position."""
    executed = design.designed.executed
    if not has_track(executed):
        return None
    parameters, room = design.model.parameters, design.limits.sea_room
    length = parameters["L"].value if "L" in parameters else 0.0
    is_near = room < LARGEST_ROOM_RATIO * float(np.hypot(executed["x0"], executed["y0"]).max())
    track, circle = record_track(executed, EXECUTED), [_circle(room)] if is_near else []
    is_strip = is_slender([track, *circle])
    width = WIDTH - LEFT - RIGHT if is_strip else SQUARE_SHARE * WIDTH
    height = max(MIN_STRIP, strip_height([track, *circle], width, length)) if is_strip else width
    # px and ticks, chosen
    panel = track_panel([track], length, Region(LEFT, 12.0, width, height), room=circle, x_ticks=7,
                        y_ticks=3 if is_strip else 7)  # fmt: skip
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
