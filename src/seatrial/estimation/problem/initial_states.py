"""The states with which segments begin, as they were measured: where a search starts."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.segments import Segments
from seatrial.physics.sensors.measured_outputs import is_late

_VELOCITIES, _TRACK = ("u", "v"), ("x0", "y0", "psi")
_SHARE = 0.25  # of a segment, through whose beginning a parabola is laid; chosen
_LEAST = 8  # samples of it at least; chosen


def measured_initial_states(data: Segments, starts: Sequence[str]) -> Array:
    """Return the states `starts` of each segment, (segments, len(starts)), SI: as first measured, zero if unmeasured.

    Velocities that nobody measured are those of the track, so that a craft under way does not begin at rest.
    """
    local = np.zeros((data.count, len(starts)))
    for m, state in enumerate(starts):
        channel = state.split("_")[0] if is_late(state) else state
        if channel in data.outputs:
            column = data.measured[:, data.outputs.index(channel)]
            for s, (a, b) in enumerate(pairwise(data.offsets)):
                good = np.flatnonzero(np.isfinite(column[a:b]))
                if len(good):
                    local[s, m] = column[a + good[0]]
    hidden = [name for name in _VELOCITIES if name in starts and name not in data.outputs]
    if not hidden or not set(_TRACK) <= set(data.outputs):
        return local
    north, east, psi = (data.measured[:, data.outputs.index(name)] for name in _TRACK)
    for s, (a, b) in enumerate(pairwise(data.offsets)):
        velocity = dict(zip(_VELOCITIES, start_velocity(north[a:b], east[a:b], psi[a:b], data.dt), strict=True))
        local[s, [starts.index(name) for name in hidden]] = [velocity[name] for name in hidden]
    return local


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
    c, s = math.cos(heading[0]), math.sin(heading[0])
    # Fossen 2021, eq. (2.41): velocities in the body's axes are R(psi)^T times those over ground
    return float(c * slope[0] + s * slope[1]), float(c * slope[1] - s * slope[0])
