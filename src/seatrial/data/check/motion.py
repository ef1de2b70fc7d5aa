"""Signals of a record and its motion as declared: what the checks share."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, Record
from seatrial.numerics.local_polynomials import white_variance
from seatrial.numerics.resolution import resolution

# Arithmetic the checks share: smoothed derivatives, robust size, integrals, jackknifed least squares, stretches.

RowIndices = NDArray[np.intp]
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
    """Standard deviation of white noise on a signal, by its third differences.

    Rounding is noise too, of a variance of a twelfth of the resolution squared (Widrow & Kollar 2008, section 1.4).
    """
    spread = math.sqrt(white_variance(values))
    uniform = float(np.sqrt(12.0))  # width over standard deviation of a uniform distribution
    return max(spread, resolution(values, least=spread * uniform) / uniform)


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


# Velocities, heading and position side by side, as declared: what the comparisons work on.

ComplexArray = NDArray[np.complex128]
# samples of a record from which on it is compared with itself; chosen: some windows of smoothing
MIN_SAMPLES = 30


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
    def velocity(self) -> tuple[Array, Array]:
        """The velocity of the position's reference point, north and east [m/s]."""
        u, v, psi = (self.record[s] for s in ("u", "v", "psi"))
        c, s = np.cos(psi), np.sin(psi)
        north, east = (u * c - v * s, u * s + v * c) if self.frame == "body" else (u, v)
        if self.reference_offset == 0.0:
            return north, east
        lever = self.reference_offset * np.gradient(psi, self.record.dt)
        return north - lever * s, east + lever * c

    @property
    def smoothed_velocities(self) -> tuple[ComplexArray, ComplexArray]:
        """Derivative of position and `velocity`, smoothed, north + i east [m/s]."""
        north, east = self.position_derivative
        ahead, aside = (smoothed(part, self.window_samples) for part in self.velocity)
        return north + 1j * east, ahead + 1j * aside

    @property
    def misfit(self) -> float:
        """The size of (derivative of position - velocity, scaled to fit) over that of the derivative."""
        track, velocity = self.smoothed_velocities
        power = float(np.sum(np.abs(velocity) ** 2))
        scale = max(float(np.sum((track * np.conj(velocity)).real)) / power, 0.0) if power > 0.0 else 0.0
        return trimmed_rms(np.abs(track - scale * velocity)) / max(trimmed_rms(np.abs(track)), 1e-12)  # never a zero

    @property
    def path_length(self) -> float:
        """Length of the smoothed track [m]."""
        return float(cumulative_integral(np.hypot(*self.position_derivative), self.record.dt)[-1])


def recorded_motion(record: Record) -> RecordedMotion | None:
    """Return the motion of a clean, evenly sampled, signed record; None where channels are missing or it is short."""
    if any(s not in record for s in ("x0", "y0", "psi", "u", "v")) or len(record) < MIN_SAMPLES:
        return None
    return RecordedMotion(record) if record.channel("u").frame == record.channel("v").frame else None
