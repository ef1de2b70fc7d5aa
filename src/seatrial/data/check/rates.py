"""Yaw rate against heading, angles in degrees or radians, columns that are something else than they say."""

import math

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.motion import DEGREES
from seatrial.data.check.signal import size, slope, smoothed, window

MOVES = math.radians(2.0)
MATCH = 0.98
WRONG, ROUGH = 0.9, 0.5


def rate_findings(record: Record) -> tuple[Finding, ...]:
    """Findings on r, p, psi and delta of a clean, signed record."""
    return (*_yaw_rate(record), *_rudder_unit(record))


def heading_rate(record: Record) -> Array | None:
    """Smoothed d(psi)/dt [rad/s], or None where the heading is missing or hardly moves."""
    if "psi" not in record or len(record) < 30:
        return None
    length = window(len(record))
    if np.ptp(smoothed(record["psi"], length)) < MOVES:
        return None
    return slope(record["psi"], record.dt, length)


def _fit(rate: Array, turning: Array) -> tuple[float, float]:
    """Regression factor rate / turning and their correlation through the origin."""
    product = float(rate @ turning)
    powers = float(rate @ rate), float(turning @ turning)
    return product / powers[1], product / math.sqrt(max(powers[0] * powers[1], 1e-300))


def _yaw_rate(record: Record) -> list[Finding]:
    turning = heading_rate(record)
    if turning is None:
        return []
    length = window(len(record))
    found = []
    for symbol, channel in record.channels.items():
        if channel.unit == "rad/s" and symbol != "r":
            factor, match = _fit(smoothed(channel.values, length), turning)
            if abs(match) > MATCH and 0.9 < abs(factor) < 1.1:
                found.append(_mislabelled(record, symbol, factor, match))
    if "r" not in record:
        return found
    r = smoothed(record["r"], length)
    return [*found, *_judged(record, *_fit(r, turning), size(r - turning) / size(turning), turning)]


def _named(record: Record, symbol: str) -> str:
    label = record.channel(symbol).label
    return f"'{symbol}' ({label})" if label else f"'{symbol}'"


def _mislabelled(record: Record, symbol: str, factor: float, match: float) -> Finding:
    return Finding(
        Severity.ERROR,
        "mislabelled",
        f"record '{record.name}': channel {_named(record, symbol)} is in truth the yaw rate"
        + (" with the opposite sign" if factor < 0 else ""),
        f"correlation with d(psi)/dt {match:.4f}, factor {factor:.3f}",
        "declare this column as r",
    )


def _judged(record: Record, factor: float, match: float, misfit: float, turning: Array) -> list[Finding]:
    evidence = f"correlation with d(psi)/dt {match:.3f}, factor {factor:.3g}, misfit {misfit:.0%}"
    name = f"record '{record.name}': channel {_named(record, 'r')}"
    if abs(match) > 0.8 and abs(math.log(abs(factor) / DEGREES)) < 0.2:
        return [_angle_unit(record, "r", "psi", turning, evidence)]
    if abs(match) > 0.8 and abs(math.log(abs(factor) * DEGREES)) < 0.2:
        return [_angle_unit(record, "psi", "r", turning, evidence)]
    if match < -0.8 and 0.5 < abs(factor) < 2.0:
        what = f"{name} has the opposite sign of d(psi)/dt"
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, "declare the opposite positive direction for r")]
    if misfit > WRONG:
        what = f"{name} is not the yaw rate: it does not follow d(psi)/dt"
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, "look for the yaw rate in another column")]
    if misfit > ROUGH:
        what = f"{name} follows d(psi)/dt only roughly"
        return [Finding(Severity.WARNING, "yaw-rate", what, evidence, "check noise, lag and scale of r")]
    return []


def _angle_unit(record: Record, large: str, small: str, turning: Array, evidence: str) -> Finding:
    """`large` is 57 times too large or `small` 57 times too small; the course over ground tells which."""
    course = _course_factor(record, turning)
    if course is None:
        what = f"either '{large}' is in degrees although declared in radians, or '{small}' the other way round"
    else:
        psi_is_right = 0.2 < course < 5.0
        guilty = large if psi_is_right == (large == "r") else small
        units = "in degrees although declared in radians" if guilty == large else "in radians, declared in degrees"
        what = f"'{guilty}' is {units}"
        evidence += f"; the course turns {course:.3g} times as fast as the heading"
    return Finding(
        Severity.ERROR, "angle-unit", f"record '{record.name}': {what}", evidence, "mend the unit in the trial file"
    )


def _course_factor(record: Record, turning: Array) -> float | None:
    """Rate of the course over ground in terms of the heading's, from positions where the ship moves."""
    if "x0" not in record or "y0" not in record:
        return None
    length = window(len(record))
    north, east = (slope(record[s], record.dt, length) for s in ("x0", "y0"))
    if size(north, east) == 0:
        return None
    course = np.unwrap(np.arctan2(east, north))
    rate = np.gradient(course, record.dt)
    moving = np.hypot(north, east) > 0.3 * size(north, east)
    return abs(_fit(rate[moving], turning[moving])[0])


def _rudder_unit(record: Record) -> list[Finding]:
    if "delta" not in record:
        return []
    largest = float(np.max(np.abs(record["delta"])))
    if largest > math.pi / 2:
        what = f"record '{record.name}': the rudder reaches {math.degrees(largest):.0f} deg"
        advice = 'the column is probably in degrees: declare unit = "deg" for delta'
        return [Finding(Severity.ERROR, "angle-unit", what, f"{largest:.4g} rad as declared", advice)]
    if 0.0 < largest < math.radians(45.0) / DEGREES and np.ptp(record["delta"]) > 0.5 * largest:
        what = f"record '{record.name}': the rudder reaches only {math.degrees(largest):.2g} deg"
        advice = 'if the column is in radians, declare unit = "rad" for delta'
        return [Finding(Severity.WARNING, "angle-unit", what, f"{largest:.3g} rad as declared", advice)]
    return []
