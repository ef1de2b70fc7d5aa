"""Signals of a record and its motion as declared: what the checks share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, Record

# Arithmetic the checks share: smoothed derivatives, robust size, integrals, jackknifed least squares, stretches.

RowIndices = NDArray[np.intp]
Mask = NDArray[np.bool_]
# variance of third differences of white noise over its own: 1 + 9 + 9 + 1
_THIRD_DIFFERENCES = 20.0
# stretches of a record left out in turn; chosen
JACKKNIFE_BLOCKS = 8


def window_length(count: int) -> int:
    """Odd length of the smoothing window: a sixtieth of the record, 11 to 150 samples, at most a quarter of it."""
    # chosen: short against a manoeuvre, in a log of many manoeuvres too
    return max(3, min(max(11, count // 60), 150, count // 4)) | 1


def smoothed(values: Array, length: int) -> Array:
    """Hann-weighted moving average, shape (n - length + 1,)."""
    weights = np.hanning(length + 2)[1:-1]
    return np.asarray(np.convolve(values, weights / weights.sum(), "valid"), dtype=np.float64)


def smoothed_derivative(values: Array, dt: float, length: int) -> Array:
    """Smoothed central differences, on the samples of `smoothed`."""
    return smoothed(np.gradient(values, dt), length)


def trimmed_rms(*components: Array) -> float:
    """Root mean square of a vector's length over the 95 % smallest: a few bad samples do not count."""
    kept = 0.95  # share of the samples; chosen
    squares = np.sum([c**2 for c in components], axis=0)
    count = max(1, int(kept * len(squares)))
    return float(np.sqrt(np.mean(np.partition(squares, count - 1)[:count])))


def cumulative_integral(rate: Array, dt: float) -> Array:
    """Trapezoidal integral from the first sample on, same shape."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * dt])


def sample_noise(values: Array) -> float:
    """Standard deviation of white noise on a signal, from third differences: their variance is 1 + 9 + 9 + 1 times its.

    What does not change within a few samples cancels (Gasser, Sroka & Jennen-Steinmetz 1986, Biometrika 73, 625-633).
    """
    return float(np.sqrt(np.nanmean(np.diff(values, 3) ** 2) / _THIRD_DIFFERENCES)) if len(values) > 3 else 0.0


def least_squares(features: Array, target: Array) -> tuple[Array, float]:
    """Least squares: coefficients and rms of the residual."""
    solution = np.asarray(np.linalg.lstsq(features, target, rcond=None)[0], dtype=np.float64)
    return solution, float(np.sqrt(np.mean((target - features @ solution) ** 2)))


def jackknife_least_squares(features: Array, target: Array) -> tuple[Array, Array]:
    """Least-squares coefficients with standard errors from leaving out one of eight blocks of rows at a time.

    Delete-one-block jackknife (Efron & Tibshirani 1993, eq. 11.5): honest where residuals are autocorrelated.
    """
    edges = np.linspace(0, len(target), JACKKNIFE_BLOCKS + 1).astype(int)
    keep = np.ones(len(target), dtype=bool)
    partial = []
    for first, last in pairwise(edges):
        keep[first:last] = False
        partial.append(least_squares(features[keep], target[keep])[0])
        keep[first:last] = True
    spread = np.array(partial) - np.mean(partial, axis=0)
    errors = np.sqrt((JACKKNIFE_BLOCKS - 1) / JACKKNIFE_BLOCKS * np.sum(spread**2, axis=0))
    return least_squares(features, target)[0], errors


def mask_intervals(mask: Mask) -> list[tuple[int, int]]:
    """First row and row after the last of every unbroken stretch of a mask, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


# Velocities, heading and position side by side, as declared: what the comparisons work on.

ComplexArray = NDArray[np.complex128]
DEGREES_PER_RADIAN = 180.0 / math.pi
# samples of a record from which on it is compared with itself; chosen: some windows of smoothing
MIN_SAMPLES = 30
# factor by which another convention must reduce the misfit to be possible; chosen
DOUBTFUL_RATIO = 1.5
# correlation of yaw rate and heading from which on their common sign counts; chosen
_TURNS_TOGETHER = 0.6


class PositionReading(StrEnum):
    """How x0 and y0 may have been written down."""

    DECLARED = "as declared"
    EXCHANGED = "exchanged"
    REVERSED_EAST = "y0 reversed"


