"""Single channels: dead or stuck, constant, holes, wraps, sizes, levels at rest; and lags between channels."""

import numpy as np

from seatrial.core.values import NOTATION, Array, Finding, InputError, Record, Severity, display_unit
from seatrial.core.values.arrays import mask_intervals
from seatrial.data.check.consequences import moment
from seatrial.data.check.consistency import FOLLOWS, heading_rate, shift_text
from seatrial.data.check.motion import (
    jackknife_least_squares,
    smoothed,
    smoothed_derivative,
    window_length,
)
from seatrial.data.check.time_base import INPUT_CHANNELS
from seatrial.numerics.resolution import local_resolution

# Readings that no ship can show, such as 1e150 m/s: refused before anything is computed from them.

# in SI units: the pitching moment of the heaviest ship is 1e12 N m; ours, a thousand times that
_LARGEST_READING = 1e15


def require_possible_sizes(record: Record) -> None:
    """Refuse a record with a reading that no ship can show; empty readings pass.

    Raises:
        InputError: there is one; the first is named.
    """
    for symbol, channel in record.channels.items():
        rows = np.flatnonzero(np.abs(channel.values) > _LARGEST_READING)
        if rows.size:
            raise InputError(
                f"record '{record.name}': channel '{symbol}' is {channel.values[rows[0]]:.3g} {channel.unit} at "
                f"{record.time[rows[0]]:.6g} s, which no ship shows; correct its unit, or leave the cell empty"
            )


# The level about which a craft heaves and pitches in recorded waves: sinkage, trim, or the zero of a sensor.

_WAVES, _MOTIONS = ("zeta", "F3"), ("z", "theta")
# of the standard deviation of a motion, from which on its mean is no part of an oscillation of whole periods; chosen
_LEAST_SHARE = 0.1
# periods that a record must have, in which an oscillation about zero has a mean of 1 / (2 pi 10) of its amplitude
_FEWEST_PERIODS = 10


