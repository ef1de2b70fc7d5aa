"""What is followed, as a page shows it: a report of each estimate in words, display units and plotted points."""

import math
import secrets
from typing import Any

import numpy as np

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, Record, display_unit, worst_first
from seatrial.core.values.notation import POSITIONS, channel_label, channel_unit, display_values, reading_order
from seatrial.core.values.record_chart import has_track, is_constant
from seatrial.onboard.table import (
    NORMAL_95,
    History,
    HistoryPoint,
    estimate_rows,
    fault_counts,
    phase_meaning,
    proposal_lines,
    residual_rms,
    time_text,
    watch_sentence,
)

# digits of plotted points, letters of a finding; chosen: finer than a screen, longer than any sentence of ours
JSON_DIGITS, MAX_LENGTH = 8, 1000
# channels that say most of a manoeuvre, and how many of others are shown where a stream has neither
_FIRST_CHANNELS, MAX_CHANNELS = ("delta", "psi"), 2


class StreamReporter:
    """Makes a report of each snapshot of one stream.

    A report has `snapshot`, `recent`, the newest `point` of the plots, the `stride` by whose multiples of numbers the
    earlier points are kept, and the `epoch`: points of another one are of other coefficients, or of another stream.

    title: what is followed.
    """

    def __init__(self, title: str = "") -> None:
        self._title = title
        self._history = History()
        self._latest: tuple[Snapshot, SampleCounts, HistoryPoint] | None = None
        self._instance_id = secrets.token_hex(4)

    def report(self, snapshot: Snapshot, counts: SampleCounts) -> dict[str, Any] | None:
        """Return the report of a snapshot; None of the same one with the same counts again."""
        last = self._latest
        if last is None or last[0] is not snapshot:
            point = self._history.add(snapshot)
        elif last[1] != counts:
            point = last[2]
        else:
            return None
        self._latest = snapshot, counts, point
        return {
            "title": self._title,
            "epoch": f"{self._instance_id}-{self._history.generation}",
            "stride": self._history.stride,
            "snapshot": snapshot_json(snapshot, counts),
            "recent": recent_json(snapshot.recent),
            "point": plot_point(point, snapshot),
        }


def snapshot_json(snapshot: Snapshot, counts: SampleCounts) -> dict[str, Any]:
    """Return the newest snapshot as text: facts, table rows, findings."""
    return {
        "phase": snapshot.phase.value,
        "meaning": phase_meaning(snapshot),
        "time": time_text(snapshot.time),
        "samples": snapshot.samples,
        "runs": snapshot.runs,
        "rows": [vars(row) for row in estimate_rows(snapshot)],
        "noise": [
            {"name": name, "meaning": NOTATION[name].meaning if name in NOTATION else "", "rms": rms, "unit": unit}
            for name, rms, unit in residual_rms(snapshot)
        ],
        "unidentified": [printable(name) for name in snapshot.unidentified],
        "advice": printable(snapshot.advice),
        "proposal": [] if snapshot.proposal is None else proposal_lines(snapshot.proposal),
        "change": watch_sentence(snapshot),
        "accepted": counts.accepted,
        "faults": fault_counts(counts),
        "last": printable(counts.last_problem),
        "findings": [
            {
                "severity": f.severity.value,
                "text": printable(f.text, MAX_LENGTH),
                "advice": printable(f.advice, MAX_LENGTH),
            }
            for f in worst_first(snapshot.findings)
        ],
    }


def recent_json(records: tuple[Record, ...]) -> dict[str, Any]:
    """Return the run so far in display units: track [m], and rudder and heading, or the first channels that move."""
    if not records:
        return {"track": None, "channels": []}
    record = records[-1]
    moving = [name for name in reading_order(list(record.channels)) if not is_constant(record, name)]
    names = [name for name in _FIRST_CHANNELS if name in moving] or moving[:MAX_CHANNELS]
    elapsed = _json_numbers(record.time - record.time[0])
    channels = [
        {
            "label": channel_label(name, record.channel(name).unit),
            "time": elapsed,
            "values": _json_numbers(display_values(name, record[name], record.channel(name).unit)),
        }
        for name in names
    ]
    track = {name: _json_numbers(record[name]) for name in POSITIONS} if has_track(record) else None
    return {"track": track, "channels": channels}


def plot_point(point: HistoryPoint, snapshot: Snapshot) -> list[Any]:
    """Return of a point: sequence, elapsed [s], values, half intervals, noise, in display units; null: unknown.

    Values and half intervals as `snapshot.names`, noise as `snapshot.noise`.
    """
    factors = np.array([display_unit(unit)[0] for unit in snapshot.units])
    channels = [(name, display_unit(channel_unit(name))[0]) for name in snapshot.noise]
    return [
        point.sequence,
        _json_number(point.elapsed),
        _json_numbers(factors * point.value),
        _json_numbers(NORMAL_95 * factors * point.standard_error),
        [_json_number(factor * point.noise.get(name, math.nan)) for name, factor in channels],
    ]


def _json_numbers(values: Array) -> list[float | None]:
    return [_json_number(float(value)) for value in values]


def _json_number(value: float) -> float | None:
    """A number for JSON: no infinities, no more digits than a plot shows."""
    return float(f"{value:.{JSON_DIGITS}g}") if math.isfinite(value) else None
