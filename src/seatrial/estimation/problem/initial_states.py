"""The states with which segments begin, as they were measured: where a search starts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.core.values.arrays import Mask
from seatrial.physics.sensors.measured_outputs import is_late

if TYPE_CHECKING:
    from seatrial.estimation.problem.segments import Segments

_VELOCITIES, TRACK = ("u", "v"), ("x0", "y0", "psi")
_SHARE = 0.25  # of a segment, through whose beginning a parabola is laid; chosen
_LEAST = 8  # fixes of it at least; chosen
_PLACES = 60  # of a run by which its velocities vary; chosen
_FEWEST = 4  # fixes before the end of a segment, below which those behind it count as well; chosen
_FOR_PARABOLA = 5  # fixes, below which a straight line is laid; chosen: two more than it has coefficients


@dataclass(frozen=True, eq=False)
class Beginnings:
    """What a whole run says of the first rows of its segments.

    Attributes:
        values, value_sd: (segments, ny), outputs straight between readings, and how far readings are from such a line.
        velocity, velocity_sd: (segments, 2), surge and sway by the fixes nearest to them [m/s], and how they vary over
            the run; zero where no track is compared.
        is_thin: (segments,), whether the first quarter of a segment holds too few fixes for its velocity.
    """

    values: Array
    value_sd: Array
    velocity: Array
    velocity_sd: Array
    is_thin: Mask

    def selected(self, indices: Index) -> "Beginnings":
        """Return those of some segments."""
        return Beginnings(*(getattr(self, field.name)[indices] for field in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence["Beginnings"]) -> "Beginnings":
        """Return those of several runs, one after the other."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))

    @classmethod
    def of_run(
        cls, measured: Array, outputs: Sequence[str], dt: float, bounds: Sequence[tuple[int, int]]
    ) -> "Beginnings":
        """Return those of a run.

        Args:
            measured: outputs (n, ny), NaN where nothing was measured.
            dt: s.
            bounds: first row of each segment and row behind its last.
        """
        rows = [first for first, _ in bounds]
        values, spread = np.full((len(bounds), len(outputs)), np.nan), np.full(len(outputs), np.nan)
        for column in range(len(outputs)):
            known = np.flatnonzero(np.isfinite(measured[:, column]))
            if known.size:
                values[:, column] = np.interp(rows, known, measured[known, column])
            if known.size > 2:
                spread[column] = np.sqrt(np.mean(np.diff(measured[known, column], 2) ** 2))
        count = len(bounds)
        velocity, deviation, is_thin = np.zeros((count, 2)), np.zeros(2), np.zeros(count, dtype=np.bool_)
        if set(TRACK) <= set(outputs):
            north, east, psi = (measured[:, outputs.index(name)] for name in TRACK)
            is_thin = np.array([not _has_fixes(north[a:b], east[a:b]) for a, b in bounds], dtype=np.bool_)
            if is_thin.any():
                thin = [bound for bound, is_one in zip(bounds, is_thin, strict=True) if is_one]
                velocity[is_thin] = nearest_velocity(north, east, psi, dt, thin)
                places = np.linspace(0, len(north) - 1, _PLACES).astype(int).tolist()
                everywhere = nearest_velocity(north, east, psi, dt, [(k, len(north)) for k in places])
                deviation = np.std(everywhere, axis=0)
        return cls(values, np.tile(spread, (count, 1)), velocity, np.tile(deviation, (count, 1)), is_thin)


def _has_fixes(north: Array, east: Array) -> bool:
    """Whether the beginning of a track holds enough fixes for a velocity."""
    count = max(_LEAST, math.ceil(_SHARE * len(north)))
    return int(np.count_nonzero(np.isfinite(north[:count]) & np.isfinite(east[:count]))) >= _LEAST


def measured_initial_states(data: "Segments", starts: Sequence[str]) -> Array:
    """Return the states `starts` of each segment, (segments, len(starts)), SI: as first measured, zero if unmeasured.

    What was not read in the first row lies straight between the readings of the whole run. Velocities that nobody
    measured are those of the track, so that a craft under way does not begin at rest: of the segment's own beginning,
    or where that holds few fixes, of the fixes of the run that are nearest.
    """
    local = np.zeros((data.count, len(starts)))
    for m, state in enumerate(starts):
        channel = _channel_of(state)
        if channel in data.outputs:
            local[:, m] = np.nan_to_num(_first_values(data, data.outputs.index(channel)))
    hidden = [name for name in _VELOCITIES if name in starts and name not in data.outputs]
    if not hidden or not set(TRACK) <= set(data.outputs):
        return local
    north, east, psi = (data.measured[:, data.outputs.index(name)] for name in TRACK)
    for s, (a, b) in enumerate(pairwise(data.offsets)):
        if data.beginnings is not None and data.beginnings.is_thin[s]:
            surge, sway = data.beginnings.velocity[s]
        else:
            surge, sway = start_velocity(north[a:b], east[a:b], psi[a:b], data.dt)
        local[s, [starts.index(name) for name in hidden]] = [surge if name == "u" else sway for name in hidden]
    return local


def initial_state_weights(data: "Segments", starts: Sequence[str]) -> Array:
    """Return one over the variance of each initial state about what was measured, (segments, len(starts)); 0: unknown.

    Only of segments whose beginning holds too few fixes: there what the whole run shows stands in for them.
    """
    weights = np.zeros((data.count, len(starts)))
    known = data.beginnings
    if known is None or not known.is_thin.any():
        return weights
    for m, state in enumerate(starts):
        channel = _channel_of(state)
        if channel in data.outputs:
            is_unread = np.isnan(data.measured[data.offsets[:-1], data.outputs.index(channel)])
            spread = np.where(is_unread, known.value_sd[:, data.outputs.index(channel)], np.nan)
        elif state in _VELOCITIES:
            spread = known.velocity_sd[:, _VELOCITIES.index(state)]
        else:
            continue
        is_known = known.is_thin & np.isfinite(spread) & (spread > 0.0)
        weights[is_known, m] = spread[is_known] ** -2.0
    return weights


def _channel_of(state: str) -> str:
    return state.split("_")[0] if is_late(state) else state


def _first_values(data: "Segments", column: int) -> Array:
    """What was measured in the first row of each segment, else between the readings about it, (segments,)."""
    values = data.measured[:, column]
    first = np.array(values[data.offsets[:-1]])
    for s in np.flatnonzero(np.isnan(first)):
        first[s] = np.nan if data.beginnings is None else data.beginnings.values[s, column]
        if np.isnan(first[s]):
            good = values[data.offsets[s] : data.offsets[s + 1]]
            first[s] = next(iter(good[np.isfinite(good)]), np.nan)
    return first


def nearest_velocity(north: Array, east: Array, psi: Array, dt: float, bounds: Sequence[tuple[int, int]]) -> Array:
    """Return surge and sway [m/s] where each segment begins by the fixes of the run nearest to it, (segments, 2).

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
