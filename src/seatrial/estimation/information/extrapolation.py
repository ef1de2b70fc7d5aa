"""How far a prediction leaves the ground the training runs cover: coefficients are known only where they had effect."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.results import Extrapolation
from seatrial.core.values import Array, Record

_PERCENTILE = 99.5  # per cent of the samples within the envelope; chosen
# rad/s, rad, rad, m/s, m/s, below which a range counts as none; chosen
NEGLIGIBLE = {"yaw_rate": 1e-4, "drift": 1e-3, "rudder": 1e-3, "fastest": 1e-3, "slowest": 1e-3}
REST_SHARE = 0.1
"""Share of the fastest speed of the training runs below which a craft counts as at rest; chosen."""


def motion_envelope(records: Sequence[Record]) -> dict[str, float]:
    """What the records cover, SI: largest yaw rate, drift and rudder angle, fastest and slowest speed.

    The largest is the 99.5th percentile of all samples, so that a single bad one does not count. What no record holds
    is absent. Drift is atan2(-v, u).
    """
    made: dict[str, float] = {}
    for name, samples in (
        ("yaw_rate", [np.abs(r["r"]) for r in records if "r" in r]),
        ("drift", [np.abs(np.arctan2(-r["v"], r["u"])) for r in records if {"u", "v"} <= set(r.channels)]),
        ("rudder", [np.abs(r["delta"]) for r in records if "delta" in r]),
    ):
        if samples:
            made[name] = float(np.nanpercentile(np.concatenate(samples), _PERCENTILE))
    speeds = [_speed(r) for r in records if "u" in r]
    if speeds:
        flow = np.concatenate(speeds)
        made["fastest"] = float(np.nanpercentile(flow, _PERCENTILE))
        made["slowest"] = float(np.nanpercentile(flow, 100.0 - _PERCENTILE))
    return made


def _speed(record: Record) -> Array:
    return np.hypot(record["u"], record["v"]) if "v" in record else np.abs(record["u"])


def extrapolation(predicted: Record, training_envelope: Mapping[str, float]) -> Extrapolation | None:
    """Ratios of a run's `motion_envelope` to that of the training runs; None where nothing can be compared.

    That of the slowest speed is turned round, so that a run that goes half as fast as any training run has 2; the last
    tenth of the speed down to rest adds nothing, or a run from rest would be infinitely far away.
    """
    own = motion_envelope([predicted])
    both = {
        n: (own[n], training_envelope[n])
        for n in own
        if n in training_envelope and training_envelope[n] > NEGLIGIBLE[n]
    }
    ratios = {n: both[n][0] / both[n][1] for n in ("yaw_rate", "drift", "rudder") if n in both}
    if {"fastest", "slowest"} <= set(both):
        ratios["fastest"] = both["fastest"][0] / both["fastest"][1]
        rest = max(REST_SHARE * both["fastest"][1], NEGLIGIBLE["slowest"])
        ratios["slowest"] = max(both["slowest"][1], rest) / max(both["slowest"][0], rest)
    return Extrapolation(max(ratios.values()), ratios) if ratios else None


def extrapolation_index(predicted: Record, training: Sequence[Record]) -> float:
    """Extrapolation index of a run against others; 1 where nothing can be compared."""
    found = extrapolation(predicted, motion_envelope(training))
    return found.index if found else 1.0
