"""What a designed manoeuvre does: orders over time, the drift angle against its limit, the track with the sea room."""

import math

import numpy as np

from seatrial.core.figures import tracks
from seatrial.core.figures.plot import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    axes,
    channel_si_unit,
    clipped,
    decimated,
    display_values,
    drawing,
    label,
    path,
    segment,
    span,
    text,
)  # fmt: skip
from seatrial.core.results import Actuator, Design
from seatrial.core.values import Array, Record, display_unit

LEFT, HEIGHT, GAP = 64.0, 120.0, 26.0
ORDERED, EXECUTED, LIMIT = Stroke(GREY, 2.6), Stroke(ACCENT, 1.3), Stroke(SECOND, 1.0, "6 3")
POINTS = 700
# a sea room larger than the track by this is not drawn
LARGEST_ROOM_RATIO = 2.0


def over_time(design: Design) -> str:
    """A panel for each input that is moved and one for the drift angle, on one time axis."""
    executed = design.designed.executed
    drift = drift_angle(executed)
    end = (0.0, design.duration)
    parts, top = [], 20.0
    for actuator in design.actuators:
        parts.append(_orders(design, actuator, Panel(LEFT, top, WIDTH - LEFT - 12, HEIGHT, end, _range(actuator))))
        top += HEIGHT + GAP
    if drift is not None:
        limit = design.limits.drift
        panel = Panel(LEFT, top, WIDTH - LEFT - 12, HEIGHT, end, _drift_range(drift, limit))
        parts.append(_drift(executed.time, drift, limit, panel))
        top += HEIGHT + GAP
    parts.append(text(WIDTH - 12, top + 6, "t [s]", anchor="end"))
    return drawing(parts, top + 12, "orders over time")


def drift_angle(record: Record) -> Array | None:
    """Drift angle [rad], positive when the bow points to starboard of the course; None without u and v."""
    return np.arctan2(-record["v"], record["u"]) if {"u", "v"} <= set(record.channels) else None


def track(design: Design) -> str:
    """The track from above within the sea room; empty where the model has no position."""
    executed = design.designed.executed
    if not tracks.has_track(executed):
        return ""
    known = design.model.parameters
    length = known["L"].value if "L" in known else 0.0
    north, east = tracks.extents([executed])
    view = tracks.TrackView(is_rotated=tracks.is_slender([executed]) and north > east)
    room = design.limits.sea_room
    is_near = room < LARGEST_ROOM_RATIO * float(np.hypot(executed["x0"], executed["y0"]).max())
    shape = [executed, _circle(room)] if is_near else [executed]
    slender = tracks.is_slender(shape)
    width = WIDTH - LEFT - 12 if slender else 0.62 * WIDTH
    n, e = tracks.extents(shape)
    height = max(70.0, width * (min(n, e) + length) / (max(n, e) + length)) if slender else width
    panel = tracks.equal_scale_panel(shape, view, length, (LEFT, 12.0, width, height))
    names = ("x₀, north [m]", "y₀, east [m]") if view.is_rotated else ("y₀, east [m]", "x₀, north [m]")
    parts = [axes(panel, x_label=names[0], y_label=names[1], x_ticks=7, y_ticks=3 if slender else 7)]
    if math.isfinite(room):
        edge = _circle(room)
        parts.append(clipped(panel, path(panel.px(view.horizontal(edge)), panel.py(view.vertical(edge)), LIMIT)))
        words = f"sea room {room:.4g} m" + ("" if is_near else ", beyond the picture")
        parts.append(
            text(panel.left_edge + panel.width - 4, panel.top + 12, words, anchor="end", colour=SECOND, size=10)
        )
    parts.append(tracks.track_svg(panel, view, executed, length, EXECUTED))
    return drawing(
        parts, panel.top + panel.height + 40, "track of the designed manoeuvre", panel.left_edge + width + 12
    )


def _circle(radius: float) -> Record:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return Record.from_arrays("sea room", angle, {"x0": radius * np.cos(angle), "y0": radius * np.sin(angle)})


def _range(actuator: Actuator) -> tuple[float, float]:
    factor = display_unit(channel_si_unit(actuator.name))[0]
    return span([np.array([actuator.lower, actuator.upper]) * factor], 0.1)


def _drift_range(drift: Array, limit: float) -> tuple[float, float]:
    ends = [drift, np.array([-limit, limit])] if math.isfinite(limit) else [drift]
    return span([np.degrees(one) for one in ends], 0.1)


def _orders(design: Design, actuator: Actuator, panel: Panel) -> str:
    name, unit = actuator.name, channel_si_unit(actuator.name)
    factor, executed = display_unit(unit)[0], design.designed.executed
    told = [(order.time, order.values[name]) for order in design.orders if name in order.values]
    parts = [axes(panel, x_ticks=9, y_ticks=3, y_label=label(name, unit))]
    parts += [_limit_line(panel, end * factor) for end in (actuator.lower, actuator.upper)]
    if told:
        times = np.repeat(np.array([t for t, _ in told] + [design.duration]), 2)[1:-1]
        parts.append(panel.curve(times, np.repeat([v * factor for _, v in told], 2), ORDERED))
    parts.append(panel.curve(*decimated(executed.time, display_values(name, executed[name], unit), POINTS), EXECUTED))
    return "".join(parts)


def _drift(time: Array, drift: Array, limit: float, panel: Panel) -> str:
    parts = [axes(panel, x_ticks=9, y_ticks=3, y_label="drift β [deg]")]
    if math.isfinite(limit):
        parts += [_limit_line(panel, side * math.degrees(limit)) for side in (-1.0, 1.0)]
    parts.append(clipped(panel, panel.curve(*decimated(time, np.degrees(drift), POINTS), Stroke(INK, 1.1))))
    return "".join(parts)


def _limit_line(panel: Panel, value: float) -> str:
    y = float(panel.py(value))
    return segment(panel.left_edge, y, panel.left_edge + panel.width, y, LIMIT)
