"""Bandwidths of position and heading: a grid within the limits, the front of error against thrust, the choice on it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.control.station.allocation import weights
from seatrial.control.station.craft import StationCraft
from seatrial.control.station.disturbances import DisturbanceSpectrum
from seatrial.control.station.station_loop import StationLoop, StationPoint, place_poles
from seatrial.core.results.station import StationFront, StationPrecision
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex

_POINTS, _ROUNDS = 9, 3  # of a grid to each side, and grids one after the other; chosen
_SLOWEST = 0.005  # least bandwidth over the largest, which is that of thrusters and dead time; chosen
_SAMPLES, _REACH = 200, 1e2  # frequencies of margins, how far they go beyond the bandwidths tried; chosen
_DELAY_SHARE = 1.0  # least delay margin over the dead time that the loop is tuned with, so that twice it is tolerated


def largest_bandwidth(craft: StationCraft, dead_time: float) -> float:
    """Return the largest bandwidth that is tried [rad/s]: that of thrusters and dead time [s]."""
    return 1.0 / (dead_time + float(craft.lags.max()))


def margin_frequencies(craft: StationCraft, dead_time: float) -> Array:
    """Return the frequencies [rad/s] on which margins of all bandwidths tried are taken."""
    top = largest_bandwidth(craft, dead_time)
    return np.geomspace(_SLOWEST * top / _REACH, top * _REACH, _SAMPLES)


@dataclass(frozen=True)
class StationLimits:
    """Largest Ms of each loop with the others closed, and of all together: the largest singular value of S."""

    Ms: float
    joint: float


@dataclass(frozen=True, eq=False)
class StationDesign:
    """What every candidate has: points it has to hold at, inverse (m, 3), dead time [s], limits, what disturbs.

    frequencies: of margins [rad/s], `margin_frequencies`.
    """

    points: tuple[StationPoint, ...]
    inverse: Array
    dead_time: float
    limits: StationLimits
    spectrum: DisturbanceSpectrum
    frequencies: Array

    @property
    def craft(self) -> StationCraft:
        """The craft, the same at all points."""
        return self.points[0].craft

    @property
    def fastest(self) -> float:
        """The largest bandwidth that is tried [rad/s]."""
        return largest_bandwidth(self.craft, self.dead_time)

    def loops(self, position: float, heading: float) -> tuple[StationLoop, ...]:
        """Return the loop of two bandwidths [rad/s] at each point."""
        craft = self.craft
        gains = place_poles(craft.inertia, craft.damping, np.array([position, position, heading]))
        slope = np.ones(len(craft.owner))
        return tuple(
            StationLoop(point, gains, self.inverse, self.dead_time, slope, self.frequencies) for point in self.points
        )

    def excess(self, loops: Sequence[StationLoop], enough: float = math.inf) -> float:
        """Return by which factor a loop is beyond its worst limit, over all points: Ms, joint Ms, delay margin.

        enough: a factor beyond which the points that follow are not looked at.
        """
        least, worst = (1.0 + _DELAY_SHARE) * self.dead_time, 0.0
        for loop in loops:
            delay = loop.tolerated_dead_time
            slack = least / delay if delay > 0.0 else math.inf
            peaks = loop.peaks()
            worst = max(worst, float(peaks[:3].max()) / self.limits.Ms, float(peaks[3]) / self.limits.joint, slack)
            if worst > enough:
                break
        return worst

    def precision(self, loops: Sequence[StationLoop]) -> StationPrecision:
        """Return rms of position, heading and thrust by linear theory, the mean of squares over the points."""
        squares = np.mean([self._squares(loop) for loop in loops], axis=0)
        position, heading, thrust = np.sqrt(squares).tolist()
        return StationPrecision(position, heading, thrust)

    def _squares(self, loop: StationLoop) -> Array:
        """Return mean squares (3,) at one point: integrals of the spectra through S."""
        w, shares = self.spectrum.omega, self.spectrum.shares
        by_force, by_water = loop.point.responses(w)
        pose = loop.sensitivity(w) @ np.concatenate([by_water, by_force], axis=2)
        thrust = loop.thrusts(w) @ pose / weights(self.craft)[:, None]
        squares, effort = _variances(pose, shares), _variances(thrust, shares)
        return np.array([squares[0] + squares[1], squares[2], effort.sum() / len(self.craft.thrusters)])


@dataclass(frozen=True, eq=False)
class ChosenBandwidth:
    """Bandwidths of position and heading [rad/s], their loop at each point, what it leaves, and the front."""

    position: float
    heading: float
    loops: tuple[StationLoop, ...]
    precision: StationPrecision
    front: StationFront


def choose_bandwidth(design: StationDesign) -> ChosenBandwidth:
    """Return the bandwidths of the least product of error and thrust within the limits, by grids about the best.

    The error is that of the ends of the hull. Along the front one per cent less of it costs less than one per cent of
    thrust up to there, and more beyond.

    Raises:
        InputError: no bandwidth keeps the limits.
    """
    ends = np.full(2, math.log(_SLOWEST * design.fastest)), np.full(2, math.log(design.fastest))
    (low, high), tried = ends, list[_Candidate]()
    best, winner = np.zeros(2), _Candidate(0.0, 0.0, math.inf)
    for _ in range(_ROUNDS):
        positions, headings = (np.exp(np.linspace(a, b, _POINTS)) for a, b in zip(low, high, strict=True))
        for place in np.stack(np.meshgrid(positions, headings), axis=-1).reshape(-1, 2).tolist():
            tried.append(_candidate(design, place[0], place[1], winner.rank[0]))
            winner = min(winner, tried[-1], key=lambda one: one.rank)
        best = np.log([winner.position, winner.heading])
        reach = (high - low) / (_POINTS - 1)
        low, high = np.maximum(best - reach, ends[0]), np.minimum(best + reach, ends[1])
    kept = [one for one in tried if one.excess <= 1.0]
    if not kept:
        _refuse(design, best)
    position, heading = np.exp(best).tolist()
    loops = design.loops(position, heading)
    rows = np.array([(one.position, one.heading, one.error, one.thrust) for one in kept])
    front = _front(rows, len(tried))
    return ChosenBandwidth(position, heading, loops, design.precision(loops), front)


def hull_error(craft: StationCraft, precision: StationPrecision) -> float:
    """Return the rms [m] of position and of what heading moves the ends of the hull."""
    return math.hypot(precision.position, craft.lever * precision.heading)


@dataclass(frozen=True)
class _Candidate:
    """Bandwidths [rad/s], by which factor they are beyond the limits, and what they leave where they are not."""

    position: float
    heading: float
    excess: float
    error: float = math.inf
    thrust: float = math.inf

    @property
    def rank(self) -> tuple[float, float]:
        return max(self.excess, 1.0), self.error * self.thrust


def _candidate(design: StationDesign, position: float, heading: float, enough: float) -> _Candidate:
    loops = design.loops(position, heading)
    excess = design.excess(loops, enough)
    if excess > 1.0:
        return _Candidate(position, heading, excess)
    precision = design.precision(loops)
    return _Candidate(position, heading, excess, hull_error(design.craft, precision), precision.thrust)


def _variances(response: Complex, shares: Complex) -> Array:
    """Return the variances (k,) of responses (n, k, 6) to disturbances of cross-covariances (n, 6, 6)."""
    return np.einsum("nij,njk,nik->i", response, shares, response.conj()).real


def _front(rows: Array, evaluations: int) -> StationFront:
    """Return those of the rows (n, 4) that no other beats in error and thrust, by error."""
    ordered = rows[np.lexsort((rows[:, 3], rows[:, 2]))]
    least = np.minimum.accumulate(ordered[:, 3])
    kept = ordered[np.concatenate([[True], ordered[1:, 3] < least[:-1]])]
    position, heading, error, thrust = (np.ascontiguousarray(column) for column in kept.T)
    return StationFront(position, heading, error, thrust, evaluations)


def _refuse(design: StationDesign, best: Array) -> None:
    position, heading = np.exp(best).tolist()
    loops = design.loops(position, heading)
    worst, limits = np.max([loop.peaks() for loop in loops], axis=0), design.limits
    delay = min(loop.tolerated_dead_time for loop in loops)
    raise InputError(
        f"station: no bandwidth keeps the limits in this current: at best Ms is {worst[:3].max():.3g} (allowed "
        f"{limits.Ms:g}), of all loops together {worst[3]:.3g} ({limits.joint:g}), and {delay:.3g} s of dead time are "
        f"tolerated ({(1.0 + _DELAY_SHARE) * design.dead_time:.3g} s required); give a slower current, allow more "
        "(limits.Ms, station.joint_Ms), or quicken thrusters and dead time"
    )
