"""What the page requests: the newest snapshot as text, and the points its plots do not have yet."""

import math
from typing import Any

import numpy as np

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, Severity, display_unit
from seatrial.core.values.channel_text import channel_unit, unit_text
from seatrial.onboard import snapshot_text
from seatrial.onboard.history import HistoryPoint

_SEVERITIES = list(Severity)[::-1]
# significant digits of plotted points
JSON_DIGITS = 8


def snapshot_json(snapshot: Snapshot, counts: SampleCounts) -> dict[str, Any]:
    """Return the newest snapshot as text: facts, table rows, findings."""
    worst_first = sorted(snapshot.findings, key=lambda f: _SEVERITIES.index(f.severity))
    return {
        "phase": snapshot.phase.value,
        "meaning": snapshot_text.phase_meaning(snapshot.phase),
        "time": snapshot_text.time_text(snapshot.time),
        "samples": snapshot.samples,
        "runs": snapshot.runs,
        "rows": [vars(row) for row in snapshot_text.estimate_rows(snapshot)],
        "noise": [_noise_json(name, rms) for name, rms in snapshot.noise.items()],
        "unidentified": [printable(name) for name in snapshot.unidentified],
        "advice": printable(snapshot.advice),
        "change": snapshot_text.change_sentence(snapshot.change),
        "accepted": counts.accepted,
        "faults": snapshot_text.fault_counts(counts),
        "last": printable(counts.last_problem),
        "findings": [
            {
                "severity": f.severity.value,
                "text": printable(f.text, 1000),
                "advice": printable(f.advice, 1000),
            }
            for f in worst_first
        ],
    }


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


def _noise_json(channel: str, rms: float) -> dict[str, str]:
    factor = display_unit(channel_unit(channel))[0]
    meaning = NOTATION[channel].meaning if channel in NOTATION else ""
    return {
        "name": printable(channel),
        "meaning": meaning,
        "rms": significant(factor * rms, 3),
        "unit": unit_text(channel_unit(channel)),
    }


def _json_numbers(values: Array) -> list[float | None]:
    return [_json_number(float(value)) for value in values]


def _json_number(value: float) -> float | None:
    """A number for JSON: no infinities, no more digits than a plot shows."""
    return float(f"{value:.{JSON_DIGITS}g}") if math.isfinite(value) else None
