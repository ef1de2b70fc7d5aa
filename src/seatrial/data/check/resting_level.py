"""The level about which a craft heaves and pitches in recorded waves: sinkage, trim, or the zero of a sensor."""

import numpy as np

from seatrial.core.values import NOTATION, Finding, Record, Severity

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
