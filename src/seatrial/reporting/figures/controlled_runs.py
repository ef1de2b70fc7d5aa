"""Runs with a controller: a demand and how the ship follows it; a seaway with and without control."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import Axis, Chart, LegendEntry, Panel, Region, tiles
from seatrial.core.figures.marks import ACCENT, GREY, INK, SECOND, Array, Line, Rule, Stroke
from seatrial.core.figures.ticks import decimated, span
from seatrial.core.results.tuning import ManoeuvreResponse, Tuning
from seatrial.core.text.words import counted
from seatrial.core.values import Record, display_unit
from seatrial.core.values.channel_text import channel_label

# simulations of a seaway drawn at most, the stretch of each [s], points of a curve
MAX_SIMULATIONS, WINDOW, SEAWAY_POINTS = 3, 150.0, 1200
# ships drawn at most, points of a curve of a manoeuvre
MAX_SHIPS, POINTS = 40, 500
# heights of panels [px]
SEAWAY_HEIGHT, OUTPUT_HEIGHT, ACTUATOR_HEIGHT = 112.0, 170.0, 90.0
RESPONSE, CONTROLLED, FREE = Stroke(ACCENT, 2.0), Stroke(ACCENT, 1.3), Stroke(GREY, 1.5)  # px, chosen
SHIP, LIMIT = Stroke(GREY, 0.6), Stroke(SECOND, 1.0, "6 3")  # px, chosen
DEMANDS = {"demand": Stroke(INK, 0.9, "1.5 2"), "reference": Stroke(INK, 1.2, "5 3")}  # px, chosen
UNCONTROLLED = ("uncontrolled", "free", "without")


def first_channel(record: Record, *names: str) -> str:
    """Return the first of the names that the record has as a channel; empty for none."""
    return next((name for name in names if name in record), "")


def uncontrolled_channel(record: Record, output: str) -> str:
    """Return the channel of the output without control; empty for none."""
    return first_channel(record, *UNCONTROLLED, *(f"{output}_{word}" for word in UNCONTROLLED))


def manoeuvre_chart(m: ManoeuvreResponse, tuning: Tuning) -> Chart | None:
    """Return demand and response above, the actuator with its limit below; None without the output."""
    record, output = m.record, first_channel(m.record, m.output, "output")
    if not output or len(record) < 2:
        return None
    demands = {name: stroke for name, stroke in DEMANDS.items() if name in record}
    ships = [row for row in np.atleast_2d(m.sampled_outputs) if row.shape == record.time.shape][:MAX_SHIPS]
    curves = [(row, SHIP) for row in ships] + [(record[output], RESPONSE)]
    curves += [(record[name], stroke) for name, stroke in demands.items()]
    actuator = first_channel(record, tuning.actuator, "actuator")
    above, below = tiles(2, 1, OUTPUT_HEIGHT, gap=24.0, top=6.0)  # px, chosen
    panels = [_panel(record, m.output, record.channel(output).unit, curves, above, is_last=not actuator)]
    if actuator:
        panels.append(
            _manoeuvre_actuator(record, actuator, tuning, Region(below.left, below.top, below.width, ACTUATOR_HEIGHT))
        )
    legend = [LegendEntry("response", RESPONSE), *(LegendEntry(name, stroke) for name, stroke in demands.items())]
    legend += [LegendEntry(counted(len(ships), "ship") + " drawn", Stroke(GREY, 1.2))] if ships else []  # px, chosen
    return Chart(m.name, tuple(panels), tuple(legend))


def _panel(record: Record, name: str, unit: str, curves: Sequence[tuple[Array, Stroke]], box: Region, *, is_last: bool,
           # ticks, chosen
           ranges: Sequence[Array] = (), limits: Sequence[float] = (), title: str = "", y_ticks: int = 5,
           points: int = POINTS, margin: float = 0.06) -> Panel:  # fmt: skip
    """Curves of one quantity over time with its limits, both in SI; `ranges`: what the axis shows besides.

    y_ticks: number of ticks, chosen; points: of a curve at most.
    """
    factor = display_unit(unit)[0]
    # ticks, chosen
    x = Axis(
        (float(record.time[0]), float(record.time[-1])), "t [s]" if is_last else "", tick_count=9, has_labels=is_last
    )
    y = Axis(span([a * factor for a in (*(c for c, _ in curves), *ranges, np.array(limits))], margin),
             channel_label(name, unit), tick_count=y_ticks)  # fmt: skip
    lines = [Line(*decimated(record.time, values * factor, points), stroke) for values, stroke in curves]
    return Panel(box, x, y, (*(Rule(limit * factor, LIMIT) for limit in limits), *lines), title)


def _manoeuvre_actuator(record: Record, name: str, tuning: Tuning, box: Region) -> Panel:
    """The actuator, which begins at its steady value; its limits lie about that, and are drawn where they are near."""
    values, limit = record[name], tuning.constraints.limit
    steady = float(values[0])
    is_near = math.isfinite(limit) and float(np.nanmax(np.abs(values - steady))) > 0.5 * limit
    return _panel(record, tuning.actuator, record.channel(name).unit, [(values, RESPONSE)], box, is_last=True,
                  limits=(steady - limit, steady + limit) if is_near else (), y_ticks=3, margin=0.1)  # fmt: skip


def seaway_chart(tuning: Tuning) -> Chart | None:
    """Return the roughest stretch of the first seed: output and actuator of the first controllers; None for none."""
    simulations = [
        s for s in tuning.seaway_simulations if first_channel(s.record, tuning.output, "output") and len(s.record) > 1
    ][:MAX_SIMULATIONS]
    if not simulations:
        return None
    window = _window(simulations[0].record, tuning.output)
    records = {s.name: s.record.between(*window) for s in simulations}
    outputs = {name: _output_curves(r, tuning.output) for name, r in records.items()}
    actuators = {name: [(r[c], CONTROLLED)] for name, r in records.items()
                 if (c := first_channel(r, tuning.actuator, "actuator"))}  # fmt: skip
    limit = tuning.constraints.limit
    rows = [(name, tuning.output, curves, outputs, ()) for name, curves in outputs.items()]
    rows += [(name, tuning.actuator, curves, actuators, (-limit, limit) if math.isfinite(limit) else ())
             for name, curves in actuators.items()]  # fmt: skip
    boxes = tiles(len(rows), 1, SEAWAY_HEIGHT, top=20.0)
    panels = tuple(
        _panel(records[name], symbol, _unit(records[name], symbol, tuning), curves, box, is_last=box is boxes[-1],
               ranges=[values for some in alike.values() for values, _ in some], limits=limits, title=name, y_ticks=4,
               points=SEAWAY_POINTS)
        for box, (name, symbol, curves, alike, limits) in zip(boxes, rows, strict=True)
    )  # fmt: skip
    has_free = any(stroke is FREE for curves in outputs.values() for _, stroke in curves)
    legend = [LegendEntry("with control", CONTROLLED), *([LegendEntry("without", FREE)] if has_free else [])]
    return Chart("time histories", panels, tuple(legend))


def _unit(record: Record, symbol: str, tuning: Tuning) -> str:
    role = "output" if symbol == tuning.output else "actuator"
    return record.channel(first_channel(record, symbol, role)).unit


def _output_curves(record: Record, output: str) -> list[tuple[Array, Stroke]]:
    """The output without control, where that is known, and with it."""
    free = uncontrolled_channel(record, output)
    return [*([(record[free], FREE)] if free else []), (record[first_channel(record, output, "output")], CONTROLLED)]


def _window(record: Record, output: str) -> tuple[float, float]:
    """Start and end [s] of the window about the largest output, without control where that is known."""
    values = record[uncontrolled_channel(record, output) or first_channel(record, output, "output")]
    middle = float(record.time[int(np.nanargmax(np.abs(values)))]) if np.isfinite(values).any() else 0.0
    first, last = float(record.time[0]), float(record.time[-1])
    start = min(max(first, middle - 0.5 * WINDOW), max(first, last - WINDOW))
    return start, min(last, start + WINDOW)
