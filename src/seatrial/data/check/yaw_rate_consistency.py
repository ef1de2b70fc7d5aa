"""Yaw rate against heading, angles in degrees or radians, columns that are something else than they say."""

import math

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity, TrialEdit
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.motion import DEGREES_PER_RADIAN, MIN_SAMPLES
from seatrial.data.check.signal import smoothed, smoothed_derivative, trimmed_rms, window_length

# heading range [rad] below which the yaw rate is not compared; chosen: above the noise of a compass
MIN_HEADING_RANGE = math.radians(2.0)
# correlation at which another channel is taken for the yaw rate, and largest relative departure of its factor; chosen
MIN_CORRELATION, MAX_DEPARTURE = 0.98, 0.1
# correlation with the rate of the heading from which on a yaw rate follows it; chosen
FOLLOWS = 0.8
# departure of a factor from that of a wrong unit, as a logarithm; range of the factor of a turned sign; chosen
SAME_UNIT, TURNED_RANGE = 0.2, (0.5, 2.0)
# rms difference from the rate of the heading, over its rms, that is wrong, and rough; chosen
WRONG_MISFIT, ROUGH_MISFIT = 0.9, 0.5
# rate of the course over that of the heading between which the heading's unit is right; speed over its rms from which
# on a ship has a course; chosen
COURSE_RANGE, MOVING = (0.2, 5.0), 0.3
# rad: a rudder that never goes further, were its unit mistaken; share of it that its range must exceed; chosen
FULL_RUDDER, MOVED_SHARE = math.radians(45.0), 0.5
SECONDS_PER_MINUTE = 60.0  # s, the factor of a rate in deg/min that is declared deg/s; by definition


def yaw_rate_findings(record: Record) -> tuple[Finding, ...]:
    """Return findings on r, p, psi and delta of a clean, signed record."""
    return (*_heading_consistency_findings(record), *_rudder_unit_findings(record))


def heading_rate(record: Record) -> Array | None:
    """Return the smoothed d(psi)/dt [rad/s]; None where the heading is missing or hardly moves."""
    if "psi" not in record or len(record) < MIN_SAMPLES:
        return None
    length = window_length(len(record))
    if np.ptp(smoothed(record["psi"], length)) < MIN_HEADING_RANGE:
        return None
    return smoothed_derivative(record["psi"], record.dt, length)


def _regression_through_origin(rate: Array, psi_dot: Array) -> tuple[float, float]:
    """Regression factor rate / turning and their correlation through the origin."""
    product = float(rate @ psi_dot)
    powers = float(rate @ rate), float(psi_dot @ psi_dot)
    return product / powers[1], product / math.sqrt(max(powers[0] * powers[1], 1e-300))  # above zero


def _heading_consistency_findings(record: Record) -> list[Finding]:
    turning = heading_rate(record)
    if turning is None:
        return []
    length = window_length(len(record))
    findings = []
    for symbol, channel in record.channels.items():
        if channel.unit == "rad/s" and symbol != "r":
            factor, match = _regression_through_origin(smoothed(channel.values, length), turning)
            if abs(match) > MIN_CORRELATION and abs(abs(factor) - 1.0) < MAX_DEPARTURE:
                findings.append(_mislabelled_finding(record, symbol, factor, match))
    if "r" not in record:
        return findings
    return findings + _yaw_rate_verdict(record, smoothed(record["r"], length), turning)


def channel_name(record: Record, symbol: str) -> str:
    """Return how messages name a channel: its symbol, and its name in the file."""
    label = record.channel(symbol).label
    return f"'{symbol}' ({label})" if label else f"'{symbol}'"


def _mislabelled_finding(record: Record, symbol: str, factor: float, match: float) -> Finding:
    text = f"record '{record.name}': channel {channel_name(record, symbol)} is in truth the yaw rate"
    text += " with the opposite sign" if factor < 0 else ""
    evidence = f"correlation with d(psi)/dt {match:.4f}, factor {factor:.3f}"
    edits = (TrialEdit(f"channels.{symbol}", exchanged_with="channels.r"),)
    if factor < 0:
        edits = (*edits, TrialEdit("channels.r.positive", '"port"'))
    return Finding(Severity.ERROR, "mislabelled", text, evidence, edits=edits)


