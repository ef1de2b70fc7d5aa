"""The approach of a manoeuvre: whether a craft runs straight at a steady speed when the rudder is first put over."""

import numpy as np

from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import unwrapped
from seatrial.data.check.motion import MIN_SAMPLES
from seatrial.data.check.signal import smoothed, window_length
from seatrial.physics.manoeuvres import ManoeuvreKind, recognise_manoeuvre
from seatrial.physics.manoeuvres.track import speed

EXECUTION_FRACTION = 0.2  # of the record's largest rudder angle, from which on the rudder is put over; chosen
# s before the execute over which the yaw rate is a mean and the speed is looked at, and share of the run at least;
# chosen: some lengths of a model
_RATE_S, _SPEED_S, _SPEED_SHARE = 1.0, 10.0, 0.1
# yaw rate at the execute over the largest, change of speed before it over the mean, and standard errors of that change,
# up to which an approach is steady; chosen
_TURNS, _CHANGES, _STANDARD_ERRORS = 0.2, 0.03, 4.0
_FEWEST_ROWS = 5  # before the execute, for a change of speed; chosen
_WITH_APPROACH = (ManoeuvreKind.ZIGZAG, ManoeuvreKind.TURNING_CIRCLE, ManoeuvreKind.PULL_OUT)


def first_execution(record: Record) -> int:
    """Return the row at which the rudder is first put over; 0 where it never is.

    Raises:
        InputError: the record has no channel delta.
    """
    rudder = np.abs(record["delta"])
    return int(np.argmax(rudder >= EXECUTION_FRACTION * np.max(rudder)))


def approach_fault(record: Record) -> str:
    """Return why the approach of a complete record is not steady; empty where it is, or where nothing shows it."""
    if "delta" not in record or len(record) < MIN_SAMPLES:
        return ""
    row = first_execution(record)
    return _still_turns(record, row) or _speed_changes(record, row)


def approach_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where a zigzag or a turn of a clean, signed record begins while the craft is still settling."""
    fault = approach_fault(record)
    if not fault or not _is_manoeuvre(record):
        return ()
    text = f"record '{record.name}': no steady approach before the first execute"
    advice = (
        "start the run earlier, on a straight course at a steady speed; its approach speed counts only where no run "
        "has a steady one"
    )
    return (Finding(Severity.WARNING, "approach", text, fault, advice),)


def _is_manoeuvre(record: Record) -> bool:
    try:
        return recognise_manoeuvre(record) in _WITH_APPROACH
    except InputError:
        return False


def _still_turns(record: Record, row: int) -> str:
    """The yaw rate at the execute, where it is a fifth of the largest."""
    turning = _yaw_rate(record)
    if turning is None:
        return ""
    before = max(1, round(_RATE_S / record.dt))
    rate = abs(float(np.mean(turning[max(0, row - before) : max(row, 1)])))
    largest = float(np.max(np.abs(smoothed(turning, window_length(len(record))))))
    if rate <= _TURNS * largest:
        return ""
    return f"it turns at {np.degrees(rate):.2g} deg/s there, and by {np.degrees(largest):.2g} deg/s at most in the run"


def _yaw_rate(record: Record) -> Array | None:
    if "r" in record:
        return record["r"]
    return np.gradient(unwrapped(record["psi"]), record.dt) if "psi" in record else None


def _speed_changes(record: Record, row: int) -> str:
    """The change of speed (of a straight line through it) in the time before the execute, where it is large."""
    flow = speed(record)
    first = max(0, row - round(max(_SPEED_S, _SPEED_SHARE * record.duration) / record.dt))
    if flow is None or row - first < _FEWEST_ROWS:
        return ""
    values = flow[first:row]
    place = np.linspace(-0.5, 0.5, values.size)
    change = float(place @ values) / float(place @ place)
    scatter = float(np.std(values - values.mean() - change * place))
    error = scatter / float(np.sqrt(place @ place))
    mean = float(values.mean())
    if abs(change) <= max(_CHANGES * abs(mean), _STANDARD_ERRORS * error):
        return ""
    start, end = mean - 0.5 * change, mean + 0.5 * change
    return f"speed {start:.3g} to {end:.3g} m/s in the {(row - first) * record.dt:.2g} s before it"
