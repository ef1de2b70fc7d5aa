"""What the page requests: the newest snapshot as text, and the points its plots do not have yet."""

import math
from typing import Any

import numpy as np

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, Record, display_unit, worst_first
from seatrial.core.values.notation import POSITIONS, channel_label, channel_unit, display_values, reading_order
from seatrial.core.values.record_chart import has_track, is_constant
from seatrial.onboard import snapshot_text
from seatrial.onboard.history import HistoryPoint
from seatrial.onboard.proposal_text import proposal_lines

# digits of plotted points, letters of a finding; chosen: finer than a screen, longer than any sentence of ours
JSON_DIGITS, MAX_LENGTH = 8, 1000
# channels that say most of a manoeuvre, and how many of others are shown where a stream has neither
_FIRST_CHANNELS, MAX_CHANNELS = ("delta", "psi"), 2


def snapshot_json(snapshot: Snapshot, counts: SampleCounts) -> dict[str, Any]:
    """Return the newest snapshot as text: facts, table rows, findings."""
    return {
        "phase": snapshot.phase.value,
        "meaning": snapshot_text.phase_meaning(snapshot),
        "time": snapshot_text.time_text(snapshot.time),
        "samples": snapshot.samples,
        "runs": snapshot.runs,
        "rows": [vars(row) for row in snapshot_text.estimate_rows(snapshot)],
        "noise": [
            {"name": name, "meaning": NOTATION[name].meaning if name in NOTATION else "", "rms": rms, "unit": unit}
            for name, rms, unit in snapshot_text.residual_rms(snapshot)
        ],
        "unidentified": [printable(name) for name in snapshot.unidentified],
        "advice": printable(snapshot.advice),
        "proposal": [] if snapshot.proposal is None else proposal_lines(snapshot.proposal),
        "change": snapshot_text.change_sentence(snapshot.change),
        "accepted": counts.accepted,
        "faults": snapshot_text.fault_counts(counts),
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


def plot_points(points: list[HistoryPoint], snapshot: Snapshot) -> list[list[Any]]:
    """Return for each point: sequence, elapsed [s], values, half intervals, noise, in display units; null: unknown.

    Values and half intervals as `snapshot.names`, noise as `snapshot.noise`.
    """
    factors = np.array([display_unit(unit)[0] for unit in snapshot.units])
    channels = [(name, display_unit(channel_unit(name))[0]) for name in snapshot.noise]
    return [
        [
            point.sequence,
            _json_number(point.elapsed),
            _json_numbers(factors * point.value),
            _json_numbers(snapshot_text.NORMAL_95 * factors * point.standard_error),
            [_json_number(factor * point.noise.get(name, math.nan)) for name, factor in channels],
        ]
        for point in points
    ]


def _json_numbers(values: Array) -> list[float | None]:
    return [_json_number(float(value)) for value in values]


def _json_number(value: float) -> float | None:
    """A number for JSON: no infinities, no more digits than a plot shows."""
    return float(f"{value:.{JSON_DIGITS}g}") if math.isfinite(value) else None
