"""Does the rudder move, and does the ship turn the way its sign says?"""

import math

import numpy as np

from seatrial.check.rates import heading_rate
from seatrial.check.signal import jackknifed, slope, smoothed, window
from seatrial.values import Array, Finding, Record, Severity

STILL = math.radians(0.2)
CLEAR, DOUBTFUL = 5.0, 2.5
ANGLES = "run a zigzag, for example 10/10 or 20/20"


def is_excited(record: Record) -> bool:
    """Whether the rudder moves by more than .2 degrees between its 1 % and 99 % quantiles (or extremes, if short)."""
    if "delta" not in record:
        return False
    delta = record["delta"][np.isfinite(record["delta"])]
    return delta.size > 1 and float(np.ptp(delta)) > STILL


def rudder_findings(record: Record) -> tuple[Finding, ...]:
    """Findings on delta of a clean, signed record."""
    if "delta" not in record:
        return ()
    if not is_excited(record):
        what = f"record '{record.name}': the rudder never moves, so nothing can be learnt about steering"
        span = f"range {math.degrees(float(np.ptp(record['delta']))):.2g} deg"
        return (Finding(Severity.WARNING, "no-excitation", what, span, ANGLES),)
    answer = response(record)
    if answer is None:
        return ()
    effect, error = answer
    ratio = effect / max(error, 1e-300)
    if ratio > -DOUBTFUL:
        return ()
    label = record.channel("delta").label
    is_clear = ratio < -CLEAR
    return (
        Finding(
            Severity.ERROR if is_clear else Severity.WARNING,
            "rudder-sign",
            f"record '{record.name}': rudder 'delta'{f' ({label})' if label else ''} "
            f"{'has' if is_clear else 'may have'} the opposite sign: what is declared as starboard turns the ship to port",
            f"d(r)/dt per rudder angle {effect:.3g} 1/s^2, standard error {error:.2g}",
            'declare positive = "port" for delta if it says starboard now, "starboard" if it says port',
        ),
    )


def response(record: Record) -> tuple[float, float] | None:
    """Yaw acceleration per rudder angle [1/s^2] and its standard error, or None where the heading tells nothing.

    First-order response dr/dt = a r + b delta + c (Nomoto 1957, eq. 1) by least squares on smoothed signals, errors by
    block jackknife; where the propeller also turns astern only the samples with it ahead count.
    """
    yaw = _yaw(record)
    if yaw is None:
        return None
    length = window(len(record))
    features = np.stack(
        [smoothed(yaw, length), smoothed(record["delta"], length), np.ones(len(record) - length + 1)], 1
    )
    target = slope(yaw, record.dt, length)
    ahead = _ahead(record, length)
    if ahead.sum() < 30 or np.ptp(features[ahead, 1]) < STILL:
        return None
    coefficients, errors = jackknifed(features[ahead], target[ahead])
    return float(coefficients[1]), float(errors[1])


def _yaw(record: Record) -> Array | None:
    """The measured yaw rate where it follows the heading, otherwise the heading's derivative."""
    turning = heading_rate(record)
    if turning is None:
        return None
    if "r" in record:
        r = smoothed(record["r"], window(len(record)))
        if np.corrcoef(r, turning)[0, 1] > 0.8:
            return record["r"]
    return np.gradient(record["psi"], record.dt)


def _ahead(record: Record, length: int) -> Array:
    count = len(record) - length + 1
    if "n" not in record or record["n"].max() <= 0:
        return np.ones(count, dtype=bool)
    n = smoothed(record["n"], length)
    return n > 0.05 * record["n"].max()
