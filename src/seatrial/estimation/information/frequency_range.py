"""At which frequencies records show a linear ship: those that its constant coefficients stand for."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.values import NOTATION, Array, Finding, Record, Severity

POWER_SHARE = 0.9  # middle share of the power; chosen
_WELCH_SEGMENTS = 4


def frequency_range(records: Sequence[Record], channels: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Channel -> frequencies [rad/s] between which the middle 90 % of its power lies, over all records (Welch 1967).

    Gaps are left out; channels that no record holds, or that never move, are not in the answer.
    """
    found = {}
    for channel in channels:
        pieces = [_measured_samples(r, channel) for r in records if channel in r]
        # samples of the shortest spectrum; chosen
        powers = [_power_spectrum(values, dt) for values, dt in pieces if len(values) > 16 and np.ptp(values) > 0.0]
        if powers:
            found[channel] = _central_band(powers)
    return found


def _measured_samples(record: Record, channel: str) -> tuple[Array, float]:
    """The measured samples of a channel and their step: motions may be sampled more slowly than the record."""
    good = np.flatnonzero(np.isfinite(record[channel]))
    step = int(np.median(np.diff(good))) if len(good) > 1 else 1
    return record[channel][good], record.dt * step


def _power_spectrum(values: Array, dt: float) -> tuple[Array, Array]:
    from scipy.signal import welch

    length = max(16, 2 * len(values) // (_WELCH_SEGMENTS + 1))  # samples of the shortest spectrum; chosen
    frequency, power = welch(values - np.mean(values), 1.0 / dt, nperseg=min(length, len(values)))
    return 2.0 * np.pi * frequency, power * len(values) * dt


def _central_band(powers: Sequence[tuple[Array, Array]]) -> tuple[float, float]:
    omega = np.concatenate([w for w, _ in powers])
    weight = np.concatenate([p * (w[1] - w[0]) for w, p in powers])
    order = np.argsort(omega, kind="stable")
    share = np.cumsum(weight[order]) / np.sum(weight)
    tail = 0.5 * (1.0 - POWER_SHARE)
    low, high = (float(omega[order][np.searchsorted(share, s)]) for s in (tail, 1.0 - tail))
    return low, high


def frequency_range_finding(ranges: Mapping[str, tuple[float, float]]) -> Finding:
    """What it means for the coefficients."""
    ranges_text = ", ".join(f"{NOTATION[c].meaning} {low:.2g} to {high:.2g} rad/s" for c, (low, high) in ranges.items())
    low, high = min(a for a, _ in ranges.values()), max(b for _, b in ranges.values())
    return Finding(
        Severity.INFO,
        "frequency-range",
        f"the constant coefficients stand for frequencies of encounter from {low:.2g} to {high:.2g} rad/s; outside "
        f"they "
        "extrapolate, for added mass and damping change with frequency",
        f"{100 * POWER_SHARE:.0f} % of the power: {ranges_text}",
        "for another range, record other headings or speeds, or another sea, and fit them apart",
    )
