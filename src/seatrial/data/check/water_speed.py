"""The speed through the water and the current that velocities over ground on several courses show together."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.motion import jackknife_least_squares, least_squares, smoothed, smoothed_derivative

# s over which velocities and yaw rate are smoothed, rad that a craft then turns at most; chosen: short against a turn
_SMOOTHING_S, _SMOOTHED_TURN = 3.0, 0.3
_FEWEST_ROWS = 60  # of all runs together, for a fit of some eight coefficients; chosen
_MOST_ROWS = 6000  # of all runs together that are fitted; chosen: some tenths of a second
_SPEED = 2  # place of the speed among the coefficients
_SEPARATE = 0.04  # of a speed, up to which its standard error separates a current from it; chosen
_ROUND = np.radians(300.0)  # sector of headings on which what a turn does to the craft averages out; chosen
_SEVERAL = np.radians(120.0)  # sector of headings that are several courses; chosen: a wide zigzag is none
_CLEAR, _LEAST_CURRENT = 4.0, 0.05  # standard errors and share of the speed from which on there is a current; chosen
_MEANS_S = (0.0, 6.0, 12.0, 24.0)  # s over which the yaw rate is taken, that are tried: waves yaw too; chosen
_TIMES_S = (0.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0)  # s in which a craft's speed recovers, that are tried; chosen


@dataclass(frozen=True)
class SpeedAndCurrent:
    """What fixes and headings of some runs show.

    Attributes:
        speed, speed_error: through the water when it has recovered from turns [m/s], and its standard error.
        north, east: the current [m/s]; current_error: standard error of each.
        courses: the sector that holds all headings [rad].
    """

    speed: float
    speed_error: float
    north: float
    east: float
    current_error: float
    courses: float

    @property
    def current(self) -> float:
        """m/s."""
        return float(np.hypot(self.north, self.east))

    @property
    def is_separate(self) -> bool:
        """Whether the courses of the runs separate the speed through the water from the current."""
        return self.courses >= _SEVERAL and self.speed_error <= _SEPARATE * self.speed

    @property
    def shows_current(self) -> bool:
        """Whether the courses of the runs separate the current from what the craft does: all round, or several."""
        return self.courses >= _ROUND or self.is_separate

    @property
    def least_current(self) -> float:
        """The least current that counts [m/s]: beyond its error, and a share of the speed."""
        return max(_CLEAR * self.current_error, _LEAST_CURRENT * self.speed)

    @property
    def has_current(self) -> bool:
        """Whether a current shows beyond its error, and matters beside the speed."""
        return self.current > self.least_current

    def agrees_with(self, other: "SpeedAndCurrent") -> bool:
        """Return whether the currents are one within their errors, or within what does not matter."""
        difference = float(np.hypot(self.north - other.north, self.east - other.east))
        error = float(np.hypot(self.current_error, other.current_error))
        return difference <= max(_CLEAR * error, _LEAST_CURRENT * max(self.speed, other.speed))


def speed_through_water(records: Sequence[Record]) -> SpeedAndCurrent | None:
    """Return the speed and the current that runs share, by least squares; None without headings and positions.

    Without positions u and v must be over ground.

    The velocity over ground is R(psi) [u, v] + current (Fossen 2021, section 10.3). A propeller that holds the speed U
    and a hull whose resistance grows with the square of the yaw rate balance at u = U - c r^2 + e r^4, to second order
    in what a turn does (the surge equation of Yasukawa & Yoshimura 2015, eq. (1), about a steady turn); r^2 acts with a
    delay of its own. Sway follows the yaw rate and, as it lags behind, its derivative. The delay, and the time over
    which a yaw rate is the craft's and not of waves, are those of some that fit best. Standard errors leave out one of
    eight stretches of the runs at a time.
    """
    tracks = [track for record in records if (track := _Track.from_record(record)) is not None]
    if not tracks or sum(len(track.c) for track in tracks) < _FEWEST_ROWS:
        return None
    every = 1 + sum(len(track.c) for track in tracks) // _MOST_ROWS
    target = np.concatenate([track.target(every) for track in tracks])
    tables = (_features(tracks, seconds, mean, every) for seconds, mean in product(_TIMES_S, _MEANS_S))
    best = min(tables, key=lambda table: least_squares(table, target)[1])
    values, errors = jackknife_least_squares(best, target)
    return SpeedAndCurrent(
        float(values[_SPEED]), float(errors[_SPEED]), float(values[0]), float(values[1]),
        float(np.hypot(*errors[:2]) / np.sqrt(2.0)),
        _sector(np.concatenate([np.arctan2(track.s, track.c) for track in tracks])),
    )  # fmt: skip


def _features(tracks: Sequence["_Track"], seconds: float, mean: float, every: int) -> Array:
    return np.concatenate(
        [track.features(seconds, mean, place, len(tracks), every) for place, track in enumerate(tracks)]
    )


def _sector(headings: Array) -> float:
    """The smallest sector [rad] that holds all headings."""
    sorted_ones = np.sort(headings % (2.0 * np.pi))
    gaps = np.diff(sorted_ones, append=sorted_ones[0] + 2.0 * np.pi)
    return float(2.0 * np.pi - np.max(gaps))


@dataclass(frozen=True, eq=False)
class _Track:
    """Smoothed velocity over ground [m/s], heading as cosine and sine, yaw rate [rad/s] of a run, each (n,)."""

    north: Array
    east: Array
    c: Array
    s: Array
    rate: Array
    dt: float

    @classmethod
    def from_record(cls, record: Record) -> "_Track | None":
        if "psi" not in record or not ({"x0", "y0"} <= set(record.channels) or {"u", "v"} <= set(record.channels)):
            return None
        length = cls._smoothing(record)
        if not length:
            return None
        c, s = (smoothed(turned(record["psi"]), length) for turned in (np.cos, np.sin))
        rate = smoothed_derivative(np.unwrap(record["psi"]), record.dt, length)
        if "x0" in record:
            north, east = (smoothed_derivative(record[symbol], record.dt, length) for symbol in ("x0", "y0"))
        else:
            u, v = (smoothed(record[symbol], length) for symbol in ("u", "v"))
            north, east = c * u - s * v, s * u + c * v  # R(psi) [u, v], Fossen 2021, eq. (2.41)
        return cls(north, east, c, s, rate, record.dt)

    @staticmethod
    def _smoothing(record: Record) -> int:
        """Return the samples of smoothing, fewer for a craft that turns fast; 0 for a run that is too short."""
        length = max(3, round(_SMOOTHING_S / record.dt)) | 1
        if len(record) < 4 * length:
            return 0
        fastest = float(np.max(np.abs(smoothed_derivative(np.unwrap(record["psi"]), record.dt, length))))
        return min(length, max(3, round(_SMOOTHED_TURN / max(fastest * record.dt, _SMOOTHED_TURN / length))) | 1)

    def target(self, every: int) -> Array:
        return np.stack([self.north, self.east], axis=1)[::every].ravel()

    def features(self, seconds: float, mean: float, place: int, runs: int, every: int) -> Array:
        """Return slopes of the velocity over ground by the coefficients.

        Coefficients: current north and east, speed U, losses by r^2 and r^4, two of sway, and for each run its speed at
        its start over U. seconds: in which speed recovers; mean: over which the yaw rate is taken.
        """
        from scipy.ndimage import uniform_filter1d
        from scipy.signal import lfilter

        c, s, one, zero = self.c, self.s, np.ones(len(self.c)), np.zeros(len(self.c))
        rate = uniform_filter1d(self.rate, round(mean / self.dt) | 1, mode="nearest")
        share = 1.0 - np.exp(-self.dt / seconds) if seconds else 1.0
        turning = lfilter([share], [1.0, share - 1.0], rate**2)
        starts = np.zeros((runs, len(c)))
        starts[place] = np.exp(-self.dt * np.arange(len(c)) / seconds) if seconds else zero
        change = np.gradient(rate, self.dt)
        surge = [one, turning, turning**2]
        north = [one, zero, *(c * part for part in surge), -s * rate, -s * change, *(c * starts)]
        east = [zero, one, *(s * part for part in surge), c * rate, c * change, *(s * starts)]
        return np.array([north, east]).transpose(2, 0, 1)[::every].reshape(-1, len(north))
