"""Charts of controllers: the loop, runs with them, maps of a schedule, and paired differences."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    GREY,
    INK,
    SECOND,
    WIDTH,
    Anchor,
    Area,
    Axis,
    Chart,
    LegendEntry,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Rectangle,
    Region,
    Rule,
    Shape,
    Stroke,
    Text,
    row_axis,
    span,
)
from seatrial.core.figures.panels import SMALL, colour, colour_key, row_panel
from seatrial.core.figures.run import BAND, ChannelPanel, RunView, TimeCurve
from seatrial.core.results.tuning import Component, ManoeuvreResponse, OperatingPoint, PairedDifference, Tuning
from seatrial.core.text.numbers import DASH, exact, fixed
from seatrial.core.text.words import counted
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_label, channel_letter, unit_text

# The loop as a block diagram: sensors, parallel terms, filters, servo, plant; the disturbance from above.

# height of a block, distance of parallel ones, radius of a sum [px]
HEIGHT, ROW, RADIUS = 42.0, 54.0, 8.0
# width of the widest block, and of the gap before each [px]
WIDEST, GAP = 116.0, 22.0
# width of a letter in a block [px]
LETTER = 5.6
# height that the block of the disturbance and its arrow take above the middle [px]
ABOVE = ROW + HEIGHT + 18.0
ROLES = ("sensor", "term", "filter", "servo", "plant", "disturbance")
_WIRE, _EDGE, _PALE = Stroke(INK, 1.1), Stroke(ACCENT, 1.0), "#eef3f7"  # px, chosen
_SUM = Marker(Shape.CIRCLE, RADIUS, "#8a9299", "#ffffff", 1.1)  # px, chosen


def signal_order(components: Sequence[Component]) -> list[Component]:
    """Return components in the order in which a signal passes them; unknown roles last."""
    return sorted(components, key=lambda c: ROLES.index(c.role) if c.role in ROLES else len(ROLES))


def loop_diagram(components: Sequence[Component], output: str, actuator: str) -> Chart | None:
    """Return negative feedback from left to right; None without components. Data coordinates are px, y down."""
    if not components:
        return None
    by_role = {role: [c for c in components if c.role == role] for role in ROLES}
    terms, disturbance = by_role["term"], by_role["disturbance"]
    columns = [[c] for c in by_role["sensor"]] + ([terms] if terms else [])
    columns += [[c] for role in ("filter", "servo", "plant") for c in by_role[role]]
    tallest = max((len(column) for column in columns), default=1)
    sums = 1 + (len(terms) > 1) + bool(disturbance)
    width = min(WIDEST, (WIDTH - 92.0 - sums * (2 * RADIUS + GAP)) / max(1, len(columns)) - GAP)  # px, chosen
    middle = 6.0 + max(0.5 * (ROW * (tallest - 1) + HEIGHT), ABOVE if disturbance else 0.0)  # px, chosen
    marks, x = [*_arrow((0.0, middle), (18.0, middle)), *_sum(26.0, middle, "−")], 26.0 + RADIUS  # px, chosen
    for column in columns:
        if column[0].role == "plant":
            marks.append(Text(x + GAP / 2, middle - 6, channel_letter(actuator), Anchor.MIDDLE, 10.5))  # px, chosen
        marks += _parallel(column, x, middle, width)
        x += GAP + width
        if len(column) > 1:
            marks += _sum(x + GAP + RADIUS, middle)
            x += GAP + 2 * RADIUS
    if disturbance:
        marks += _disturbance(disturbance[0], x + GAP + RADIUS, x, middle, width)
        x += GAP + 2 * RADIUS
    end, low = x + 40.0, middle + 0.5 * ROW * tallest + 22.0  # px, chosen
    back = (x + end) / 2
    marks += [
        *_arrow((x, middle), (end, middle)),
        Text(end + 4, middle + 4, channel_letter(output)),
        _wire((back, middle), (back, low), (26.0, low)),  # px, chosen
        *_arrow((26.0, low), (26.0, middle + RADIUS)),  # px, chosen
    ]
    page = Region(0.0, 0.0, end + 26.0, low + 8.0)  # px, chosen
    panel = Panel(
        page, Axis((0.0, page.width)), Axis((0.0, page.height)), tuple(marks), is_y_down=True, has_frame=False
    )
    return Chart("block diagram of the loop", (panel,), width=page.width)


def _parallel(column: Sequence[Component], x: float, middle: float, width: float) -> list[Mark]:
    """Blocks above one another between a fork and a sum; one alone between two wires."""
    left, marks = x + GAP, list[Mark]()
    if len(column) == 1:
        return [*_arrow((x, middle), (left, middle)), *_block(left, middle, width, column[0])]
    fork, join = x + 6.0, left + width + GAP + RADIUS  # px, chosen
    for k, c in enumerate(column):
        y = middle + ROW * (k - 0.5 * (len(column) - 1))
        marks += [
            _wire((x, middle), (fork, middle), (fork, y)),
            *_arrow((fork, y), (left, y)),
            *_block(left, y, width, c),
        ]
        if abs(y - middle) < 1.0:
            marks += _arrow((left + width, y), (join - RADIUS, y))
        else:
            marks.append(_wire((left + width, y), (join, y)))
            marks += _arrow((join, y), (join, middle - RADIUS if y < middle else middle + RADIUS))
    return marks


def _disturbance(c: Component, x: float, from_x: float, middle: float, width: float) -> list[Mark]:
    """The disturbance's block above, its response added to the plant's."""
    y = middle - ROW - 0.5 * HEIGHT
    top = y - HEIGHT / 2
    return [
        *_arrow((from_x, middle), (x - RADIUS, middle)), *_sum(x, middle), *_block(x - 0.5 * width, y, width, c),
        *_arrow((x, y + HEIGHT / 2), (x, middle - RADIUS)), *_arrow((x, top - 18.0), (x, top)),  # px, chosen
        Text(x + 5, top - 9.0, "disturbance", size=10.0),  # px, chosen
    ]  # fmt: skip


def _block(left: float, y: float, width: float, c: Component) -> list[Mark]:
    words = f"{c.gain} · {c.name}" if c.gain else c.name
    lines = textwrap.wrap(words, max(6, int(width / LETTER)))[:3] or [c.role]  # px, chosen
    first = y + 3.6 - 6.0 * (len(lines) - 1)  # px, chosen
    # px, chosen
    return [
        Rectangle(left, y - HEIGHT / 2, left + width, y + HEIGHT / 2, _PALE, edge=_EDGE),
        *(Text(left + width / 2, first + 12.0 * k, line, Anchor.MIDDLE, 10.0) for k, line in enumerate(lines)),
    ]


def _sum(x: float, y: float, sign: str = "+") -> list[Mark]:
    """A sum with its sign: + inside, − below the lower left."""
    inside = sign == "+"
    # px, chosen
    words = Text(x, y + 4, sign, Anchor.MIDDLE) if inside else Text(x - 12, y + 20, sign, Anchor.MIDDLE, 13.0)
    return [Points(np.array([x]), np.array([y]), _SUM), words]


def _wire(*corners: tuple[float, float]) -> Line:
    x, y = np.array(corners).T
    return Line(x, y, _WIRE)


def _arrow(start: tuple[float, float], tip: tuple[float, float]) -> list[Mark]:
    """A wire along x or y with a filled head of 6 by 6 px at its tip."""
    a, b = np.array(start), np.array(tip)
    forward = np.sign(b - a)
    aside = 3.0 * forward[::-1]
    head = np.array([b, b - 6.0 * forward - aside, b - 6.0 * forward + aside])  # px, chosen
    return [_wire(start, tuple(b - 5.0 * forward)), Area(head[:, 0], head[:, 1], INK)]  # px, chosen


# Runs with a controller: a demand and how the ship follows it; a seaway with and without control.

# simulations of a seaway drawn at most, and the stretch of each [s]
MAX_SIMULATIONS, WINDOW = 3, 150.0
# share of an actuator's limit from which on the limit is drawn
NEAR_LIMIT = 0.5
RESPONSE, CONTROLLED, FREE = Stroke(ACCENT, 2.0), Stroke(ACCENT, 1.3), Stroke(GREY, 1.5)  # px, chosen
LIMIT = Stroke(SECOND, 1.0, "6 3")  # px, chosen
DEMANDS = {"demand": Stroke(INK, 0.9, "1.5 2"), "reference": Stroke(INK, 1.2, "5 3")}  # px, chosen
UNCONTROLLED = ("uncontrolled", "free", "without")


def first_channel(record: Record, *names: str) -> str:
    """Return the first of the names that the record has as a channel; empty for none."""
    return next((name for name in names if name in record), "")


def uncontrolled_channel(record: Record, output: str) -> str:
    """Return the channel of the output without control; empty for none."""
    return first_channel(record, *UNCONTROLLED, *(f"{output}_{word}" for word in UNCONTROLLED))


def manoeuvre_view(m: ManoeuvreResponse, tuning: Tuning) -> RunView | None:
    """Return demand and response with the range of the ships drawn, and the actuator; None without the output."""
    record, output = m.record, first_channel(m.record, m.output, "output")
    if not output or len(record) < 2:
        return None
    demands = {name: stroke for name, stroke in DEMANDS.items() if name in record}
    factor = display_unit(record.channel(output).unit)[0]
    ships = np.array([row for row in np.atleast_2d(m.sampled_outputs) if row.shape == record.time.shape]) * factor
    curves = [_curve(record, name, stroke, name) for name, stroke in demands.items()]
    label = channel_label(m.output, record.channel(output).unit)
    followed = ChannelPanel(label, (*curves, _curve(record, output, RESPONSE, "response")),
                            *((ships.min(axis=0), ships.max(axis=0)) if len(ships) else ()))  # fmt: skip
    actuator = first_channel(record, tuning.actuator, "actuator")
    legend = [LegendEntry("response", RESPONSE), *(LegendEntry(name, stroke) for name, stroke in demands.items())]
    legend += [LegendEntry(f"range of {counted(len(ships), 'ship')} drawn", BAND)] if len(ships) else []
    panels = (followed, _manoeuvre_actuator(record, actuator, tuning)) if actuator else (followed,)
    return RunView(m.name, panels, legend=tuple(legend))


def _curve(record: Record, channel: str, stroke: Stroke, words: str) -> TimeCurve:
    return TimeCurve(record.time, record[channel] * display_unit(record.channel(channel).unit)[0], stroke, words)


def _manoeuvre_actuator(record: Record, name: str, tuning: Tuning) -> ChannelPanel:
    """The actuator, which begins at its steady value; its limits lie about that, and are drawn where they are near."""
    values, limit, unit = record[name], tuning.constraints.limit, record.channel(name).unit
    steady, factor = float(values[0]), display_unit(unit)[0]
    is_near = math.isfinite(limit) and float(np.nanmax(np.abs(values - steady))) > NEAR_LIMIT * limit
    limits = tuple(Rule(factor * end, LIMIT) for end in (steady - limit, steady + limit)) if is_near else ()
    label = channel_label(tuning.actuator, unit)
    return ChannelPanel(label, (_curve(record, name, RESPONSE, "moved"),), limits=limits)


def seaway_view(tuning: Tuning) -> RunView | None:
    """Return the roughest stretch of the first seed: motion and actuator of the first controllers; None for none."""
    simulations = [s for s in tuning.seaway_simulations if _motion_channel(s.record, tuning) and len(s.record) > 1][
        :MAX_SIMULATIONS
    ]
    if not simulations:
        return None
    window = _window(simulations[0].record, _motion_channel(simulations[0].record, tuning))
    records = {s.name: s.record.between(*window) for s in simulations}
    outputs = {name: _motion_panel(r, name, tuning) for name, r in records.items()}
    actuators = {name: _actuator_panel(r, channel, name, tuning) for name, r in records.items()
                 if (channel := first_channel(r, tuning.actuator, "actuator"))}  # fmt: skip
    has_free = any(curve.stroke is FREE for panel in outputs.values() for curve in panel.curves)
    legend = (LegendEntry("with control", CONTROLLED), *([LegendEntry("without", FREE)] if has_free else []))
    return RunView("time histories", (*_on_one_axis(outputs), *_on_one_axis(actuators)), legend=legend)


def _on_one_axis(panels: dict[str, ChannelPanel]) -> list[ChannelPanel]:
    """The panels with one range, so that they can be compared."""
    if not panels:
        return []
    levels = np.array([rule.value for panel in panels.values() for rule in panel.limits])
    ends = span([*(curve.values for panel in panels.values() for curve in panel.curves), levels])
    return [replace(panel, ends=ends) for panel in panels.values()]


def _motion_channel(record: Record, tuning: Tuning) -> str:
    """Return the channel of what is to be small: the motion that counts, or the output; empty for none."""
    return first_channel(record, *(["motion"] if tuning.motion else []), tuning.output, "output")


def _motion_panel(record: Record, controller: str, tuning: Tuning) -> ChannelPanel:
    """What is to be small without control, where that is known, and with it."""
    motion = _motion_channel(record, tuning)
    free, unit = uncontrolled_channel(record, motion), record.channel(motion).unit
    curves = (_curve(record, free, FREE, "without"),) if free else ()
    name = f"{tuning.motion} [{unit_text(unit)}]" if motion == "motion" else channel_label(tuning.output, unit)
    return ChannelPanel(f"{name}, {controller}", (*curves, _curve(record, motion, CONTROLLED, "with control")))


def _actuator_panel(record: Record, channel: str, controller: str, tuning: Tuning) -> ChannelPanel:
    unit, limit = record.channel(channel).unit, tuning.constraints.limit
    ends = (-limit, limit) if math.isfinite(limit) else ()
    label = f"{channel_label(tuning.actuator, unit)}, {controller}"
    limits = tuple(Rule(display_unit(unit)[0] * end, LIMIT) for end in ends)
    return ChannelPanel(label, (_curve(record, channel, CONTROLLED, "moved"),), limits=limits)


def _window(record: Record, motion: str) -> tuple[float, float]:
    """Start and end [s] of the window about the largest motion, without control where that is known."""
    values = record[uncontrolled_channel(record, motion) or motion]
    middle = float(record.time[int(np.nanargmax(np.abs(values)))]) if np.isfinite(values).any() else 0.0
    first, last = float(record.time[0]), float(record.time[-1])
    start = min(max(first, middle - 0.5 * WINDOW), max(first, last - WINDOW))
    return start, min(last, start + WINDOW)


# A gain schedule as maps: heading by speed for each wave height, compared with other gains; red: little is gained.

THIS_SCHEDULE = "this schedule"
# room for speeds at the left, the key at the right, and between two maps [px]
LEFT, KEY, MAP_GAP = 66.0, 64.0, 14.0
# sides of a cell [px], its height over its width
WIDEST_CELL, LOWEST, HIGHEST, CELL_RATIO = 54.0, 22.0, 34.0, 0.62
_LACKING = Stroke(INK, 1.6)  # px, chosen


def schedule_chart(points: Sequence[OperatingPoint]) -> Chart | None:
    """Return a row of maps for each wave height, a column for the schedule and for each of the others.

    A cell is underlined where no gains are feasible. None without operating points.
    """
    if not points:
        return None
    names = [THIS_SCHEDULE, *points[0].baseline_costs]
    heights, headings = sorted({p.height for p in points}), sorted({p.beta for p in points})
    speeds = sorted({p.U for p in points}, reverse=True)
    wide = min(WIDEST_CELL, ((WIDTH - LEFT - KEY) / len(names) - MAP_GAP) / len(headings))
    size = (wide * len(headings), min(HIGHEST, max(LOWEST, CELL_RATIO * wide)) * len(speeds))
    columns = row_axis([exact(math.degrees(beta), 3) for beta in headings])
    rows = row_axis([exact(U, 3) for U in speeds])
    panels, top = [], 40.0  # px, chosen
    for height in heights:
        is_last = height == heights[-1]
        for k, name in enumerate(names):
            marks = [m for p in points if p.height == height
                     for m in _cell(p, name, headings.index(p.beta), speeds.index(p.U))]  # fmt: skip
            # px, chosen
            marks += [Text(-0.5, -0.5, f"{exact(height, 3)} m", Anchor.END, dx=-5.0, dy=-6.0)] if k == 0 else []
            x = replace(columns, name="heading [deg]" if is_last else "", has_labels=is_last)
            y = replace(rows, name="speed [m/s]" if k == 0 else "", has_labels=k == 0)
            box = Region(LEFT + k * (size[0] + MAP_GAP), top, *size)
            panels.append(Panel(box, x, y, tuple(marks), name if height == heights[0] else "", is_y_down=True,
                                has_lines=False))  # fmt: skip
        top += size[1] + 26.0  # px, chosen
    key = colour_key(LEFT + len(names) * (size[0] + MAP_GAP) + 4.0, 1.0, is_signed=False, top=40.0)  # px, chosen
    return Chart("costs of the schedule", (*panels, key))


def _cell(point: OperatingPoint, name: str, column: int, row: int) -> list[Mark]:
    cost = point.cost if name == THIS_SCHEDULE else point.baseline_costs.get(name, math.nan)
    words = "unst." if math.isinf(cost) else DASH if math.isnan(cost) else fixed(cost, 2)
    marks: list[Mark] = [
        Rectangle(column - 0.5, row - 0.5, column + 0.5, row + 0.5, colour(cost, 1.0), gap=1.5),  # px, chosen
        Text(column, row, words, Anchor.MIDDLE, 10.5, dx=-1.0, dy=3.5),  # px, chosen
    ]
    if name == THIS_SCHEDULE and not point.is_feasible:
        marks.append(Line(np.array([column - 0.45, column + 0.42]), np.full(2, row + 0.38), _LACKING))  # px, chosen
    return marks


# Differences between controllers over the same seas, with their intervals.

STAGE_LABELS = {"linear": "without limits", "limited": "with limits", "stalled": "with stall, too"}
_BAR, _ZERO = Stroke(ACCENT, 1.8), Stroke("#8a9299", 1.2)  # px, chosen
# px, chosen
_END, _MEAN = Marker(Shape.UPRIGHT, 4.0, ACCENT, edge_width=1.8), Marker(Shape.CIRCLE, 3.6, ACCENT, ACCENT, 0.0)


def difference_chart(differences: Sequence[PairedDifference]) -> Chart | None:
    """Return a row for each comparison: mean and interval in points of reduction; None for none."""
    if not differences:
        return None
    marks: list[Mark] = [Rule(0.0, _ZERO, is_vertical=True)]
    # px and shares, chosen
    ends = span([np.array([100.0 * x for p in differences for x in (p.lower, p.upper, 0.0)])], 0.08)
    for row, p in enumerate(differences):
        lower, mean, upper = (100.0 * share for share in (p.lower, p.mean, p.upper))
        words = f"{fixed(mean, 1)} [{fixed(lower, 1)}, {fixed(upper, 1)}], {counted(p.seeds, 'seed')}"
        interval, rows = np.array([lower, upper]), np.full(2, float(row))
        marks += [Line(interval, rows, _BAR), Points(interval, rows, _END), Points(np.array([mean]), rows[:1], _MEAN),
                  Text(ends[1], row, words, size=SMALL, dx=10.0, dy=4.0)]  # fmt: skip
    names = [f"over {p.baseline}, {STAGE_LABELS.get(p.stage, p.stage)}" for p in differences]
    # px and ticks, chosen
    panel = row_panel(names, Axis(ends, "points of reduction", tick_count=6), marks, top=4.0, right=190.0)
    return Chart("paired differences", (panel,))
