"""Fourier transforms of the half-overlapping segments of a stretch of a record (Welch 1967, IEEE Trans. AU-15, 70)."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.problem.spectral_likelihood import WINDOW_CORRELATION, hann_transform
from seatrial.physics.hydro.excitation import Complex

# variance of the mean of half-overlapping Hann segments over that of as many independent ones, 1 + 2 (1/6)^2
# (Welch 1967, section on overlapping segments)
_OVERLAP_VARIANCE = 1.0 + 2.0 / 36.0
_FEWEST_SEGMENTS = 4  # from which a spread between segments says something; chosen


@dataclass(frozen=True, eq=False)
class StretchSpectra:
    """Transforms of m segments of c channels, scaled so that the mean of |transform|^2 is the one-sided density.

    Attributes:
        omega: (k,), rad/s, evenly spaced; transforms: (m, k, c).
    """

    omega: Array
    transforms: Complex

    @property
    def step(self) -> float:
        """Return the distance of two frequencies [rad/s]."""
        return float(self.omega[1] - self.omega[0])

    @property
    def information(self) -> float:
        """Return how many independent periodograms the mean of the segments is worth, at each frequency."""
        return len(self.transforms) / _OVERLAP_VARIANCE / WINDOW_CORRELATION

    def cross_density(self, first: int, second: int) -> Complex:
        """Return the mean over the segments of one channel times the conjugate of another, (k,)."""
        return np.mean(self.transforms[:, :, first] * self.transforms[:, :, second].conj(), axis=0)

    def band_limited(self, low: float, high: float) -> "StretchSpectra":
        """Return the same between two frequencies [rad/s]."""
        kept = (self.omega >= low) & (self.omega <= high)
        return replace(self, omega=self.omega[kept], transforms=self.transforms[:, kept])

    def strong_band(self, channel: int, share: float) -> "StretchSpectra":
        """Return the same on the band about the largest density of a channel where it is at least a share of that."""
        density = self.cross_density(channel, channel).real
        peak, weak = int(np.argmax(density)), np.flatnonzero(density < share * np.max(density))
        first = int(np.max(weak[weak < peak], initial=-1)) + 1
        last = int(np.min(weak[weak > peak], initial=len(density)))
        return replace(self, omega=self.omega[first:last], transforms=self.transforms[:, first:last])


def stretch_spectra(values: Array, dt: float, segment_s: float) -> StretchSpectra:
    """Return the transforms of the columns of values (n, c), every dt [s], in segments of `segment_s` [s].

    Raises:
        InputError: the values have gaps, or hold fewer than four segments.
    """
    count = round(segment_s / dt)
    starts = range(0, len(values) - count + 1, max(1, count // 2))
    if len(starts) < _FEWEST_SEGMENTS:
        shortest = 0.5 * (_FEWEST_SEGMENTS + 1) * segment_s
        raise InputError(f"a stretch of {len(values) * dt:.0f} s is too short for a spectrum; give {shortest:.0f} s")
    if not np.all(np.isfinite(values)):
        raise InputError("a stretch has gaps, which a spectrum cannot have; repair them")
    parts = [hann_transform(values[first : first + count], dt) for first in starts]
    return StretchSpectra(parts[0][0], np.array([transform for _, transform in parts]))
