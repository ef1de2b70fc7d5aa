"""Yaw rate against heading, angles in degrees or radians, columns that are something else than they say."""

import math

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.motion import DEGREES_PER_RADIAN
from seatrial.data.check.signal import smoothed, smoothed_derivative, trimmed_rms, window_length

# heading range [rad] below which the yaw rate is not compared, ours
MIN_HEADING_RANGE = math.radians(2.0)
# correlation at which another channel is taken for the yaw rate, ours
MIN_CORRELATION = 0.98
# rms difference from the rate of the heading, over its rms, that is wrong, and rough, ours
WRONG_MISFIT, ROUGH_MISFIT = 0.9, 0.5


def yaw_rate_findings(record: Record) -> tuple[Finding, ...]:
    """Findings on r, p, psi and delta of a clean, signed record."""
    return (*_heading_consistency_findings(record), *_rudder_unit_findings(record))


def heading_rate(record: Record) -> Array | None:
    """Smoothed d(psi)/dt [rad/s], or None where the heading is missing or hardly moves."""
    if "psi" not in record or len(record) < 30:
        return None
    length = window_length(len(record))
    if np.ptp(smoothed(record["psi"], length)) < MIN_HEADING_RANGE:
        return None
    return smoothed_derivative(record["psi"], record.dt, length)


def _regression_through_origin(rate: Array, psi_dot: Array) -> tuple[float, float]:
    """Regression factor rate / turning and their correlation through the origin."""
    product = float(rate @ psi_dot)
    powers = float(rate @ rate), float(psi_dot @ psi_dot)
    return product / powers[1], product / math.sqrt(max(powers[0] * powers[1], 1e-300))


def _heading_consistency_findings(record: Record) -> list[Finding]:
    turning = heading_rate(record)
    if turning is None:
        return []
    length = window_length(len(record))
    findings = []
    for symbol, channel in record.channels.items():
        if channel.unit == "rad/s" and symbol != "r":
            factor, match = _regression_through_origin(smoothed(channel.values, length), turning)
            if abs(match) > MIN_CORRELATION and 0.9 < abs(factor) < 1.1:
                findings.append(_mislabelled_finding(record, symbol, factor, match))
    if "r" not in record:
        return findings
    r = smoothed(record["r"], length)
    return [
        *findings,
        *_yaw_rate_verdict(
            record, *_regression_through_origin(r, turning), trimmed_rms(r - turning) / trimmed_rms(turning), turning
        ),
    ]


def _channel_label(record: Record, symbol: str) -> str:
    label = record.channel(symbol).label
    return f"'{symbol}' ({label})" if label else f"'{symbol}'"


def _mislabelled_finding(record: Record, symbol: str, factor: float, match: float) -> Finding:
    return Finding(
        Severity.ERROR,
        "mislabelled",
        f"record '{record.name}': channel {_channel_label(record, symbol)} is in truth the yaw rate"
        + (" with the opposite sign" if factor < 0 else ""),
        f"correlation with d(psi)/dt {match:.4f}, factor {factor:.3f}",
        "declare this column as r",
    )


def _yaw_rate_verdict(record: Record, factor: float, match: float, misfit: float, psi_dot: Array) -> list[Finding]:
    evidence = f"correlation with d(psi)/dt {match:.3f}, factor {factor:.3g}, misfit {misfit:.0%}"
    name = f"record '{record.name}': channel {_channel_label(record, 'r')}"
    if abs(match) > 0.8 and abs(math.log(abs(factor) / DEGREES_PER_RADIAN)) < 0.2:
        return [_angle_unit_finding(record, "r", "psi", psi_dot, evidence)]
    if abs(match) > 0.8 and abs(math.log(abs(factor) * DEGREES_PER_RADIAN)) < 0.2:
        return [_angle_unit_finding(record, "psi", "r", psi_dot, evidence)]
    if match < -0.8 and 0.5 < abs(factor) < 2.0:
        what = f"{name} has the opposite sign of d(psi)/dt"
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, "declare the opposite positive direction for r")]
    if misfit > WRONG_MISFIT:
        what = f"{name} is not the yaw rate: it does not follow d(psi)/dt"
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, "look for the yaw rate in another column")]
    if misfit > ROUGH_MISFIT:
        what = f"{name} follows d(psi)/dt only roughly"
        return [Finding(Severity.WARNING, "yaw-rate", what, evidence, "check noise, lag and scale of r")]
    return []


def _angle_unit_finding(record: Record, large: str, small: str, psi_dot: Array, evidence: str) -> Finding:
    """`large` is 57 times too large or `small` 57 times too small; the course over ground decides which."""
    course = _course_rate_ratio(record, psi_dot)
    if course is None:
        what = f"either '{large}' is in degrees although declared in radians, or '{small}' the other way round"
    else:
        psi_is_right = 0.2 < course < 5.0
        guilty = large if psi_is_right == (large == "r") else small
        units = "in degrees although declared in radians" if guilty == large else "in radians, declared in degrees"
        what = f"'{guilty}' is {units}"
        evidence += f"; the course turns {course:.3g} times as fast as the heading"
    return Finding(
        Severity.ERROR, "angle-unit", f"record '{record.name}': {what}", evidence, "correct the unit in the trial file"
    )


def _course_rate_ratio(record: Record, psi_dot: Array) -> float | None:
    """Rate of the course over ground in terms of the heading's, from positions where the ship moves."""
    if "x0" not in record or "y0" not in record:
        return None
    length = window_length(len(record))
    north, east = (smoothed_derivative(record[s], record.dt, length) for s in ("x0", "y0"))
    if trimmed_rms(north, east) == 0:
        return None
    course = np.unwrap(np.arctan2(east, north))
    rate = np.gradient(course, record.dt)
    moving = np.hypot(north, east) > 0.3 * trimmed_rms(north, east)
    return abs(_regression_through_origin(rate[moving], psi_dot[moving])[0])


def _rudder_unit_findings(record: Record) -> list[Finding]:
    if "delta" not in record:
        return []
    largest = float(np.max(np.abs(record["delta"])))
    if largest > math.pi / 2:
        what = f"record '{record.name}': the rudder reaches {math.degrees(largest):.0f} deg"
        advice = 'the column is probably in degrees: declare unit = "deg" for delta'
        return [Finding(Severity.ERROR, "angle-unit", what, f"{largest:.4g} rad as declared", advice)]
    if 0.0 < largest < math.radians(45.0) / DEGREES_PER_RADIAN and np.ptp(record["delta"]) > 0.5 * largest:
        what = f"record '{record.name}': the rudder reaches only {math.degrees(largest):.2g} deg"
        advice = 'if the column is in radians, declare unit = "rad" for delta'
        return [Finding(Severity.WARNING, "angle-unit", what, f"{largest:.3g} rad as declared", advice)]
    return []
