"""What a linear ship does in a sea: spectra and statistics of motions from response amplitude operators.

Operators are complex amplitudes per metre of wave at wave frequencies omega; integrals run over omega, where a
following sea has no singularity, while derivatives in time go by the frequency of encounter.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from seatrial.sea.spectrum import G, Spectrum
from seatrial.values import Array, InputError

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Statistics:
    """Of one motion in a sea, SI: variance of the motion and of its rate, its velocity and acceleration.

    Attributes:
        m0, m2, m4: spectral moments over the frequency of encounter.
    """

    m0: float
    m2: float
    m4: float

    @property
    def rms(self) -> float:
        """sqrt(m0)."""
        return math.sqrt(self.m0)

    @property
    def significant(self) -> float:
        """Mean of the highest third of the amplitudes, 2 sqrt(m0) (narrow band; Longuet-Higgins 1952)."""
        return 2.0 * self.rms

    @property
    def acceleration(self) -> float:
        """rms of the second derivative."""
        return math.sqrt(self.m4)

    @property
    def zero_crossing_period(self) -> float:
        """Mean period between upward zero crossings, 2 pi sqrt(m0 / m2), s (Rice 1944)."""
        return 2.0 * math.pi * math.sqrt(self.m0 / self.m2)

    def exceedance(self, amplitude: float) -> float:
        """Probability that an amplitude exceeds this one, exp(-a^2 / (2 m0)) (Rayleigh; Longuet-Higgins 1952)."""
        return math.exp(-(amplitude**2) / (2.0 * self.m0))


def response_spectrum(spectrum: Spectrum, omega: Array, operator: Complex) -> Array:
    """|H|^2 S over the wave frequency, shape of `omega`."""
    return np.abs(operator) ** 2 * spectrum.density(omega)


def statistics(spectrum: Spectrum, omega: Array, omega_e: Array, operator: Complex) -> Statistics:
    """Statistics of the motion `operator`, all arrays (n,), rad/s; trapezoids over rising omega.

    Raises:
        InputError: omega does not rise, or the sea has no energy between its ends.
    """
    if len(omega) < 2 or np.any(np.diff(omega) <= 0.0):
        raise InputError("wave frequencies of a response must rise")
    density = response_spectrum(spectrum, omega, operator)
    if np.trapezoid(spectrum.density(omega), omega) < 1e-3 * spectrum.moment(0):
        raise InputError(
            f"the sea has no energy between {omega[0]:.3g} and {omega[-1]:.3g} rad/s; it peaks at "
            f"{spectrum.modal_frequency:.3g} rad/s"
        )
    m0, m2, m4 = (float(np.trapezoid(omega_e**n * density, omega)) for n in (0, 2, 4))
    return Statistics(m0, m2, m4)


def vertical_motion(heave: Complex, pitch: Complex, x: float) -> Complex:
    """Upward motion at x [m, forward] from heave [up] and pitch [rad, bow down]: z - x theta."""
    return heave - x * pitch


def motion_sickness(motion: Statistics) -> float:
    """Share of people sick within two hours in a vertical motion, 0 to 1 (O'Hanlon & McCauley 1974; Lloyd 1989).

    Phi((log10(a / g) - mu) / .4), mu = -.819 + 2.32 log10(omega_e)^2, a = .798 sqrt(m4) the mean absolute acceleration,
    omega_e = sqrt(m4 / m2) its mean frequency.
    """
    if motion.m4 <= 0.0:
        return 0.0
    mean_absolute = 0.798 * motion.acceleration
    mu = -0.819 + 2.32 * math.log10(math.sqrt(motion.m4 / motion.m2)) ** 2
    return float(ndtr((math.log10(mean_absolute / G) - mu) / 0.4))
