"""Drift in turns: a hull turns with its bow to the inside, and a record that has it outside is off somewhere."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, Severity
from seatrial.data.check.motion import RecordedMotion
from seatrial.data.check.signal import smoothed_derivative

LEAST_TURN = float(np.radians(180.0))
"""Change of heading in one direction that counts as a turn [rad]: a steady current averages out over more; chosen."""
LEAST_DRIFT = float(np.radians(2.0))
"""Drift to the outside of the turn from which on it is said [rad]: some errors of a compass; chosen."""
_SLOW = 0.3  # share of the record's highest speed ahead, below which a craft spins rather than turns; chosen


@dataclass(frozen=True)
class _Turn:
    """A turn's mean drift to its outside [rad], and how far the point without drift lies aft of midship [m]."""

    is_starboard: bool
    outward: float
    aft: float


def drift_side_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Return a warning `drift-side` where the bow points out of every turn, at midship as declared; else nothing.

    Forces on the hull need a drift to the inside (Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion
    Control, 2nd ed., section 3.3, sideslip and crab angle): sway is negative in a turn to starboard.
    """
    turns = _turns(motion)
    if not turns or any(turn.outward < LEAST_DRIFT for turn in turns):
        return ()
    sides = [
        f"{np.degrees(np.mean([t.outward for t in turns if t.is_starboard == side])):.1f} deg in turns to {name}"
        for side, name in ((True, "starboard"), (False, "port"))
        if any(t.is_starboard == side for t in turns)
    ]
    aft = float(np.median([t.aft for t in turns]))
    return (Finding(
        Severity.WARNING, "drift-side", f"record '{motion.record.name}': the bow points out of the turn, where that of "
        "a ship points into it", f"{', '.join(sides)}; the point without drift lies {significant(aft, 2)} m aft of "
        "where the velocities are said to be",
        "if the antenna is ahead of midship, state it: antenna = { x = ..., y = ... } under [[records]]; else check "
        "the signs of v, of heading and of course",
        "sway is that of another motion, and so are all coefficients of sway",
    ),)  # fmt: skip


def _turns(motion: RecordedMotion) -> list[_Turn]:
    """Turns by their later half, where the drift has settled."""
    record = motion.record
    psi, dt = record["psi"], record.dt
    inner = smoothed_derivative(psi, dt, motion.window_samples)
    margin = (len(psi) - len(inner)) // 2
    rate = np.pad(inner, (margin, len(psi) - len(inner) - margin), mode="edge")
    ahead, aside = _body_velocities(motion)
    aside = aside - rate * record.channel("v").reference_point
    edges = [0, *(np.flatnonzero(np.diff(np.sign(rate)) != 0) + 1).tolist(), len(psi)]
    turns = []
    for first, last in pairwise(edges):
        if last - first < 2 or abs(psi[last - 1] - psi[first]) < LEAST_TURN:
            continue
        later = slice(first + int(np.searchsorted(_turned(psi[first:last]), 0.5)), last)
        u, v, r = (np.nanmean(values[later]) for values in (ahead, aside, rate))
        if u > _SLOW * np.nanmax(ahead) and r != 0.0:
            turns.append(_Turn(bool(r > 0.0), float(np.sign(r) * np.arctan2(v, u)), float(v / r)))
    return turns


def _turned(psi: Array) -> Array:
    """Share of a turn's change of heading that is done, (n,), never decreasing."""
    return np.maximum.accumulate(np.abs(psi - psi[0]) / abs(psi[-1] - psi[0]))


def _body_velocities(motion: RecordedMotion) -> tuple[Array, Array]:
    """Velocities ahead and to starboard [m/s], (n,) each."""
    u, v, psi = (motion.record[s] for s in ("u", "v", "psi"))
    if motion.frame == "body":
        return u, v
    return u * np.cos(psi) + v * np.sin(psi), v * np.cos(psi) - u * np.sin(psi)
