"""Complex amplitudes at the wave frequency and its harmonics: least squares over whole periods, with covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Harmonics:
    """x(t) = sum over h of Re(amplitudes[h] exp(i orders[h] omega t)) + mean and trend + noise.

    Attributes:
        orders: (h,) multiples of the frequency.
        amplitudes: (h,) complex, phase at t = 0 of the record's own clock.
        covariance: (2h, 2h) of (real parts, imaginary parts), white noise of the residual's size.
        noise: standard deviation of the residual.
    """

    orders: tuple[int, ...]
    amplitudes: Complex
    covariance: Array
    noise: float

    @property
    def first(self) -> complex:
        """Return the amplitude at the wave frequency."""
        return complex(self.amplitudes[self.orders.index(1)])

    @property
    def relative_error(self) -> float:
        """Standard error of the first amplitude (root of half the sum of both variances) over its modulus."""
        k, h = self.orders.index(1), len(self.orders)
        variance = 0.5 * (self.covariance[k, k] + self.covariance[h + k, h + k])
        return float(np.sqrt(variance) / abs(self.first)) if self.first else float("inf")


def harmonics(time: Array, values: Array, omega: float, orders: Sequence[int] = (1, 2, 3)) -> Harmonics:
    """Least squares on cosines, sines, mean and trend; with white noise the Cramer-Rao bound 2 sigma^2 / n is met.

    Args:
        time, values: shape (n,), one steady stretch.
        omega: rad/s, of order 1.

    Raises:
        InputError: order 1 missing, less than one period, a harmonic above the Nyquist frequency, or NaN values.
    """
    made = tuple(orders)
    if 1 not in made:
        raise InputError("harmonics need order 1, the wave frequency itself")
    if not np.all(np.isfinite(values)):
        raise InputError("a channel holds NaN where harmonics are wanted; repair or leave out the record")
    count, highest = len(time), max(made)
    if count < 2 * len(made) + 3 or omega * (time[-1] - time[0]) < 0.95 * 2.0 * np.pi:
        raise InputError(f"{count} samples are less than one wave period of {2.0 * np.pi / omega:.3f} s; take more")
    dt = float(time[-1] - time[0]) / (count - 1)
    if highest * omega * dt > np.pi:
        raise InputError(f"harmonic {highest} of {omega:.3f} rad/s lies above the Nyquist frequency; leave it out")
    phase = np.outer(time, omega * np.asarray(made, dtype=np.float64))
    centred = (time - time.mean()) / max(np.ptp(time), dt)
    features = np.column_stack([np.cos(phase), -np.sin(phase), np.ones(count), centred])
    solved = np.linalg.lstsq(features, values, rcond=None)[0]
    residual = values - features @ solved
    variance = float(residual @ residual) / (count - features.shape[1])
    size = len(made)
    covariance = variance * np.linalg.inv(features.T @ features)[: 2 * size, : 2 * size]
    return Harmonics(made, solved[:size] + 1j * solved[size : 2 * size], covariance, float(np.sqrt(variance)))


def whole_periods(time: Array, start: float, stop: float, omega: float) -> slice:
    """Samples from `start` on that make up the most whole periods before `stop`.

    Raises:
        InputError: not one period lies between.
    """
    period = 2.0 * np.pi / omega
    first = int(np.searchsorted(time, start))
    count = int((min(stop, float(time[-1])) - start) / period)
    if count < 1:
        raise InputError(f"no whole wave period of {period:.3f} s lies between {start:.1f} and {stop:.1f} s")
    return slice(first, int(np.searchsorted(time, start + count * period)))


def best_fit_frequency(time: Array, values: Array, omega: float, relative_range: float = 0.02) -> float:
    """Return the frequency [rad/s] at which one harmonic fits best, within a share of `omega` to either side.

    Raises:
        InputError: as `harmonics`.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda w: harmonics(time, values, float(w), (1,)).noise,
        bounds=(omega * (1.0 - relative_range), omega * (1.0 + relative_range)),
        method="bounded",
        options={"xatol": 1e-6},
    )
    return float(found.x)
