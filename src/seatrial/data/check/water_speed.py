"""The speed through the water and the current that velocities over ground on several courses show together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.motion import jackknife_least_squares, least_squares, smoothed, smoothed_derivative

_SMOOTHING_S = 3.0  # s over which velocities and yaw rate are smoothed; chosen: short against a turn
_FEWEST_ROWS = 60  # of all runs together, for a fit of some eight coefficients; chosen
_MOST_ROWS = 6000  # of all runs together that are fitted; chosen: some tenths of a second
_ROUNDS = 6  # of Gauss and Newton for one coefficient that is not linear; chosen
_LEAST_SHARE = 0.2  # of its speed that a craft keeps in any turn; chosen
_SPEED = 2  # place of the speed among the coefficients
_SEPARATE = 0.04  # of a speed, up to which its standard error separates a current from it; chosen
_ROUND = np.radians(300.0)  # sector of headings on which what a turn does to the craft averages out; chosen
_SEVERAL = np.radians(120.0)  # sector of headings that are several courses; chosen: a wide zigzag is none
_CLEAR, _LEAST_CURRENT = 4.0, 0.05  # standard errors and share of the speed from which on there is a current; chosen
_POWERS = (1, 2)  # of the speed with which resistance grows, that are tried; chosen
_ALIKE = 1.01  # of the least misfit, up to which another power fits alike: some nats of hundreds of samples; chosen
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
    def has_current(self) -> bool:
        """Whether a current shows beyond its error, and matters beside the speed."""
        return self.current > max(_CLEAR * self.current_error, _LEAST_CURRENT * self.speed)

    def agrees_with(self, other: "SpeedAndCurrent") -> bool:
        """Return whether the currents are one within their errors, or within what does not matter."""
        difference = float(np.hypot(self.north - other.north, self.east - other.east))
        error = float(np.hypot(self.current_error, other.current_error))
        return difference <= max(_CLEAR * error, _LEAST_CURRENT * max(self.speed, other.speed))


def speed_through_water(records: Sequence[Record]) -> SpeedAndCurrent | None:
    """Return the speed and the current that runs share, by least squares; None without headings and positions.

    Without positions u and v must be over ground.

    The velocity over ground is R(psi) [u, v] + current (Fossen 2021, section 10.3). A propeller that holds the speed U
    and a hull whose resistance grows with the square of the yaw rate, and with surge or its square, balance at
    u^k = U^k - c r^2, k 1 or 2 (the surge equation of Yasukawa & Yoshimura 2015, eq. (1), about a steady turn); r^2
    acts with a delay of its own. Power and delay are those of some that fit best. Sway follows the yaw rate and, as it
    lags behind, its derivative. Where both powers fit alike it is 1, to first order in what a turn does. Standard
    errors leave out one of eight stretches of the runs at a time.
    """
    tracks = [track for record in records if (track := _Track.from_record(record)) is not None]
    if not tracks or sum(len(track.c) for track in tracks) < _FEWEST_ROWS:
        return None
    every = 1 + sum(len(track.c) for track in tracks) // _MOST_ROWS
    laws = [
        min(
            (_linearised(tracks, seconds, power, every) for seconds in _TIMES_S), key=lambda law: least_squares(*law)[1]
        )
        for power in _POWERS
    ]
    misfits = [least_squares(*law)[1] for law in laws]
    best = next(law for law, misfit in zip(laws, misfits, strict=True) if misfit <= _ALIKE * min(misfits))
    values, errors = jackknife_least_squares(*best)
    return SpeedAndCurrent(
        float(values[_SPEED]), float(errors[_SPEED]), float(values[0]), float(values[1]),
        float(np.hypot(*errors[:2]) / np.sqrt(2.0)),
        _sector(np.concatenate([np.arctan2(track.s, track.c) for track in tracks])),
    )  # fmt: skip


def _linearised(tracks: Sequence["_Track"], seconds: float, power: int, every: int) -> tuple[Array, Array]:
    """Return features and target of the speed law about its best coefficients (Gauss-Newton)."""
    measured = np.concatenate([track.target(every) for track in tracks])

    def about(speed: float, loss: float) -> tuple[Array, Array]:
        parts = [
            track.features(seconds, power, place, len(tracks), every, speed, loss) for place, track in enumerate(tracks)
        ]
        table, known = (np.concatenate([part[i] for part in parts]) for i in range(2))
        return table, measured - known

    law = about(float(np.sqrt(2.0 * np.mean(measured**2))), 0.0)
    for _ in range(_ROUNDS):
        speed, loss = least_squares(*law)[0][_SPEED : _SPEED + 2].tolist()
        law = about(speed, loss)
    return law


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
        length = max(3, round(_SMOOTHING_S / record.dt)) | 1
        if len(record) < 4 * length:
            return None
        c, s = (smoothed(turned(record["psi"]), length) for turned in (np.cos, np.sin))
        rate = smoothed_derivative(np.unwrap(record["psi"]), record.dt, length)
        if "x0" in record:
            north, east = (smoothed_derivative(record[symbol], record.dt, length) for symbol in ("x0", "y0"))
        else:
            u, v = (smoothed(record[symbol], length) for symbol in ("u", "v"))
            north, east = c * u - s * v, s * u + c * v  # R(psi) [u, v], Fossen 2021, eq. (2.41)
        return cls(north, east, c, s, rate, record.dt)

    def target(self, every: int) -> Array:
        return np.stack([self.north, self.east], axis=1)[::every].ravel()

    def features(
        self, seconds: float, power: int, place: int, runs: int, every: int, speed: float, loss: float
    ) -> tuple[Array, Array]:
        """Return slopes of the velocity over ground by the coefficients, and what it has beside slopes times them.

        Coefficients: current north and east, speed U, loss c, two of sway, and for each run its speed at its start
        over U.
        """
        c, s, one, zero = self.c, self.s, np.ones(len(self.c)), np.zeros(len(self.c))
        from scipy.signal import lfilter

        kept = np.exp(-self.dt * np.arange(len(c)) / seconds) if seconds else zero
        share = 1.0 - np.exp(-self.dt / seconds) if seconds else 1.0
        turning = lfilter([share], [1.0, share - 1.0], self.rate**2)
        u = np.maximum(speed**power - loss * turning, (_LEAST_SHARE * speed) ** power) ** (1.0 / power)
        by_speed, by_loss = (speed / u) ** (power - 1), -turning / power * u ** (1.0 - power)
        beside = u - by_speed * speed - by_loss * loss
        starts = np.zeros((runs, len(c)))
        starts[place] = kept
        change = np.gradient(self.rate, self.dt)
        north = [one, zero, c * by_speed, c * by_loss, -s * self.rate, -s * change, *(c * starts)]
        east = [zero, one, s * by_speed, s * by_loss, c * self.rate, c * change, *(s * starts)]
        table = np.array([north, east]).transpose(2, 0, 1)[::every].reshape(-1, len(north))
        return table, np.stack([c * beside, s * beside], axis=1)[::every].ravel()
