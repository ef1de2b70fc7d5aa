"""Channels over time: all records as small multiples, and one run measured beside simulated."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures import bands
from seatrial.core.figures.plot import (
    GREY,
    MEASURED,
    PLAIN,
    SIMULATED,
    WIDTH,
    Panel,
    axes,
    common_prefix,
    decimated,
    display_values,
    drawing,
    label,
    legend,
    span,
    text,
)  # fmt: skip
from seatrial.core.figures.tracks import has_track, overlay
from seatrial.core.results import Prediction
from seatrial.core.values import Array, Record

ORDER = ("psi", "r", "u", "v", "phi", "p", "thrust", "torque", "delta", "n", "v_j", "wind_speed", "wind_direction")
POSITIONS = ("x0", "y0")
MOST_COLUMNS, MOST_ROWS, MOST_PANELS = 8, 16, 9
DISSIMILAR = 0.25
_FINE_POINTS = 1600


def reading_order(names: Sequence[str]) -> list[str]:
    """Channels in the order of reading, positions left out."""
    known = [s for s in dict.fromkeys(names) if s not in POSITIONS]
    return sorted(known, key=lambda s: (ORDER.index(s) if s in ORDER else len(ORDER), s))


def is_constant(record: Record, name: str) -> bool:
    """Whether a channel never changes."""
    values = record[name][np.isfinite(record[name])]
    return values.size == 0 or float(np.ptp(values)) <= 1e-9 * max(1.0, float(np.max(np.abs(values))))


def overview(records: Sequence[Record]) -> list[str]:
    """A row for each record, a column for each channel; channels that are constant everywhere are left out."""
    names = reading_order([s for r in records for s in r.channels if not is_constant(r, s)])[:MOST_COLUMNS]
    if not names:
        return []
    pages = math.ceil(len(records) / MOST_ROWS)
    rows = math.ceil(len(records) / pages)
    prefix = common_prefix([r.name for r in records])
    return [_grid(records[k : k + rows], names, prefix, records) for k in range(0, len(records), rows)]


def _grid(records: Sequence[Record], names: Sequence[str], prefix: str, all_records: Sequence[Record]) -> str:
    labels = [r.name.removeprefix(prefix) for r in records]
    margin = min(190.0, 6.2 * max(len(n) for n in labels) + 10)
    tile = (WIDTH - margin) / len(names)
    durations = [r.duration for r in all_records]
    alike = min(durations) > DISSIMILAR * max(durations)
    height, gap = (46.0 if len(records) > 6 else 74.0), (10.0 if alike else 24.0)
    parts = []
    for i, record in enumerate(records):
        top = 22 + i * (height + gap)
        parts.append(text(0, top + height / 2 + 4, labels[i]))
        end = max(durations) if alike else record.duration
        for k, name in enumerate(names):
            unit = next(r.channel(name).unit for r in all_records if name in r)
            panel = Panel(
                margin + k * tile + 30,
                top,
                tile - 40,
                height,
                (0.0, end or 1.0),
                _value_range(all_records, record, name),
            )
            title = label(name, unit) if i == 0 else ""
            has_labels = not alike or i == len(records) - 1
            parts.append(axes(panel, x_ticks=2, y_ticks=2, x_labels=has_labels, title=title, size=8.5))
            parts.append(_small_panel(panel, record, name))
    total = 22 + len(records) * (height + gap) + 26
    parts.append(text(WIDTH - 10, total - 2, "t [s]", anchor="end", size=9.5))
    return drawing(parts, total, "channels of the records")


def _value_range(all_records: Sequence[Record], record: Record, name: str) -> tuple[float, float]:
    """One range for all records, or the record's own where they differ too much to be seen together."""
    curves = [display_values(name, r[name], r.channel(name).unit) for r in all_records if name in r]
    widths = [span([c], 0.0)[1] - span([c], 0.0)[0] for c in curves]
    if name not in record or min(widths) > DISSIMILAR * max(widths):
        return span(curves)
    return span([display_values(name, record[name], record.channel(name).unit)])


def _small_panel(panel: Panel, record: Record, name: str) -> str:
    if name not in record:
        return text(panel.left_edge + 4, panel.top + panel.height / 2, "not recorded", size=8.5, colour=GREY)
    values = display_values(name, record[name], record.channel(name).unit)
    return panel.curve(*decimated(record.time - record.time[0], values, 200), PLAIN)


