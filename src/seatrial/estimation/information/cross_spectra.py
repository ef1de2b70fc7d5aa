"""Spectra and cross-spectra of an input and of outputs by averaged periodograms, and what they leave uncertain.

Welch 1967, IEEE Trans. Audio Electroacoust. 15, 70: segments of half overlap, their straight line taken off, a Hann
window. `scipy.signal` gives the same densities (tested) and would cost a second to import.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array

SIGNIFICANCE = 0.05
"""Probability with which the true response lies outside its region."""

ComplexValues = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class CrossSpectra:
    """One-sided densities over frequency, per rad/s.

    Attributes:
        omega: rad/s, (n,); averages: number of independent averages at each, (n,).
        input: density of the input, (n,); outputs: of each output, (n, ny).
        cross: of input and outputs, conj(U) Y, (n, ny).
    """

    omega: Array
    averages: Array
    input: Array
    outputs: Array
    cross: ComplexValues

    @property
    def response(self) -> ComplexValues:
        """Outputs over input, H1 (Bendat & Piersol 2010, section 9.3): unbiased by noise of the outputs, (n, ny)."""
        return self.cross / self.input[:, None]

    @property
    def coherence(self) -> Array:
        """Share of each output's power that is linear in the input, (n, ny)."""
        power = self.input[:, None] * self.outputs
        return np.divide(np.abs(self.cross) ** 2, power, out=np.zeros_like(power), where=power > 0.0)

    @property
    def radius(self) -> Array:
        """Radius of the circle about the response that holds the true one with 95 %, (n, ny).

        |H - G|^2 <= 2 / (v - 2) F(2, v - 2) (1 - coherence) Syy / Suu with v = 2 averages degrees of freedom (Jenkins &
        Watts 1968, section 10.3); the quantile of F(2, m) is m / 2 (0.05^(-2/m) - 1).
        """
        degrees = np.maximum(self.averages - 1.0, 0.0)
        with np.errstate(divide="ignore", over="ignore"):
            factor = SIGNIFICANCE ** (-1.0 / degrees) - 1.0
        residual = np.maximum(1.0 - self.coherence, 0.0) * self.outputs / self.input[:, None]
        with np.errstate(invalid="ignore"):
            return np.where(np.isfinite(factor)[:, None], np.sqrt(factor[:, None] * residual), np.inf)

    def banded(self, bands: int) -> "CrossSpectra":
        """Return means over about so many bands of equal width on a logarithmic scale, each one frequency or more."""
        edges = np.geomspace(self.omega[0], self.omega[-1] * (1.0 + _MARGIN), bands + 1)
        band = np.digitize(self.omega, edges)
        first = np.flatnonzero(np.diff(band, prepend=-1))
        size = np.diff(first, append=len(band))

        def mean(values: Array) -> Array:
            shape = (-1, *(1 for _ in values.shape[1:]))
            return np.add.reduceat(values, first, axis=0) / size.reshape(shape)

        cross = mean(self.cross.real) + 1j * mean(self.cross.imag)
        averages = mean(self.averages) * size / _shared_variance(size)
        return CrossSpectra(mean(self.omega), averages, mean(self.input), mean(self.outputs), cross)


_MARGIN = 1e-9
"""Share by which the last band reaches beyond the last frequency, so that this lies in it."""


_NEIGHBOURS = (4.0 / 9.0, 1.0 / 36.0)
"""Correlation of densities one and two frequencies apart: squares of 2/3 and 1/6 (Hann; Harris 1978, Proc. IEEE 66)."""

_OVERLAPPING = 1.0 / 36.0
"""Correlation of densities of two segments of half overlap: square of 1/6 (Hann; Welch 1967)."""


def _shared_variance(size: Array) -> Array:
    """Variance of the mean of neighbouring frequencies of a Hann window over that of independent ones."""
    once, twice = (np.maximum(1.0 - lag / size, 0.0) * share for lag, share in enumerate(_NEIGHBOURS, 1))
    return 1.0 + 2.0 * (once + twice)


def cross_spectra(pieces: Sequence[tuple[Array, Array]], length: int, dt: float) -> CrossSpectra | None:
    """Return the densities of an input and outputs over all segments of `length` samples; None where there is none.

    Left out are the two lowest frequencies, from which the straight line taken off each segment takes power, and the
    highest.

    Args:
        pieces: input (rows,) and outputs (rows, ny) of each run; segments with NaN are left out.
        length: of a segment, samples; dt: s.
    """
    window = np.hanning(length + 1)[:-1]  # periodic, as scipy.signal's
    inner = slice(2, (length + 1) // 2)
    outputs = pieces[0][1].shape[1]
    power = np.zeros((length // 2 + 1, 1 + outputs))
    cross = np.zeros((length // 2 + 1, outputs), np.complex128)
    segments = []
    for u, y in pieces:
        values = np.column_stack([u, y])
        usable = [w for w in _half_overlapping(values, length) if np.isfinite(w).all()]
        segments.append(len(usable))
        for w in usable:
            f = np.fft.rfft(window[:, None] * _without_line(w), axis=0)
            power += np.abs(f) ** 2
            cross += np.conj(f[:, :1]) * f[:, 1:]
    if not any(segments):
        return None
    scale = dt / (np.pi * float(np.sum(window**2)) * sum(segments))
    omega = (2.0 * np.pi / (length * dt) * np.arange(length // 2 + 1)).astype(np.float64)
    averages = np.full(len(omega), sum(_independent(n) for n in segments if n))
    return CrossSpectra(
        omega[inner], averages[inner], scale * power[inner, 0], scale * power[inner, 1:], scale * cross[inner]
    )


def _half_overlapping(values: Array, length: int) -> Iterator[Array]:
    return (values[a : a + length] for a in range(0, len(values) - length + 1, length // 2))


def _independent(segments: int) -> float:
    """Independent segments that so many of half overlap are worth (Welch 1967)."""
    return segments / (1.0 + 2.0 * (1.0 - 1.0 / segments) * _OVERLAPPING)


def _without_line(values: Array) -> Array:
    """Columns without their mean and slope (least squares)."""
    place = np.linspace(-1.0, 1.0, len(values))
    return values - np.mean(values, axis=0) - np.outer(place, place @ values / (place @ place))
