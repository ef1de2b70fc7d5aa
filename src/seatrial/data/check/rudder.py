"""Does the rudder move, and does the ship turn the way its sign says?"""

import math
from itertools import accumulate

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity, TrialEdit
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.motion import MIN_SAMPLES
from seatrial.data.check.run_phases import STOPPED_FRACTION
from seatrial.data.check.signal import Mask, jackknife_least_squares, smoothed, smoothed_derivative, window_length
from seatrial.data.check.yaw_rate_consistency import FOLLOWS, channel_name, heading_rate
from seatrial.physics.manoeuvres.track import speed

# rudder range [rad] that counts as excitation; chosen: more than the noise of a sensor
MIN_RUDDER_RANGE = math.radians(0.2)
# t values of one run and of all runs pooled that prove a sign, and that make it doubtful; chosen
CERTAIN_T, POOLED_T, DOUBTFUL_T = 5.0, 3.5, 2.0
# lags of the rudder that are tried; chosen: each a third longer than the one before, about
LAGS = 12
ZIGZAG_ADVICE = "run a zigzag, for example 10/10 or 20/20"


def is_excited(record: Record) -> bool:
    """Return whether the rudder moves by more than 0.2 degrees in all; False without a rudder."""
    if "delta" not in record:
        return False
    delta = record["delta"][np.isfinite(record["delta"])]
    return delta.size > 1 and float(np.ptp(delta)) > MIN_RUDDER_RANGE


def rudder_findings(record: Record) -> tuple[Finding, ...]:
    """Return findings on delta of a clean, signed record."""
    if "delta" not in record:
        return ()
    if not is_excited(record):
        text = f"record '{record.name}': the rudder never moves, so nothing can be learnt about steering"
        span = f"range {math.degrees(float(np.ptp(record['delta']))):.2g} deg"
        return (Finding(Severity.WARNING, "no-excitation", text, span, ZIGZAG_ADVICE),)
    first, steady = t_ratio(yaw_acceleration_response(record)), t_ratio(steady_turning_response(record))
    pooled = (first + steady) / math.sqrt(2.0) if max(first, steady) < 0 else 0.0
    contradicts = min(first, steady) < -DOUBTFUL_T and max(first, steady) > DOUBTFUL_T
    if min(first, pooled) > -DOUBTFUL_T or contradicts:
        return ()
    is_clear = first < -CERTAIN_T or pooled < -POOLED_T
    text = f"record '{record.name}': rudder {channel_name(record, 'delta')} {'has' if is_clear else 'may have'}"
    text += " the opposite sign: the ship turns to port where starboard rudder is declared"
    evidence = f"effect over standard error: {first:.1f} on yaw acceleration, {steady:.1f} on the turn that follows"
    severity = Severity.ERROR if is_clear else Severity.WARNING
    edits = (TrialEdit("channels.delta.positive", REVERSED),)
    return (Finding(severity, "rudder-sign", text, evidence, edits=edits),)


def t_ratio(estimate: tuple[float, float] | None) -> float:
    """Return an estimate over its standard error; 0 where there is none."""
    return 0.0 if estimate is None else estimate[0] / max(estimate[1], 1e-300)  # above zero


def yaw_acceleration_response(record: Record) -> tuple[float, float] | None:
    """Return the yaw acceleration per rudder angle [1/s^2] and its standard error, None where the heading shows none.

    First-order response dr/dt = a r + b delta + c (Nomoto 1957, eq. 1) by least squares on smoothed signals, errors by
    block jackknife; where the propeller also turns astern only the samples with it ahead count.
    """
    yaw = _yaw_rate_signal(record)
    if yaw is None:
        return None
    length = window_length(len(record))
    delta = smoothed(record["delta"], length)
    ahead = _propeller_ahead(record, length)
    if ahead.sum() < MIN_SAMPLES or np.ptp(delta[ahead]) < MIN_RUDDER_RANGE:
        return None
    features = np.column_stack([smoothed(yaw, length), delta, np.ones_like(delta)])
    coefficients, errors = jackknife_least_squares(features[ahead], smoothed_derivative(yaw, record.dt, length)[ahead])
    return float(coefficients[1]), float(errors[1])


def steady_turning_response(record: Record) -> tuple[float, float] | None:
    """Return the yaw rate per (speed times lagged rudder) [1/m] and its standard error; None as before.

    r = K U delta_T + c with delta_T the rudder behind a first-order lag T, the one of twelve that correlates best:
    the sign of a long turn, to which the initial response adds little.
    """
    yaw = _yaw_rate_signal(record)
    if yaw is None:
        return None
    length = window_length(len(record))
    r, ahead = smoothed(yaw, length), _propeller_ahead(record, length)
    U = speed(record)
    best, best_match = None, 0.0
    for samples in np.geomspace(length / 2, len(record) / 3, LAGS):
        effect = smoothed(_first_order_lag(record["delta"], samples) * (1.0 if U is None else U), length)
        if ahead.sum() < MIN_SAMPLES or np.ptp(effect[ahead]) == 0 or np.ptp(r[ahead]) == 0:
            continue
        match = abs(float(np.corrcoef(effect[ahead], r[ahead])[0, 1]))
        if match > best_match:
            best, best_match = effect, match
    if best is None:
        return None
    coefficients, errors = jackknife_least_squares(np.column_stack([best, np.ones_like(best)])[ahead], r[ahead])
    return float(coefficients[0]), float(errors[0])


def _first_order_lag(values: Array, samples: float) -> Array:
    """First-order lag of the given number of samples, started at rest at the first value."""
    a = 1.0 / (samples + 1.0)
    late = accumulate(values.tolist(), lambda before, value: a * value - (a - 1.0) * before, initial=float(values[0]))
    return np.array(list(late)[1:])


def _yaw_rate_signal(record: Record) -> Array | None:
    """The measured yaw rate where it follows the heading, otherwise the heading's derivative."""
    turning = heading_rate(record)
    if turning is None:
        return None
    if "r" in record:
        r = smoothed(record["r"], window_length(len(record)))
        if np.corrcoef(r, turning)[0, 1] > FOLLOWS:
            return record["r"]
    return np.gradient(record["psi"], record.dt)


def _propeller_ahead(record: Record, length: int) -> Mask:
    count = len(record) - length + 1
    if "n" not in record or record["n"].max() <= 0:
        return np.ones(count, dtype=bool)
    n = smoothed(record["n"], length)
    return n > STOPPED_FRACTION * record["n"].max()