def resting_level_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning `resting-level` for each motion in recorded waves whose mean is not zero.

    record: complete, standard signs.
    """
    if not any(name in record for name in _WAVES):
        return ()
    return tuple(finding for name in _MOTIONS if name in record for finding in _of_motion(record, name))


def _of_motion(record: Record, name: str) -> tuple[Finding, ...]:
    values, quantity = record[name], NOTATION[name]
    mean, size = float(np.mean(values)), float(np.std(values))
    crossings = np.count_nonzero(np.diff(np.sign(values - mean)))
    if crossings < 2 * _FEWEST_PERIODS or abs(mean) < _LEAST_SHARE * size:
        return ()
    degrees = quantity.unit == "rad"
    level = f"{np.degrees(mean):.3g} deg" if degrees else f"{mean:.3g} {quantity.unit}"
    return (Finding(
        Severity.WARNING, "resting-level", f"record '{record.name}': '{name}' moves about {level}, not about 0",
        f"its mean is {abs(mean) / size:.2g} of its standard deviation",
        f"subtract it: zero = ... in channels.{name}, in the column's unit and sign",
    ),)  # fmt: skip


# Single channels: dead or stuck, constant, holes, wraps; and lags between channels.

OUTPUT_CHANNELS = ("x0", "y0", "psi", "u", "v", "r", "phi", "p", "theta", "z", "u_dot", "v_dot")
# a channel sticks where it repeats a value for so many samples and this share of the record, ours
STUCK_SAMPLES, STUCK_FRACTION = 20, 0.02
_STEPS = 1.5  # resolutions, by which a channel moves on at most that was never stuck; chosen, between one and two
# a lag is reported beyond so many standard errors and so many samples, ours
LAG_STANDARD_ERRORS, LAG_SAMPLES = 4.0, 1.5


def channel_findings(record: Record) -> tuple[Finding, ...]:
    """Dead, stuck and constant channels, and headings that wrap, of a record as it was read."""
    findings: list[Finding] = []
    wraps: dict[str, int] = {}
    for symbol, channel in record.channels.items():
        values = channel.values[np.isfinite(channel.values)]
        if values.size < 2:
            continue
        if np.ptp(values) == 0:
            findings.append(_constant_finding(record, symbol, float(values[0])))
        elif symbol in OUTPUT_CHANNELS:
            findings += _stuck_findings(record, symbol, channel.values)
        if channel.unit == "rad" and symbol not in INPUT_CHANNELS:
            wraps[symbol] = int(np.sum(np.abs(np.diff(values)) > np.pi))
    wraps = {symbol: count for symbol, count in wraps.items() if count}
    if wraps:
        text = f"record '{record.name}': readings of {', '.join(wraps)} jump by a whole turn; they are unwrapped"
        evidence = ", ".join(f"{symbol} {count} times" for symbol, count in wraps.items())
        findings.append(Finding(Severity.INFO, "angle-wrap", text, evidence))
    return tuple(findings)


def _constant_finding(record: Record, symbol: str, value: float) -> Finding:
    factor, unit = display_unit(record.channel(symbol).unit)
    evidence = f"{value * factor:.6g} {unit} throughout"
    if symbol in OUTPUT_CHANNELS:
        text = f"record '{record.name}': channel '{symbol}' is dead, it never changes"
        return Finding(Severity.WARNING, "dead-channel", text, evidence)
    text = f"record '{record.name}': channel '{symbol}' is constant"
    return Finding(Severity.INFO, "constant", text, evidence)


def _stuck_findings(record: Record, symbol: str, values: Array) -> list[Finding]:
    """The longest stay at one value over twenty samples and a fiftieth of the record that its resolution does not
    explain; of one that ends with a step of the resolution how coarse the channel is.
    """
    known = np.flatnonzero(np.isfinite(values))
    readings = np.unwrap(values[known]) if record.channel(symbol).unit == "rad" else values[known]
    moves = np.diff(readings)
    stays = [
        (a, b) for a, b in mask_intervals(moves == 0.0) if b - a >= max(STUCK_SAMPLES, STUCK_FRACTION * len(known))
    ]
    if not stays:
        return []
    step = _local_steps(record, symbol)[known]
    stuck = [(a, b) for a, b in stays if abs(moves[b if b < len(moves) else a - 1]) > _STEPS * max(step[a], step[b])]
    first, last = max(stuck or stays, key=lambda ends: ends[1] - ends[0])
    count, (factor, unit) = last - first + 1, display_unit(record.channel(symbol).unit)
    if not stuck:
        size = f"{step[first] * factor:.4g} {unit}"
        text = f"record '{record.name}': channel '{symbol}' comes in steps of {size}"
        return [Finding(Severity.INFO, "resolution", text, f"a value stays for up to {count} samples")]
    text = f"record '{record.name}': channel '{symbol}' is stuck for {count} samples"
    evidence = f"{values[known[first]] * factor:.6g} {unit} from {moment(*record.time[known[[first, last]]])}"
    return [Finding(Severity.WARNING, "stuck", text, evidence)]


def _local_steps(record: Record, symbol: str) -> Array:
    """Return the step in which each value of a channel was written, (n,); of a speed and a course, that of either."""
    steps = local_resolution(record[symbol])
    if symbol not in ("u", "v") or not {"u", "v"} <= set(record.channels) or record.channel(symbol).frame != "earth":
        return steps
    speed, course = np.hypot(record["u"], record["v"]), np.arctan2(record["v"], record["u"])
    return np.fmax(steps, np.fmax(local_resolution(speed), speed * local_resolution(course)))


def lag_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning on a lag of r behind the heading of a clean, signed record; that of u, v shows in `closure`."""
    delay, error = yaw_rate_lag(record) or (0.0, 0.0)
    if abs(delay) <= max(LAG_SAMPLES * record.dt, LAG_STANDARD_ERRORS * error):
        return ()
    order = "r lags behind the heading" if delay > 0 else "r leads the heading, or the heading is late,"
    text = f"record '{record.name}': {order} by about {abs(delay):.2g} s"
    evidence = f"{abs(delay) / record.dt:.1f} samples, standard error {error:.2g} s"
    advice = f"write r {shift_text(delay)} into the file, or leave r out of channels under [estimate]"
    return (Finding(Severity.WARNING, "lag", text, evidence, advice),)


def yaw_rate_lag(record: Record) -> tuple[float, float] | None:
    """Return the delay of the yaw rate behind that of the heading [s] and its standard error.

    Fitted: d(psi)/dt - r = tau dr/dt + constant. None where they do not belong together.
    """
    turning = heading_rate(record)
    if turning is None or "r" not in record:
        return None
    length = window_length(len(record))
    r = smoothed(record["r"], length)
    if np.ptp(r) == 0 or np.corrcoef(r, turning)[0, 1] < FOLLOWS:
        return None
    rate = smoothed_derivative(record["r"], record.dt, length)
    solution, errors = jackknife_least_squares(np.column_stack([rate, np.ones(len(rate))]), turning - r)
    return float(solution[0]), float(errors[0])
