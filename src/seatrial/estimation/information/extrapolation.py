"""How far a prediction leaves the ground the training runs cover: coefficients are only known where they were felt."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.results import Extrapolation
from seatrial.core.values import Array, Record

_SHARE = 99.5
_SMALL = {"yaw_rate": 1e-4, "drift": 1e-3, "rudder": 1e-3, "fastest": 1e-3, "slowest": 1e-3}


def reach(records: Sequence[Record]) -> dict[str, float]:
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
            made[name] = float(np.nanpercentile(np.concatenate(samples), _SHARE))
    speeds = [_speed(r) for r in records if "u" in r]
    if speeds:
        flow = np.concatenate(speeds)
        made["fastest"] = float(np.nanpercentile(flow, _SHARE))
        made["slowest"] = float(np.nanpercentile(flow, 100.0 - _SHARE))
    return made


def _speed(record: Record) -> Array:
    return np.hypot(record["u"], record["v"]) if "v" in record else np.abs(record["u"])


def extrapolation(predicted: Record, covered: Mapping[str, float]) -> Extrapolation | None:
    """Ratios of what a run reaches to what the training runs cover (`reach`); None where nothing can be compared.

    The ratio of speed is that of the fastest, or of the slowest the other way round, whichever leaves the range more.
    """
    own = reach([predicted])
    both = {n: (own[n], covered[n]) for n in own if n in covered and covered[n] > _SMALL[n]}
    ratios = {n: both[n][0] / both[n][1] for n in ("yaw_rate", "drift", "rudder") if n in both}
    if {"fastest", "slowest"} <= set(both):
        slow = both["slowest"][1] / max(both["slowest"][0], 1e-3)
        ratios["speed"] = max(both["fastest"][0] / both["fastest"][1], slow)
    return Extrapolation(max(ratios.values()), ratios) if ratios else None


def index_of(predicted: Record, training: Sequence[Record]) -> float:
    """Extrapolation index of a run against others; 1 where nothing can be compared."""
    found = extrapolation(predicted, reach(training))
    return found.index if found else 1.0
