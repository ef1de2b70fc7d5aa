"""What the page asks for: the newest snapshot as text, and the points its plots do not have yet."""

import math
from typing import Any

import numpy as np

from seatrial.core.results.online import Counts, Snapshot
from seatrial.core.values import NOTATION, Array, Severity, display
from seatrial.onboard import shown
from seatrial.onboard.digits import significant
from seatrial.onboard.history import Point

_SEVERITIES = list(Severity)[::-1]
DIGITS = 8


def told(snapshot: Snapshot, counts: Counts) -> dict[str, Any]:
    """The words of the newest snapshot: facts, rows of tables, findings; all of it text."""
    worst_first = sorted(snapshot.findings, key=lambda f: _SEVERITIES.index(f.severity))
    return {
        "phase": snapshot.phase.value,
        "meaning": shown.phase(snapshot.phase),
        "moment": shown.moment(snapshot.time),
        "samples": snapshot.samples,
        "runs": snapshot.runs,
        "rows": [vars(row) for row in shown.rows(snapshot)],
        "noise": [_noise(name, rms) for name, rms in snapshot.noise.items()],
        "untold": [shown.clean(name) for name in snapshot.untold],
        "advice": shown.clean(snapshot.advice),
        "change": shown.change(snapshot.change),
        "accepted": counts.accepted,
        "troubles": shown.troubles(counts),
        "last": shown.clean(counts.last),
        "findings": [
            {"severity": f.severity.value, "text": shown.clean(f.text, 1000), "advice": shown.clean(f.advice, 1000)}
            for f in worst_first
        ],
    }


def points(some: list[Point], snapshot: Snapshot) -> list[list[Any]]:
    """For each point: sequence, elapsed [s], values, half intervals, noise, in the units people read; null is unknown.

    Values and half intervals as `snapshot.names`, noise as `snapshot.noise`.
    """
    factors = np.array([display(unit)[0] for unit in snapshot.units])
    channels = [(name, display(shown.channel_unit(name))[0]) for name in snapshot.noise]
    return [
        [
            point.sequence,
            _number(point.elapsed),
            _numbers(factors * point.value),
            _numbers(shown.NORMAL_95 * factors * point.standard_error),
            [_number(factor * point.noise.get(name, math.nan)) for name, factor in channels],
        ]
        for point in some
    ]


def _noise(channel: str, rms: float) -> dict[str, str]:
    factor, unit = display(shown.channel_unit(channel))
    meaning = NOTATION[channel].meaning if channel in NOTATION else ""
    return {
        "name": shown.clean(channel),
        "meaning": meaning,
        "rms": significant(factor * rms, 3),
        "unit": "" if unit == "1" else unit,
    }


def _numbers(values: Array) -> list[float | None]:
    return [_number(float(value)) for value in values]


def _number(value: float) -> float | None:
    """As JSON has it: no infinities, no more digits than a plot shows."""
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
