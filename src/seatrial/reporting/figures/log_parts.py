"""A run of a log with its manoeuvres: track and channels, the parts in colour."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.figures.chart import GREY, LegendEntry, Stroke
from seatrial.core.figures.run import RunView, Track
from seatrial.core.figures.time_plot import TimeSpan
from seatrial.core.values import InputError, Record
from seatrial.core.values.notation import reading_order
from seatrial.core.values.record_chart import channel_panels, has_track, is_constant, record_track
from seatrial.data.check import canonical_record
from seatrial.data.draft import LogStretch

# colours of neighbours, distinguished by people who see no red or no green (Okabe & Ito 2008), and paler for areas
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00")
_PALE = ("#d5e8f3", "#f8dfcf", "#d2efe5", "#f6e4ee", "#efe7c8")
_THIN, _THICK = Stroke(GREY, 0.8), 2.2  # px, chosen
_CHANNELS_SHOWN = 12  # the first in the order of reading; chosen: two screens of a telephone


def log_view(record: Record, parts: Sequence[LogStretch]) -> tuple[RunView, tuple[TimeSpan, ...]]:
    """Return the track and the channels of a run, and its manoeuvres as stretches of time.

    Each part has a colour on the track and behind the channels.

    parts: start and stop are s after the first sample.
    """
    record = _from_zero(record)
    shown = [name for name in reading_order(list(record.channels)) if not is_constant(record, name)]
    tracks = (record_track(record, _THIN), *_part_tracks(record, parts)) if has_track(record) else ()
    legend = tuple(LegendEntry(f"{k} {one.name}", Stroke(_colour(k), _THICK)) for k, one in enumerate(parts, start=1))
    view = RunView(record.name, channel_panels(record, shown[:_CHANNELS_SHOWN]), tracks, 0.0, legend)
    spans = (TimeSpan(one.start, one.stop, _PALE[k % len(_PALE)], str(k + 1)) for k, one in enumerate(parts))
    return view, tuple(spans)


def _from_zero(record: Record) -> Record:
    """The record with time from its first sample, and velocities along the ship where its heading turns them."""
    started = replace(record, time=record.time - record.time[0])
    try:
        return canonical_record(started)
    except InputError:
        return started


def _colour(number: int) -> str:
    return _COLOURS[(number - 1) % len(_COLOURS)]


def _part_tracks(record: Record, parts: Sequence[LogStretch]) -> list[Track]:
    tracks = []
    for number, part in enumerate(parts, start=1):
        inside = (record.time >= part.start) & (record.time <= part.stop)
        north, east = record["x0"][inside], record["y0"][inside]
        if np.count_nonzero(np.isfinite(north + east)) > 1:
            tracks.append(Track(north, east, None, Stroke(_colour(number), _THICK)))
    return tracks
