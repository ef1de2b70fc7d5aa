"""A record as a chart: its track and its channels over time."""

import numpy as np

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.marks import INK, Stroke
from seatrial.core.figures.run import ChannelPanel, TimeCurve, run_chart
from seatrial.core.figures.tracks import Track
from seatrial.core.values.channel_text import POSITIONS, channel_label, display_values, reading_order
from seatrial.core.values.record import Record

PLAIN = Stroke(INK, 0.9)  # px, chosen


def record_chart(record: Record, length: float = 0.0) -> Chart:
    """Return the track, where there are positions, and every channel in the order of reading.

    Args:
        length: of the ship [m], for hulls along the track.
    """
    names = reading_order(list(record.channels))
    channels = [ChannelPanel(channel_label(name, record.channel(name).unit), (time_curve(record, name, PLAIN),))
                for name in names]  # fmt: skip
    return run_chart(record.name, channels, [record_track(record, PLAIN)] if has_track(record) else [], length)


def time_curve(record: Record, name: str, stroke: Stroke) -> TimeCurve:
    """Return one channel over time in the unit people read."""
    return TimeCurve(record.time, display_values(name, record[name], record.channel(name).unit), stroke)


def record_track(record: Record, stroke: Stroke, hull_fill: str = "none") -> Track:
    """Return the positions of a record, with headings where they were recorded."""
    heading = record["psi"] if "psi" in record.channels else None
    return Track(record["x0"], record["y0"], heading, stroke, hull_fill)


def has_track(record: Record) -> bool:
    """Return whether the record has positions."""
    return set(POSITIONS) <= set(record.channels) and bool(np.isfinite(record["x0"] + record["y0"]).any())


def is_constant(record: Record, name: str) -> bool:
    """Return whether a channel never changes by more than a billionth of its largest value."""
    values = record[name][np.isfinite(record[name])]
    # rounding of stored numbers
    return values.size == 0 or float(np.ptp(values)) <= 1e-9 * max(1.0, float(np.max(np.abs(values))))  # px, chosen