@dataclass(frozen=True)
class VelocityConvention:
    """One way to read the columns of a motion; `changes` counts departures from the declared way.

    Attributes:
        frame: ``body`` or ``earth``.
        v_sign: factor on v.
        psi_factor: factor on psi (-1: the heading turns the other way; 57.3 or its inverse: wrong unit).
        changes: number of differences from the declaration, a yaw rate that then contradicts the heading among them.
        is_exchanged: whether u and v have changed places.
        psi_from_east: whether psi counts from east, counter-clockwise, as ROS has it.
        position: how x0 and y0 are read.
    """

    frame: str
    v_sign: float
    psi_factor: float
    changes: int
    is_exchanged: bool = False
    psi_from_east: bool = False
    position: PositionReading = PositionReading.DECLARED

    @property
    def reverses_turning(self) -> bool:
        """Whether the heading turns the other way than it was written down."""
        return self.psi_factor < 0 or self.psi_from_east


@dataclass(frozen=True)
class RecordedMotion:
    """A clean, evenly sampled record with x0, y0, psi, u and v, standard signs and unwrapped angles."""

    record: Record

    @property
    def frame(self) -> str:
        """Declared frame of u and v."""
        return self.record.channel("u").frame

    @property
    def reference_offset(self) -> float:
        """Distance by which the position's reference point lies ahead of the velocities' [m]."""
        return self.record.channel("x0").reference_point - self.record.channel("v").reference_point

    @property
    def window_samples(self) -> int:
        """Smoothing window in samples."""
        return window_length(len(self.record))

    @cached_property
    def position_derivative(self) -> tuple[Array, Array]:
        """Smoothed derivative of position, north and east [m/s]."""
        north, east = (smoothed_derivative(self.record[s], self.record.dt, self.window_samples) for s in ("x0", "y0"))
        return north, east

    @property
    def conventions(self) -> list[VelocityConvention]:
        """The declared reading first, then all others.

        Earth-fixed velocities do not show how the heading is written: it turns the lever between two points alone.
        """
        frames = (self.frame, "earth" if self.frame == "body" else "body")
        factors = (1.0, -1.0, DEGREES_PER_RADIAN, 1.0 / DEGREES_PER_RADIAN)
        return [VelocityConvention(frame, v_sign, factor, (frame != self.frame) + (v_sign < 0) + (factor != 1.0))
                for frame, v_sign, factor in product(frames, (1.0, -1.0), factors)
                if frame == "body" or factor == 1.0]  # fmt: skip

    def velocity(self, convention: VelocityConvention) -> tuple[Array, Array]:
        """Return the velocity of the position's reference point, north and east [m/s], as the reading has it."""
        u, v, psi = self.record["u"], convention.v_sign * self.record["v"], convention.psi_factor * self.record["psi"]
        c, s = np.cos(psi), np.sin(psi)
        north, east = (u * c - v * s, u * s + v * c) if convention.frame == "body" else (u, v)
        if self.reference_offset == 0.0:
            return north, east
        lever = self.reference_offset * np.gradient(psi, self.record.dt)
        return north - lever * s, east + lever * c

    @cached_property
    def readings(self) -> list[VelocityConvention]:
        """The declared reading first, then all others: those of `conventions` with exchanged and reversed axes."""
        axes = [
            replace(
                one, is_exchanged=exchanged, psi_from_east=from_east, position=position,
                changes=one.changes + exchanged + from_east + (position is not PositionReading.DECLARED),
            )
            for position, exchanged, from_east, one in product(
                PositionReading, (False, True), (False, True), self.conventions
            )
            if not (from_east and (one.psi_factor != 1.0 or one.frame == "earth"))
        ]  # fmt: skip
        return [replace(axis, changes=axis.changes + self._contradicts_yaw_rate(axis)) for axis in axes]

    def _contradicts_yaw_rate(self, reading: VelocityConvention) -> bool:
        return self.yaw_rate_sign == (1.0 if reading.reverses_turning else -1.0)

    @cached_property
    def yaw_rate_sign(self) -> float:
        """1 where r turns as psi does, -1 where it turns against it, 0 where neither is clear or r is missing."""
        if "r" not in self.record:
            return 0.0
        turning = smoothed_derivative(self.record["psi"], self.record.dt, self.window_samples)
        r = smoothed(self.record["r"], self.window_samples)
        size = float(np.sqrt(np.sum(turning**2) * np.sum(r**2)))
        match = float(np.sum(turning * r)) / size if size > 0 else 0.0
        return float(np.sign(match)) if abs(match) > _TURNS_TOGETHER else 0.0

    def smoothed_track_velocity(self, reading: VelocityConvention) -> ComplexArray:
        """Return the smoothed derivative of position as the reading has it, north + i east [m/s]."""
        north, east = self.position_derivative
        match reading.position:
            case PositionReading.EXCHANGED:
                return east + 1j * north
            case PositionReading.REVERSED_EAST:
                return north - 1j * east
            case _:
                return north + 1j * east

    def smoothed_velocity(self, reading: VelocityConvention) -> ComplexArray:
        """Return `velocity` smoothed, north + i east [m/s], on the samples of `position_derivative`."""
        surge, sway, lever = self._smoothed_parts(reading.frame, abs(reading.psi_factor))
        if reading.frame == "body" and reading.reverses_turning:
            surge, sway = np.conj(surge), np.conj(sway)
        if reading.reverses_turning:
            lever = -np.conj(lever)
        if reading.is_exchanged:
            surge, sway = sway, surge
        velocity = surge + 1j * (reading.v_sign * sway + lever)
        return np.asarray(1j * velocity if reading.psi_from_east else velocity, dtype=np.complex128)

    def _smoothed_parts(self, frame: str, psi_factor: float) -> tuple[ComplexArray, ...]:
        """u, v and the lever's velocity, turned by the heading where they are body-fixed, smoothed once."""
        if (frame, psi_factor) not in self._parts:
            turn: ComplexArray = np.exp(1j * psi_factor * self.record["psi"])
            axes = turn if frame == "body" else np.ones_like(turn)
            lever = self.reference_offset * np.gradient(self.record["psi"], self.record.dt)
            products = (axes * self.record["u"], axes * self.record["v"], turn * lever.astype(np.complex128))
            self._parts[frame, psi_factor] = tuple(_smoothed_complex(one, self.window_samples) for one in products)
        return self._parts[frame, psi_factor]

    @cached_property
    def _parts(self) -> dict[tuple[str, float], tuple[ComplexArray, ...]]:
        return {}

    def speed_scale(self, reading: VelocityConvention) -> float:
        """Return the least-squares factor from the reading's velocity to the position's."""
        velocity, track = self.smoothed_velocity(reading), self.smoothed_track_velocity(reading)
        power = float(np.sum(np.abs(velocity) ** 2))
        return float(np.sum((track * np.conj(velocity)).real)) / power if power > 0 else 0.0

    def misfit(self, reading: VelocityConvention) -> float:
        """Return the size of (derivative of position - scaled velocity) over the size of the derivative."""
        velocity, track = self.smoothed_velocity(reading), self.smoothed_track_velocity(reading)
        k = max(self.speed_scale(reading), 0.0)
        return trimmed_rms(np.abs(track - k * velocity)) / max(trimmed_rms(np.abs(track)), 1e-12)  # never a zero

    @property
    def noise_misfit(self) -> float:
        """Return the misfit that noise of the positions alone makes: of slopes over so many samples, by least squares.

        Variance 12 s^2 / (n^3 dt^2) for noise s at each of n samples (Draper & Smith 1998, eq. (1.4.5), evenly spaced).
        """
        noise = np.hypot(sample_noise(self.record["x0"]), sample_noise(self.record["y0"]))
        slope = noise * np.sqrt(12.0 / self.window_samples**3) / self.record.dt  # m/s, the formula above
        track = self.smoothed_track_velocity(self.readings[0])
        return float(slope / max(trimmed_rms(np.abs(track)), 1e-12))  # never a zero

    @cached_property
    def best_reading(self) -> VelocityConvention:
        """The reading that fits best; each further change must pay with a misfit smaller by half."""
        return self.best_of(self.readings)

    def best_of(self, readings: Sequence[VelocityConvention]) -> VelocityConvention:
        """Return the best of some readings, as `best_reading`."""
        least = 1e-6  # misfit below which readings are alike; chosen: rounding
        return min(readings, key=lambda r: max(self.misfit(r), least) * DOUBTFUL_RATIO**r.changes)

    @property
    def is_refuted(self) -> bool:
        """Whether another reading than the declared one fits best."""
        return self.best_reading is not self.readings[0]

    def heading_offset(self) -> tuple[float, float]:
        """Return the angle [rad] to be added to psi with which velocities fit the track best, and the misfit then."""
        declared = self.conventions[0]
        velocity, track = self.smoothed_velocity(declared), self.smoothed_track_velocity(declared)
        product, power = complex(np.sum(track * np.conj(velocity))), float(np.sum(np.abs(velocity) ** 2))
        factor = product / power if power > 0 else 0.0
        size = max(trimmed_rms(np.abs(track)), 1e-12)  # never a zero
        return float(np.angle(factor)), trimmed_rms(np.abs(track - factor * velocity)) / size

    @property
    def path_length(self) -> float:
        """Length of the smoothed track [m]."""
        return float(cumulative_integral(np.hypot(*self.position_derivative), self.record.dt)[-1])


def _smoothed_complex(values: ComplexArray, length: int) -> ComplexArray:
    return smoothed(values.real, length) + 1j * smoothed(values.imag, length)


def recorded_motion(record: Record) -> RecordedMotion | None:
    """Return the motion of a clean, evenly sampled, signed record; None where channels are missing or it is short."""
    if any(s not in record for s in ("x0", "y0", "psi", "u", "v")) or len(record) < MIN_SAMPLES:
        return None
    return RecordedMotion(record) if record.channel("u").frame == record.channel("v").frame else None
