"""All records of a fit as small multiples: channels over time, and tracks."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import WIDTH, Axis, Chart, Panel, Region, tiles
from seatrial.core.figures.marks import GREY, Anchor, Line, Mark, Text, text_width
from seatrial.core.figures.ticks import decimated, span
from seatrial.core.figures.tracks import Track, is_slender, strip_height, track_panel
from seatrial.core.text.words import common_prefix
from seatrial.core.values import Array, Record
from seatrial.core.values.channel_text import channel_label, display_values, reading_order
from seatrial.core.values.record_chart import PLAIN, has_track, is_constant, record_track

# channels and records of one figure at most
MAX_COLUMNS, MAX_ROWS = 8, 16
# ratio of two durations or ranges from which on they do not share an axis
DISSIMILAR = 0.25
# tracks in a row: square ones, and strips; free room above, between and beside them [px]
COLUMNS, STRIP_COLUMNS = 4, 2
TOP, ROW_GAP, LEFT, RIGHT = 22.0, 56.0, 52.0, 12.0  # px, chosen
MIN_STRIP = 44.0  # px, chosen
SMALL = 8.5  # px, chosen


def channel_overview(records: Sequence[Record]) -> list[Chart]:
    """Return charts with a row for each record and a column for each channel that is not constant everywhere."""
    names = reading_order([s for r in records for s in r.channels if not is_constant(r, s)])[:MAX_COLUMNS]
    if not names:
        return []
    rows = math.ceil(len(records) / math.ceil(len(records) / MAX_ROWS))
    prefix = common_prefix([r.name for r in records])
    return [_overview(records[k : k + rows], names, prefix, records) for k in range(0, len(records), rows)]


def _overview(records: Sequence[Record], names: Sequence[str], prefix: str, all_records: Sequence[Record]) -> Chart:
    labels = [r.name.removeprefix(prefix) for r in records]
    margin = min(190.0, max(text_width(label) for label in labels) + 10.0)  # px, chosen
    durations = [r.duration for r in all_records]
    is_alike = min(durations) > DISSIMILAR * max(durations)
    height, gap = (46.0 if len(records) > 6 else 74.0), (10.0 if is_alike else 24.0)  # px, chosen
    # px, chosen
    boxes = tiles(len(records) * len(names), len(names), height, start=margin, left=30.0, right=10.0, gap=gap, top=22.0)
    panels = []
    for k, box in enumerate(boxes):
        row, name = records[k // len(names)], names[k % len(names)]
        unit = next(r.channel(name).unit for r in all_records if name in r)
        is_last = k // len(names) == len(records) - 1
        end = max(durations) if is_alike else row.duration
        x = Axis((0.0, end or 1.0), "t [s]" if is_last else "", tick_count=2, has_labels=is_last or not is_alike)
        y = Axis(_value_range(all_records, row, name), tick_count=2)
        marks = _curve(row, name, x, y)
        if k % len(names) == 0:
            marks.append(Text(0.0, sum(y.ends) / 2, labels[k // len(names)], dx=-box.left, dy=4.0))
        title = channel_label(name, unit) if k < len(names) else ""
        panels.append(Panel(box, x, y, tuple(marks), title, tick_size=SMALL))
    return Chart("channels of the records", tuple(panels))


def _value_range(records: Sequence[Record], record: Record, name: str) -> tuple[float, float]:
    """One range for all records, or the record's own where they differ too much to be seen together."""
    curves = [_values(r, name) for r in records if name in r]
    widths = [float(np.diff(span([c], 0.0))[0]) for c in curves]
    return span(curves if name not in record or min(widths) > DISSIMILAR * max(widths) else [_values(record, name)])


def _values(record: Record, name: str) -> Array:
    return display_values(name, record[name], record.channel(name).unit)


def _curve(record: Record, name: str, x: Axis, y: Axis) -> list[Mark]:
    if name not in record:
        return [Text(sum(x.ends) / 2, sum(y.ends) / 2, "not recorded", Anchor.MIDDLE, SMALL, GREY)]
    return [Line(*decimated(record.time - record.time[0], _values(record, name), 200), PLAIN)]  # px, chosen


def track_overview(records: Sequence[Record], length: float) -> Chart | None:
    """Return small multiples of all tracks, strips first; None where no record has positions.

    Args:
        length: of the ship [m].
    """
    prefix = common_prefix([r.name for r in records])
    named = [(r.name.removeprefix(prefix), record_track(r, PLAIN)) for r in records if has_track(r)]
    strips = [(name, track) for name, track in named if is_slender([track])]
    squares = [(name, track) for name, track in named if not is_slender([track])]
    panels = _track_rows(strips, length, 0.0, STRIP_COLUMNS)
    bottom = panels[-1].box.bottom + ROW_GAP - TOP if panels else 0.0
    panels += _track_rows(squares, length, bottom, COLUMNS)
    return Chart("tracks of the records", tuple(panels)) if panels else None


def _track_rows(tracks: Sequence[tuple[str, Track]], length: float, top: float, columns: int) -> list[Panel]:
    """Rows of tracks below `top`, strips as high as the widest of their row needs."""
    inner, panels = WIDTH / columns - LEFT - RIGHT, []
    for k in range(0, len(tracks), columns):
        row = tracks[k : k + columns]
        is_strip = columns == STRIP_COLUMNS
        # px, chosen
        height = max(MIN_STRIP, *(strip_height([t], inner, 0.06 * inner) for _, t in row)) if is_strip else inner
        for j, (name, track) in enumerate(row):
            box = Region(WIDTH / columns * j + LEFT, top + TOP, inner, height)
            panels.append(track_panel([track], length, box, has_names=False, x_ticks=4, y_ticks=2 if is_strip else 4,
                                      title=name))  # fmt: skip
        top += height + ROW_GAP
    return panels