def _yaw_rate_verdict(record: Record, r: Array, psi_dot: Array) -> list[Finding]:
    factor, match = _regression_through_origin(r, psi_dot)
    misfit = trimmed_rms(r - psi_dot) / trimmed_rms(psi_dot)
    evidence = f"correlation with d(psi)/dt {match:.3f}, factor {factor:.3g}, misfit {misfit:.0%}"
    name = f"record '{record.name}': channel {channel_name(record, 'r')}"
    if abs(match) > FOLLOWS and _is_per_minute(abs(factor)):
        what = f"{name} looks like deg/min"
        edits = (TrialEdit("channels.r.unit", '"deg/min"'),)
        return [Finding(Severity.ERROR, "angle-unit", what, evidence, edits=edits)]
    if abs(match) > FOLLOWS and abs(math.log(abs(factor) / DEGREES_PER_RADIAN)) < SAME_UNIT:
        return [_angle_unit_finding(record, "r", "psi", psi_dot, evidence)]
    if abs(match) > FOLLOWS and abs(math.log(abs(factor) * DEGREES_PER_RADIAN)) < SAME_UNIT:
        return [_angle_unit_finding(record, "psi", "r", psi_dot, evidence)]
    if match < -FOLLOWS and TURNED_RANGE[0] < abs(factor) < TURNED_RANGE[1]:
        what = f"{name} has the opposite sign of d(psi)/dt"
        edits = (TrialEdit("channels.r.positive", REVERSED),)
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, edits=edits)]
    if misfit > WRONG_MISFIT:
        what = f"{name} is not the yaw rate: it does not follow d(psi)/dt"
        return [Finding(Severity.ERROR, "yaw-rate", what, evidence, "look for the yaw rate in another column")]
    if misfit > ROUGH_MISFIT:
        what = f"{name} follows d(psi)/dt only roughly"
        return [Finding(Severity.WARNING, "yaw-rate", what, evidence, "check noise, lag and scale of r")]
    return []


def _is_per_minute(factor: float) -> bool:
    """Whether a rate is too large by 60 (deg/min declared deg/s) or 3438 (declared rad/s), and not by 57.3."""
    sizes = (SECONDS_PER_MINUTE, SECONDS_PER_MINUTE * DEGREES_PER_RADIAN)
    best = min(sizes, key=lambda size: abs(math.log(factor / size)))
    distance = abs(math.log(factor / best))
    return distance < SAME_UNIT and distance < abs(math.log(factor / DEGREES_PER_RADIAN))


def _angle_unit_finding(record: Record, large: str, small: str, psi_dot: Array, evidence: str) -> Finding:
    """`large` is 57 times too large or `small` 57 times too small; the course over ground decides which."""
    course, edits = _course_rate_ratio(record, psi_dot), tuple[TrialEdit, ...]()
    if course is None:
        what = f"either '{large}' is in degrees although declared in radians, or '{small}' the other way round"
    else:
        psi_is_right = COURSE_RANGE[0] < course < COURSE_RANGE[1]
        guilty = large if psi_is_right == (large == "r") else small
        units = "in degrees although declared in radians" if guilty == large else "in radians, declared in degrees"
        what = f"'{guilty}' is {units}"
        evidence += f"; the course turns {course:.3g} times as fast as the heading"
        rate = "/s" if guilty == "r" else ""
        edits = (TrialEdit(f"channels.{guilty}.unit", f'"{"deg" if guilty == large else "rad"}{rate}"'),)
    text = f"record '{record.name}': {what}"
    advice = "correct the unit of the wrong one in the trial file"
    return Finding(Severity.ERROR, "angle-unit", text, evidence, advice, edits=edits)


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
    moving = np.hypot(north, east) > MOVING * trimmed_rms(north, east)
    return abs(_regression_through_origin(rate[moving], psi_dot[moving])[0])


def _rudder_unit_findings(record: Record) -> list[Finding]:
    if "delta" not in record:
        return []
    largest = float(np.max(np.abs(record["delta"])))
    if largest > math.pi / 2:
        what = f"record '{record.name}': the rudder reaches {math.degrees(largest):.0f} deg"
        edits = (TrialEdit("channels.delta.unit", '"deg"'),)
        return [Finding(Severity.ERROR, "angle-unit", what, f"{largest:.4g} rad as declared", edits=edits)]
    if 0.0 < largest < FULL_RUDDER / DEGREES_PER_RADIAN and np.ptp(record["delta"]) > MOVED_SHARE * largest:
        what = f"record '{record.name}': the rudder reaches only {math.degrees(largest):.2g} deg"
        advice = 'if the column is in radians, declare unit = "rad" for delta'
        return [Finding(Severity.WARNING, "angle-unit", what, f"{largest:.3g} rad as declared", advice)]
    return []
