"""A demand and how the ship follows it: course change, speed change, zigzag; ships drawn as thin lines."""

import math

import numpy as np

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
    segment,
    span,
    text,
)  # fmt: skip
from seatrial.core.figures.scales import Entry, legend
from seatrial.core.figures.seaway_simulations import first_channel
from seatrial.core.results.tuning import ManoeuvreResponse, Tuning
from seatrial.core.text.words import counted
from seatrial.core.values import Array, display_unit

LEFT, HEIGHT, LOW, GAP, POINTS, MOST = 64.0, 170.0, 90.0, 24.0, 500, 40
DEMAND, REFERENCE, RESPONSE, SAMPLED, LIMIT = (
    Stroke(INK, 0.9, "1.5 2"), Stroke(INK, 1.2, "5 3"), Stroke(ACCENT, 2.0), Stroke(GREY, 0.6),
    Stroke(SECOND, 1.0, "6 3"),
)  # fmt: skip
DEMAND_CURVES = (("demand", DEMAND), ("reference", REFERENCE))


def manoeuvre(m: ManoeuvreResponse, tuning: Tuning) -> str:
    """Demand and answer above, the actuator with its limit below; empty without the output."""
    record, output = m.record, first_channel(m.record, m.output, "output")
    if not output or len(record) < 2:
        return ""
    unit = record.channel(output).unit
    factor = display_unit(unit)[0]
    asked = [(name, stroke) for name, stroke in DEMAND_CURVES if name in record]
    drawn = [row for row in np.atleast_2d(m.sampled_outputs) if row.shape == record.time.shape][:MOST]
    lines: list[Entry] = [("answer", RESPONSE), *asked]
    lines += [(counted(len(drawn), "ship") + " drawn", Stroke(GREY, 1.2))] if drawn else []
    head, top = legend(lines, left_edge=LEFT)
    everything = [*drawn, record[output], *(record[name] for name, _ in asked)]
    end = (float(record.time[0]), float(record.time[-1]))
    panel = Panel(LEFT, top + 6, WIDTH - LEFT - 8, HEIGHT, end, span([one * factor for one in everything]))

    def line(values: Array, stroke: Stroke) -> str:
        return panel.curve(*decimated(record.time, values * factor, POINTS), stroke)

    parts = [head, axes(panel, x_ticks=9, y_ticks=5, y_label=label(m.output, unit))]
    parts += [line(row, SAMPLED) for row in drawn]
    parts.append(line(record[output], RESPONSE))
    parts += [line(record[name], stroke) for name, stroke in asked]
    bottom = panel.top + HEIGHT + GAP
    if first_channel(record, tuning.actuator, "actuator"):
        parts.append(_actuator(m, tuning, Panel(LEFT, bottom, WIDTH - LEFT - 8, LOW, end, (0.0, 1.0))))
        bottom += LOW + GAP
    parts.append(text(WIDTH - 8, bottom + 4, "t [s]", anchor="end"))
    return drawing(parts, bottom + 10, m.name)


def _actuator(m: ManoeuvreResponse, tuning: Tuning, panel: Panel) -> str:
    """The actuator, which begins at its steady value; its limits lie about that."""
    name, limit = first_channel(m.record, tuning.actuator, "actuator"), tuning.constraints.limit
    unit = m.record.channel(name).unit
    values = m.record[name] * display_unit(unit)[0]
    steady, reach = float(values[0]), limit * display_unit(unit)[0]
    ends = steady + np.array([-reach, reach])
    is_near = math.isfinite(limit) and float(np.nanmax(np.abs(values - steady))) > 0.5 * reach
    shown = Panel(panel.left_edge, panel.top, panel.width, panel.height, panel.x,
                  span([values, ends] if is_near else [values], 0.1))  # fmt: skip
    parts = [axes(shown, x_ticks=9, y_ticks=3, y_label=label(tuning.actuator, unit))]
    levels = [float(shown.py(end)) for end in ends] if is_near else []
    parts += [segment(shown.left_edge, y, shown.left_edge + shown.width, y, LIMIT) for y in levels]
    parts.append(clipped(shown, shown.curve(*decimated(m.record.time, values, POINTS), RESPONSE)))
    return "".join(parts)
