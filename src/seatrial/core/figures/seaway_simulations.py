"""Nonlinear simulation: time histories with and without control, differences between controllers."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.plot import (
    ACCENT,
    AXIS,
    FAINT,
    GREY,
    SECOND,
    WIDTH,
    Panel,
    Stroke,
    axes,
    clipped,
    decimated,
    drawing,
    label,
    segment,
    span,
    text,
    tick_text,
    ticks,
)  # fmt: skip
from seatrial.core.figures.scales import legend
from seatrial.core.results.tuning import PairedDifference, SeawaySimulation, Tuning
from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import counted
from seatrial.core.values import Record, display_unit

LEFT, HEIGHT, GAP, ROW = 64.0, 112.0, 26.0, 24.0
MOST, WINDOW, POINTS = 3, 150.0, 1200
UNCONTROLLED_STROKE, CONTROLLED_STROKE, LIMIT = Stroke(GREY, 1.5), Stroke(ACCENT, 1.3), Stroke(SECOND, 1.0, "6 3")
STAGES = {"linear": "without limits", "limited": "with limits", "stalled": "with stall, too"}
UNCONTROLLED = ("uncontrolled", "free", "without")


def first_channel(record: Record, *names: str) -> str:
    """The first of the names that the record has as a channel; empty for none."""
    return next((name for name in names if name in record), "")


def uncontrolled_channel(record: Record, output: str) -> str:
    """The channel of the output without control; empty for none."""
    return first_channel(record, *UNCONTROLLED, *(f"{output}_{word}" for word in UNCONTROLLED))


def time_histories(tuning: Tuning) -> str:
    """The roughest stretch of the first seed: output and actuator of the first controllers; empty for none."""
    sailed = [
        s for s in tuning.seaway_simulations if first_channel(s.record, tuning.output, "output") and len(s.record) > 1
    ][:MOST]
    if not sailed:
        return ""
    has_free = any(uncontrolled_channel(s.record, tuning.output) for s in sailed)
    head, top = legend(
        [("with control", CONTROLLED_STROKE), *([("without", UNCONTROLLED_STROKE)] if has_free else [])], left_edge=LEFT
    )
    start, stop = _window(sailed[0].record, tuning.output)
    cut = [s.record.between(start, stop) for s in sailed]
    parts, top = [head], top + 18
    for draw in (_output, _actuator):
        for s, record in zip(sailed, cut, strict=True):
            panel = Panel(LEFT, top, WIDTH - LEFT - 8, HEIGHT, (start, stop), (0, 1))
            made = draw(tuning, record, cut, panel, s.name)
            parts.append(made)
            top += HEIGHT + GAP if made else 0.0
    shared = Panel(LEFT, top, WIDTH - LEFT - 8, HEIGHT, (start, stop), (0, 1))
    parts += [text(float(shared.px(t)), top - GAP + 14, tick_text(t, shared.x), anchor="middle", size=10)
              for t in ticks(start, stop, 8)]  # fmt: skip
    parts.append(text(WIDTH - 8, top + 4, "t [s]", anchor="end"))
    return drawing(parts, top + 10, "time histories")


def _window(record: Record, output: str) -> tuple[float, float]:
    """The window about the largest output, without control where that is known."""
    seen = record[uncontrolled_channel(record, output) or first_channel(record, output, "output")]
    middle = float(record.time[int(np.nanargmax(np.abs(seen)))]) if np.isfinite(seen).any() else 0.0
    first, last = float(record.time[0]), float(record.time[-1])
    start = min(max(first, middle - 0.5 * WINDOW), max(first, last - WINDOW))
    return start, min(last, start + WINDOW)


def _output(tuning: Tuning, record: Record, all_records: Sequence[Record], panel: Panel, title: str) -> str:
    """The output, and without control behind it where that is known."""
    name, free = first_channel(record, tuning.output, "output"), uncontrolled_channel(record, tuning.output)
    unit = record.channel(name).unit
    factor = display_unit(unit)[0]
    reach = [r[c] * factor for r in all_records for c in (first_channel(r, tuning.output, "output"),
                                                         uncontrolled_channel(r, tuning.output)) if c]  # fmt: skip
    shown = Panel(panel.left_edge, panel.top, panel.width, panel.height, panel.x, span(reach, 0.05))
    parts = [axes(shown, x_ticks=8, y_ticks=4, x_labels=False, y_label=label(tuning.output, unit), title=title)]
    if free:
        parts.append(shown.curve(*decimated(record.time, record[free] * factor, POINTS), UNCONTROLLED_STROKE))
    parts.append(shown.curve(*decimated(record.time, record[name] * factor, POINTS), CONTROLLED_STROKE))
    return "".join(parts)


def _actuator(tuning: Tuning, record: Record, all_records: Sequence[Record], panel: Panel, title: str) -> str:
    """The actuator with its limits; empty without one."""
    name = first_channel(record, tuning.actuator, "actuator")
    if not name:
        return ""
    unit, limit = record.channel(name).unit, tuning.constraints.limit
    factor = display_unit(unit)[0]
    reach = [r[c] * factor for r in all_records if (c := first_channel(r, tuning.actuator, "actuator"))]
    ends = np.array([-limit, limit]) * factor if math.isfinite(limit) else np.empty(0)
    shown = Panel(panel.left_edge, panel.top, panel.width, panel.height, panel.x, span([*reach, ends], 0.08))
    parts = [axes(shown, x_ticks=8, y_ticks=4, x_labels=False, y_label=label(tuning.actuator, unit), title=title)]
    levels = [float(shown.py(end)) for end in ends]
    parts += [segment(shown.left_edge, y, shown.left_edge + shown.width, y, LIMIT) for y in levels]
    parts.append(clipped(shown, shown.curve(*decimated(record.time, record[name] * factor, POINTS), CONTROLLED_STROKE)))
    return "".join(parts)


def differences(items: Sequence[PairedDifference]) -> str:
    """A row for each comparison: mean and interval in points of reduction, zero marked; empty for none."""
    if not items:
        return ""
    ends = [100.0 * x for p in items for x in (p.lower, p.upper, 0.0)]
    low, high = span([np.array(ends)], 0.08)
    names = [f"over {p.baseline}, {STAGES.get(p.stage, p.stage)}" for p in items]
    margin, right = 6.4 * max(len(name) for name in names) + 16, 190.0
    panel = Panel(margin, 8, WIDTH - margin - right, ROW * len(items), (low, high), (0.0, 1.0))
    bottom = panel.top + panel.height
    parts = []
    for value in ticks(low, high, 6):
        x = float(panel.px(value))
        parts.append(segment(x, panel.top, x, bottom, Stroke(FAINT, 0.8)))
        parts.append(text(x, bottom + 14, tick_text(value, panel.x), anchor="middle", size=10))
    zero = float(panel.px(0.0))
    parts.append(segment(zero, panel.top, zero, bottom, Stroke(AXIS, 1.2)))
    parts += [_interval(panel, p, name, panel.top + ROW * (k + 0.5)) for k, (p, name) in
              enumerate(zip(items, names, strict=True))]  # fmt: skip
    parts.append(text(panel.left_edge + panel.width / 2, bottom + 30, "points of reduction", anchor="middle"))
    return drawing(parts, bottom + 38, "paired differences")


def _interval(panel: Panel, p: PairedDifference, name: str, y: float) -> str:
    lower, mean, upper = (float(panel.px(100.0 * x)) for x in (p.lower, p.mean, p.upper))
    bar = Stroke(ACCENT, 1.8)
    numbers = f"{fixed(100 * p.mean, 1)} [{fixed(100 * p.lower, 1)}, {fixed(100 * p.upper, 1)}]"
    return "".join([
        text(panel.left_edge - 10, y + 4, name, anchor="end", size=10.5),
        segment(lower, y, upper, y, bar),
        segment(lower, y - 4, lower, y + 4, bar),
        segment(upper, y - 4, upper, y + 4, bar),
        f'<circle cx="{mean:.1f}" cy="{y:.1f}" r="3.6" fill="{ACCENT}"/>',
        text(panel.left_edge + panel.width + 10, y + 4, f"{numbers}, {counted(p.seeds, 'seed')}", size=10.5),
    ])  # fmt: skip


def seed_count(sailed: Sequence[SeawaySimulation]) -> int:
    """Number of seeds of the first."""
    return len(sailed[0].linear) if sailed else 0
