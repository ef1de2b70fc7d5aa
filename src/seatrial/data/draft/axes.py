"""Axes of positions and attitudes that a log leaves open, by the GNSS fixes of the same run or by its thrusters."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.signal import least_squares
from seatrial.data.check.velocity_conventions import ACCEPTABLE_MISFIT, CERTAIN_RATIO
from seatrial.data.draft.column_guess import ColumnGuess

_POSITIONS, _FIXES, _QUATERNION = ("x0", "y0"), ("lat", "lon"), ("q_w", "q_x", "q_y", "q_z")
_READINGS = ("enu", "earth")
_SIDES = ("port", "starboard")
_LEAST_SAMPLES = 30  # of the track beside the fixes; as in the checks

Parts = list[list[ColumnGuess]]
RecordOf = Callable[[Sequence[Sequence[ColumnGuess]]], Record | None]
"""The record of the used guesses of a run."""


def with_axes_by_fixes(parts: Parts, record_of: RecordOf) -> Parts:
    """Return the guesses with the axes of open positions as the fixes show them, then those of open attitudes.

    Positions are compared with the fixes, attitudes with the velocities and the derivative of position; one reading
    must fit, and the other three times worse.
    """
    if not _has_open(parts, _POSITIONS):
        return parts
    fixes, pose = record_of(_fixes_only(parts)), (*_POSITIONS, *_QUATERNION)
    if fixes is None:
        return parts
    poses = {reading: record_of(_with_frame(_only(parts, pose), pose, reading, 0.0, "")) for reading in _READINGS}
    frame = _surer({one: _distance(record, fixes) for one, record in poses.items()})
    if frame is None:
        return parts
    settled = _with_frame(parts, _POSITIONS, *frame, "with the GNSS fixes")
    if not _has_open(parts, _QUATERNION):
        return settled
    frame = _surer({reading: _heading_misfit(record_of(_with_frame(settled, _QUATERNION, reading, 0.0, "")))
                    for reading in _READINGS})  # fmt: skip
    return settled if frame is None else _with_frame(settled, _QUATERNION, *frame, "of velocities turned by it")


def with_axes_by_thrusters(parts: Parts, named: Mapping[str, str]) -> Parts:
    """Return the guesses with open axes settled where thrusters to both sides turn the craft as their names say.

    Read the other way the world is mirrored, and each thruster would be on the other side.

    named: command -> side that its name has, port or starboard; empty: none.
    """
    shown = {g.symbol: g.side for part in parts for g in part if g.is_used and not g.is_open}
    agreeing = [side for symbol, side in named.items() if side and shown.get(symbol) == side]
    contradicted = any(side and shown.get(symbol, side) != side for symbol, side in named.items())
    if contradicted or len(set(agreeing)) < len(_SIDES):
        return parts
    evidence = "as thrusters to port and starboard turn the craft"
    return [
        [replace(g, other_reading="").with_evidence(evidence) if g.is_used and g.is_open and g.frame == "enu" else g
         for g in part] for part in parts
    ]  # fmt: skip


def _has_open(parts: Parts, symbols: tuple[str, ...]) -> bool:
    return any(g.symbol in symbols and g.is_used and g.is_open and g.frame == "enu" for part in parts for g in part)


def _only(parts: Parts, symbols: tuple[str, ...]) -> Parts:
    return [[replace(g, is_used=g.is_used and g.symbol in symbols) for g in part] for part in parts]


def _fixes_only(parts: Parts) -> Parts:
    """The first latitude and longitude of the first source that has both."""
    result = _only(parts, ())
    for k, part in enumerate(parts):
        rows = [next((i for i, g in enumerate(part) if g.symbol == symbol), None) for symbol in _FIXES]
        if None not in rows:
            result[k] = [replace(g, is_used=i in rows) for i, g in enumerate(part)]
            break
    return result


def _distance(track: Record | None, fixes: Record) -> float:
    """The rms distance of a track from the fixes over the extent of these, wherever on the craft their antenna is."""
    if track is None:
        return np.inf
    start, stop = max(track.time[0], fixes.time[0]), min(track.time[-1], fixes.time[-1])
    common = (track.time >= start) & (track.time <= stop)
    if np.count_nonzero(common) < _LEAST_SAMPLES:
        return np.inf
    at_fixes = [np.interp(track.time[common], fixes.time, fixes[symbol]) for symbol in _POSITIONS]
    extent = math.hypot(*(float(np.std(fix)) for fix in at_fixes))
    distance = np.concatenate([fix - track[symbol][common] for fix, symbol in zip(at_fixes, _POSITIONS, strict=True)])
    places = _antenna_places(track["psi"][common] if "psi" in track else np.zeros(len(at_fixes[0])))
    return least_squares(places, distance)[1] * math.sqrt(2.0) / max(extent, np.finfo(float).tiny)


def _antenna_places(psi: Array) -> Array:
    """North and east, one below the other, of a metre north, east, forward and to starboard; shape (2 n, 4)."""
    one, none = np.ones_like(psi), np.zeros_like(psi)
    north = np.column_stack([one, none, np.cos(psi), -np.sin(psi)])
    return np.vstack([north, np.column_stack([none, one, np.sin(psi), np.cos(psi)])])


def _heading_misfit(record: Record | None) -> float:
    """The misfit of velocities with the derivative of position where the heading is as declared."""
    motion = None if record is None else recorded_motion(record)
    if motion is None or motion.path_length == 0.0:
        return np.inf
    return min(motion.misfit(convention) for convention in motion.conventions if convention.psi_factor == 1.0)


def _surer(misfits: dict[str, float]) -> tuple[str, float] | None:
    """The frame that fits where the other does not, with its misfit."""
    (best, misfit), (_, other) = sorted(misfits.items(), key=lambda item: item[1])
    return (best, misfit) if misfit < ACCEPTABLE_MISFIT and other > CERTAIN_RATIO * misfit else None


def _with_frame(parts: Parts, symbols: tuple[str, ...], frame: str, misfit: float, evidence: str) -> Parts:
    words = "x east, y north" if frame == "enu" else "x north, y east"

    def settled(guess: ColumnGuess) -> ColumnGuess:
        if not (guess.is_used and guess.symbol in symbols):
            return guess
        why = (guess.evidence[0], f"{words}: {misfit:.1%} misfit {evidence}")
        return replace(guess, frame=frame, other_reading="", evidence=why)

    return [[settled(g) for g in part] for part in parts]
