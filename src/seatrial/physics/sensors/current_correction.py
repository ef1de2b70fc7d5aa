"""A run corrected for the current: the drift of the water is taken off its track, and off velocities over ground.

IMO MSC/Circ.1053 (2002), 3.4.2.5, and ITTC 7.5-04-02-01 (2002), 5.1.1, correct turning circles so; there the current is
read from the circle itself, here it is the one that the fit estimated from all runs of the session.
"""

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.estimated_current import EstimatedCurrent
from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres import to_starboard
from seatrial.physics.sensors.settings import Sensors, VelocityReference


def shows_ground_velocity(model: Model) -> bool:
    """Return whether u and v in records of this model's craft are over ground, so that a current is in them."""
    text = model.equations.sensors
    return bool(text) and Sensors.from_text(text).velocity is VelocityReference.GROUND


def without_current(record: Record, current: EstimatedCurrent | None, has_ground_velocity: bool) -> Record:
    """Return the run as it went through the water, from where it began; the record itself where no current is known.

    The position becomes that of the start plus the way through the water, x'(t) = x(t) - v_c t. u and v over ground
    lose the current's components along and across the heading that the compass showed.
    """
    if current is None:
        return record
    elapsed = record.time - record.time[0]
    for symbol, drift in (("x0", current.north), ("y0", current.east)):
        if symbol in record:
            record = _less(record, symbol, drift * elapsed)  # MSC/Circ.1053, 3.4.2.5
    if not has_ground_velocity or "psi" not in record:
        return record
    psi = to_starboard(record, "psi")
    ahead = current.north * np.cos(psi) + current.east * np.sin(psi)
    to_the_right = -current.north * np.sin(psi) + current.east * np.cos(psi)
    for symbol, part in (("u", ahead), ("v", to_the_right)):
        if symbol in record:
            record = _less(record, symbol, part)
    return record


def _less(record: Record, symbol: str, part: Array) -> Record:
    channel = record.channel(symbol)
    sign = -1.0 if channel.positive == "port" else 1.0
    return record.with_channel(symbol, channel.with_values(channel.values - sign * part))
