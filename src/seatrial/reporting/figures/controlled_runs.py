"""Runs with a controller: a demand and how the ship follows it; a seaway with and without control."""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.figures.chart import ACCENT, GREY, INK, SECOND, LegendEntry, Rule, Stroke, span
from seatrial.core.figures.run import BAND, ChannelPanel, RunView, TimeCurve
from seatrial.core.results.tuning import ManoeuvreResponse, Tuning
from seatrial.core.text.words import counted
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_label, unit_text

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
