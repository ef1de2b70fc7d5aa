"""What thrusters hold at most, by direction off the bow: a steady current, a force; static, as capability plots are.

Static capability as IMCA M 140 draws it: forces of the current against thrust within its limits, yaw in balance.
"""

import math

import numpy as np

from seatrial.control.station.allocation import largest_force, share_given
from seatrial.control.station.craft import StationCraft
from seatrial.core.results.station import StationCapability
from seatrial.core.values import Array

_DIRECTIONS = 24  # every 15 degrees; chosen
_FIRST, _FASTEST = 0.5, 30.0  # m/s: where a search starts, and beyond any current; chosen
_ROUNDS, _ACCURACY = 30, 1e-4  # of a search, and relative change of speed that ends it; chosen
_POWER = 0.5  # of the force's factor that the speed takes: drag grows with its square at most


def current_force(craft: StationCraft, speed: float, direction: float) -> Array:
    """Return the force (3,) of a current from a direction off the bow [rad] on the craft, thrusters at rest."""
    model = craft.model
    rates = np.empty(len(model.states))
    model.compiled.rates(0.0, craft.in_current(speed, direction), craft.resting_inputs, model.parameters.values, rates)
    return craft.inertia @ rates[[model.states.index(name) for name in ("u", "v", "r")]]


def capability(craft: StationCraft, inverse: Array) -> StationCapability:
    """Return the current and the force that are held from all directions; inverse: of the loop (m, 3)."""
    directions = 2.0 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    currents = np.array([_largest_current(craft, direction, None) for direction in directions])
    shared_out = np.array([_largest_current(craft, direction, inverse) for direction in directions])
    limiting = tuple(
        largest_force(craft, -current_force(craft, speed, direction)).at_limit
        for speed, direction in zip(currents, directions, strict=True)
    )
    forces = [largest_force(craft, np.array([math.cos(a), math.sin(a), 0.0])).factor for a in directions]
    return StationCapability(directions, currents, shared_out, np.array(forces), limiting)


def _largest_current(craft: StationCraft, direction: float, inverse: Array | None) -> float:
    """Return the fastest current [m/s] that is held: by any sharing out, or by that of an inverse (m, 3)."""
    speed = _FIRST
    for _ in range(_ROUNDS):
        force = -current_force(craft, speed, direction)
        if inverse is None:
            factor = largest_force(craft, force).factor
        else:
            factor = float(share_given(craft, inverse, force[None])[0])
        before, speed = speed, min(speed * factor**_POWER, _FASTEST)
        if abs(speed - before) <= _ACCURACY * before or speed == 0.0:
            break
    return speed
