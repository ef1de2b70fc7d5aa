"""A record as a chart: its track and its channels over time."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import INK, Chart, Stroke
from seatrial.core.figures.run import ChannelPanel, RunView, TimeCurve, Track, run_chart
from seatrial.core.values.notation import POSITIONS, channel_label, display_values, reading_order
from seatrial.core.values.record import Record

PLAIN = Stroke(INK, 0.9)  # px, chosen


def record_chart(record: Record, length: float = 0.0) -> Chart:
    """Return the track, where there are positions, and every channel in the order of reading.

    Args:
        length: of the ship [m], for hulls along the track.
    """
    names = reading_order(list(record.channels))
    tracks = (record_track(record, PLAIN),) if has_track(record) else ()
    return run_chart(RunView(record.name, channel_panels(record, names), tracks, length))


def channel_panels(record: Record, names: Sequence[str]) -> tuple[ChannelPanel, ...]:
    """Return a panel for each of the named channels of a record."""
    return tuple(
        ChannelPanel(channel_label(name, record.channel(name).unit), (time_curve(record, name, PLAIN),))
        for name in names
    )


def time_curve(record: Record, name: str, stroke: Stroke, words: str = "") -> TimeCurve:
    """Return one channel over time in the unit people read; `words`: what readers call the curve."""
    return TimeCurve(record.time, display_values(name, record[name], record.channel(name).unit), stroke, words)


def record_track(record: Record, stroke: Stroke, hull_fill: str = "none") -> Track:
    """Return the positions of a record, with headings where they were recorded."""
    heading = record["psi"] if "psi" in record.channels else None
    return Track(record["x0"], record["y0"], heading, stroke, hull_fill)


def has_track(record: Record) -> bool:
    """Return whether the record has positions."""
    return set(POSITIONS) <= set(record.channels) and bool(np.isfinite(record["x0"] + record["y0"]).any())


def has_moving_track(record: Record) -> bool:
    """Return whether the record has positions that change: those of a steering model without a speed do not."""
    return has_track(record) and not all(is_constant(record, name) for name in POSITIONS)


def is_constant(record: Record, name: str) -> bool:
    """Return whether a channel never changes by more than a billionth of its largest value."""
    values = record[name][np.isfinite(record[name])]
    # rounding of stored numbers
    return values.size == 0 or float(np.ptp(values)) <= 1e-9 * max(1.0, float(np.max(np.abs(values))))  # px, chosen