def comparison(prediction: Prediction, length: float, inputs: Sequence[str]) -> str:
    """Track and channels of one run: measured broad and grey, simulated thin and dashed; inputs as measured."""
    measured, simulated = prediction.measured, prediction.simulated
    names = [s for s in reading_order(list(measured.channels)) if s in inputs or s in simulated]
    names = [s for s in names if not is_constant(measured, s)][:MOST_PANELS]
    if len(names) == 1 and names[0] not in inputs and not has_track(measured):
        return _single_channel(prediction, names[0])
    entries = [("measured", MEASURED), ("simulated, open loop", SIMULATED)]
    if bands.has_band(prediction):
        entries.append(("95 % band", bands.SAMPLE))
    parts = [legend(entries, WIDTH - 8, 14)]
    top, columns, left, tall = 30.0, 3, 0.0, 0.0
    if has_track(measured) and has_track(simulated):
        picture, tall, is_strip = overlay(prediction, length, top, WIDTH / 3 + 20)
        parts.append(picture)
        if is_strip:
            top, tall = top + tall, 0.0
        else:
            columns, left = 2, WIDTH / 3 + 20
    tile = (WIDTH - left) / columns
    rows = math.ceil(len(names) / columns)
    height = max(86.0, (tall - 48.0) / max(rows, 1) - 22.0) if tall else 96.0
    for k, name in enumerate(names):
        box = (left + tile * (k % columns) + 56, top + (height + 26) * (k // columns), tile - 66, height)
        parts.append(_pair(box, prediction, name, is_input=name in inputs, last=k >= len(names) - columns))
    total = max(top + tall, top + rows * (height + 26) + 22)
    return drawing(parts, total, f"{prediction.record}: measured and simulated")


def _single_channel(prediction: Prediction, name: str) -> str:
    """The only channel over the whole width, with what is left of it below."""
    measured, simulated = prediction.measured, prediction.simulated
    unit = measured.channel(name).unit
    values, other = display_values(name, measured[name], unit), display_values(name, simulated[name], unit)
    time, left = measured.time, _unwrap_to_measured(other, values, name) - values
    reach = (float(time[0]), float(time[-1]))
    above = Panel(56, 30, WIDTH - 66, 190, reach, span([values, other]))
    below = Panel(56, 246, WIDTH - 66, 70, reach, span([left]))
    unit_shown = label("", unit).strip()
    parts = [
        legend([("measured", MEASURED), ("simulated, open loop", SIMULATED)], WIDTH - 8, 14),
        axes(above, x_ticks=8, x_labels=False, y_label=label(name, unit)),
        axes(below, x_ticks=8, y_ticks=3, y_label=f"error {unit_shown}", x_label="t [s]"),
        above.curve(*decimated(time, values, _FINE_POINTS), MEASURED),
        above.curve(*decimated(time, _unwrap_to_measured(other, values, name), _FINE_POINTS), SIMULATED),
        below.curve(*decimated(time, left, _FINE_POINTS), PLAIN),
    ]
    return drawing(parts, 358, f"{prediction.record}: measured and simulated")


def _pair(
    box: tuple[float, float, float, float], prediction: Prediction, name: str, *, is_input: bool, last: bool
) -> str:
    measured, simulated = prediction.measured, prediction.simulated
    unit = measured.channel(name).unit
    values = display_values(name, measured[name], unit)
    others: list[Array] = []
    if not is_input and name in simulated:
        others = [_unwrap_to_measured(display_values(name, simulated[name], unit), values, name)]
    band = _band(prediction, name, others, unit)
    begin, end = float(measured.time[0]), float(measured.time[-1])
    reach = span([values, *others, *(bands.visible_edges([values, *others], band) if band else [])])
    panel = Panel(*box, (begin, end if end > begin else begin + 1.0), reach)
    title = label(name, unit) + (", input" if is_input else "")
    parts = [axes(panel, y_label=title, x_label="t [s]" if last else "")]
    if band:
        parts.append(bands.over_time(panel, simulated.time, band))
    parts.append(panel.curve(*decimated(measured.time, values), PLAIN if is_input else MEASURED))
    parts += [panel.curve(*decimated(simulated.time, other), SIMULATED) for other in others]
    return "".join(parts)


def _band(prediction: Prediction, name: str, simulated: Sequence[Array], unit: str) -> tuple[Array, Array] | None:
    half_width = prediction.half_width.get(name)
    return bands.edges(simulated[0], half_width, unit) if simulated and half_width is not None else None


def _unwrap_to_measured(simulated: Array, measured: Array, name: str) -> Array:
    """A heading on the measured one's turn."""
    if name != "psi" or not np.isfinite(simulated).any() or not np.isfinite(measured).any():
        return simulated
    first = simulated[np.isfinite(simulated)][0] - measured[np.isfinite(measured)][0]
    return simulated - 360.0 * np.round(first / 360.0)
