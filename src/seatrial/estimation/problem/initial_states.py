"""The states with which segments begin, as they were measured: where a search starts."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.sensors.measured_outputs import is_late

if TYPE_CHECKING:
    from seatrial.estimation.problem.segments import Segments

_VELOCITIES, TRACK = ("u", "v"), ("x0", "y0", "psi")
_SHARE = 0.25  # of a segment, through whose beginning a parabola is laid; chosen
_LEAST = 8  # fixes of it at least; chosen
_FEWEST = 4  # fixes before the end of a segment, below which those behind it count as well; chosen
_FOR_PARABOLA = 5  # fixes, below which a straight line is laid; chosen: two more than it has coefficients


def measured_initial_states(data: "Segments", starts: Sequence[str]) -> Array:
    """Return the states `starts` of each segment, (segments, len(starts)), SI: as first measured, zero if unmeasured.

    What was not read in the first row lies straight between the readings of the whole run. Velocities that nobody
    measured are those of the track, so that a craft under way does not begin at rest: of the segment's own beginning,
    or where that holds few fixes, of the fixes of the run that are nearest.
    """
    local = np.zeros((data.count, len(starts)))
    for m, state in enumerate(starts):
        channel = state.split("_")[0] if is_late(state) else state
        if channel in data.outputs:
            local[:, m] = np.nan_to_num(_first_values(data, data.outputs.index(channel)))
    hidden = [name for name in _VELOCITIES if name in starts and name not in data.outputs]
    if not hidden or not set(TRACK) <= set(data.outputs):
        return local
    north, east, psi = (data.measured[:, data.outputs.index(name)] for name in TRACK)
    for s, (a, b) in enumerate(pairwise(data.offsets)):
        velocity = start_velocity(north[a:b], east[a:b], psi[a:b], data.dt)
        if velocity == (0.0, 0.0) and data.nearest_velocity is not None:
            velocity = (float(data.nearest_velocity[s, 0]), float(data.nearest_velocity[s, 1]))
        by_name = dict(zip(_VELOCITIES, velocity, strict=True))
        local[s, [starts.index(name) for name in hidden]] = [by_name[name] for name in hidden]
    return local


def _first_values(data: "Segments", column: int) -> Array:
    """What was measured in the first row of each segment, else between the readings about it, (segments,)."""
    values = data.measured[:, column]
    first = np.array(values[data.offsets[:-1]])
    for s in np.flatnonzero(np.isnan(first)):
        if data.between_readings is not None and np.isfinite(data.between_readings[s, column]):
            first[s] = data.between_readings[s, column]
            continue
        good = values[data.offsets[s] : data.offsets[s + 1]]
        good = good[np.isfinite(good)]
        first[s] = good[0] if len(good) else np.nan
    return first


def readings_about(measured: Array, rows: Sequence[int]) -> Array:
    """Return the outputs (n, ny) of a run at some rows, straight between their readings, (len(rows), ny)."""
    result = np.full((len(rows), measured.shape[1]), np.nan)
    for column in range(measured.shape[1]):
        known = np.flatnonzero(np.isfinite(measured[:, column]))
        if known.size:
            result[:, column] = np.interp(rows, known, measured[known, column])
    return result


def nearest_velocity(north: Array, east: Array, psi: Array, dt: float, bounds: Sequence[tuple[int, int]]) -> Array:
    """Return surge and sway [m/s] at the beginning of each segment by the fixes of the run nearest to it, (segments, 2).

    Those behind the end of a segment count where there are few before it; zero without two fixes.

    Args:
        north, east: positions [m], (n,), NaN where nothing was measured; psi: heading [rad], (n,).
        dt: s.
        bounds: first row of each segment and row behind its last.
    """
    known = np.flatnonzero(np.isfinite(north) & np.isfinite(east))
    headings = np.flatnonzero(np.isfinite(psi))
    result = np.zeros((len(bounds), 2))
    if len(known) < 2 or not len(headings):
        return result
    heading = np.interp([first for first, _ in bounds], headings, psi[headings])
    for s, (first, last) in enumerate(bounds):
        inside = known[known < last]
        usable = inside if len(inside) >= _FEWEST else known
        near = np.sort(usable[np.argsort(np.abs(usable - first), kind="stable")[:_LEAST]])
        track = np.stack([north[near], east[near]], axis=1)
        degree = 2 if len(near) >= _FOR_PARABOLA else 1
        slope = np.polynomial.polynomial.polyfit(dt * (near - first), track, degree)[1]
        result[s] = _in_body_axes(slope, float(heading[s]))
    return result


def _in_body_axes(slope: Array, heading: float) -> tuple[float, float]:
    c, s = math.cos(heading), math.sin(heading)
    # Fossen 2021, eq. (2.41): velocities in the body's axes are R(psi)^T times those over ground
    return float(c * slope[0] + s * slope[1]), float(c * slope[1] - s * slope[0])


def start_velocity(north: Array, east: Array, psi: Array, dt: float) -> tuple[float, float]:
    """Return surge and sway at the first sample [m/s] by parabolas through the beginning of a track; zero without one.

    Args:
        north, east: positions [m], (n,), NaN where nothing was measured.
        psi: heading [rad], (n,).
        dt: s.
    """
    count = max(_LEAST, math.ceil(_SHARE * len(north)))
    track = np.stack([north[:count], east[:count]], axis=1)
    is_measured = np.isfinite(track).all(axis=1)
    heading = psi[np.isfinite(psi)]
    if np.count_nonzero(is_measured) < _LEAST or not len(heading):
        return 0.0, 0.0
    slope = np.polynomial.polynomial.polyfit(dt * np.flatnonzero(is_measured), track[is_measured], 2)[1]
    return _in_body_axes(slope, float(heading[0]))
