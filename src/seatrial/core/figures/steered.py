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
    clipped,
    decimated,
    drawing,
    label,
    path,
    segment,
    shown,
    span,
    text,
    unit_of,
)  # fmt: skip
from seatrial.core.results import Actuator, Design
from seatrial.core.values import Array, Record, display

LEFT, HEIGHT, GAP = 64.0, 120.0, 26.0
ORDERED, EXECUTED, LIMIT = Stroke(GREY, 2.6), Stroke(ACCENT, 1.3), Stroke(SECOND, 1.0, "6 3")
POINTS = 700
# a sea room larger than the track by this is not drawn
NEAR = 2.0


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
        panel = Panel(LEFT, top, WIDTH - LEFT - 12, HEIGHT, end, _reach(drift, limit))
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
    view = tracks.View(lying=tracks.is_slender([executed]) and north > east)
    room = design.limits.room
    is_near = room < NEAR * float(np.hypot(executed["x0"], executed["y0"]).max())
    shape = [executed, _circle(room)] if is_near else [executed]
    slender = tracks.is_slender(shape)
    width = WIDTH - LEFT - 12 if slender else 0.62 * WIDTH
    n, e = tracks.extents(shape)
    height = max(70.0, width * (min(n, e) + length) / (max(n, e) + length)) if slender else width
    panel = tracks.fitted(shape, view, length, (LEFT, 12.0, width, height))
    names = ("x₀, north [m]", "y₀, east [m]") if view.lying else ("y₀, east [m]", "x₀, north [m]")
    parts = [axes(panel, x_label=names[0], y_label=names[1], x_ticks=7, y_ticks=3 if slender else 7)]
    if math.isfinite(room):
        edge = _circle(room)
        parts.append(clipped(panel, path(panel.px(view.across(edge)), panel.py(view.along(edge)), LIMIT)))
        words = f"sea room {room:.4g} m" + ("" if is_near else ", beyond the picture")
        parts.append(text(panel.left + panel.width - 4, panel.top + 12, words, anchor="end", colour=SECOND, size=10))
    parts.append(tracks.drawn(panel, view, executed, length, EXECUTED))
    return drawing(parts, panel.top + panel.height + 40, "track of the designed manoeuvre", panel.left + width + 12)


def _circle(room: float) -> Record:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return Record.of("sea room", angle, {"x0": room * np.cos(angle), "y0": room * np.sin(angle)})


def _range(actuator: Actuator) -> tuple[float, float]:
    factor = display(unit_of(actuator.name))[0]
    return span([np.array([actuator.lower, actuator.upper]) * factor], 0.1)


def _reach(drift: Array, limit: float) -> tuple[float, float]:
    ends = [drift, np.array([-limit, limit])] if math.isfinite(limit) else [drift]
    return span([np.degrees(one) for one in ends], 0.1)


def _orders(design: Design, actuator: Actuator, panel: Panel) -> str:
    name, unit = actuator.name, unit_of(actuator.name)
    factor, executed = display(unit)[0], design.designed.executed
    told = [(order.time, order.values[name]) for order in design.orders if name in order.values]
    parts = [axes(panel, x_ticks=9, y_ticks=3, y_label=label(name, unit))]
    parts += [_level(panel, end * factor) for end in (actuator.lower, actuator.upper)]
    if told:
        times = np.repeat(np.array([t for t, _ in told] + [design.duration]), 2)[1:-1]
        parts.append(panel.curve(times, np.repeat([v * factor for _, v in told], 2), ORDERED))
    parts.append(panel.curve(*decimated(executed.time, shown(name, executed[name], unit), POINTS), EXECUTED))
    return "".join(parts)


def _drift(time: Array, drift: Array, limit: float, panel: Panel) -> str:
    parts = [axes(panel, x_ticks=9, y_ticks=3, y_label="drift β [deg]")]
    if math.isfinite(limit):
        parts += [_level(panel, side * math.degrees(limit)) for side in (-1.0, 1.0)]
    parts.append(clipped(panel, panel.curve(*decimated(time, np.degrees(drift), POINTS), Stroke(INK, 1.1))))
    return "".join(parts)


def _level(panel: Panel, value: float) -> str:
    y = float(panel.py(value))
    return segment(panel.left, y, panel.left + panel.width, y, LIMIT)
