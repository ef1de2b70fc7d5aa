"""What a linear ship does in a sea: spectra and statistics of motions from response amplitude operators.

Operators are complex amplitudes per metre of wave at wave frequencies omega; integrals run over omega, where a
following sea has no singularity, while derivatives in time go by the frequency of encounter.
"""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex, G
from seatrial.physics.sea.spectrum import Spectrum

# least share of the sea's energy between the ends of a response, -; below it the response says nothing (our choice)
_LEAST_ENERGY = 1e-3


@dataclass(frozen=True)
class MotionStatistics:
    """Of one motion in a sea, SI.

    Attributes:
        m0, m2, m4: moments over the frequency of encounter: variances of the motion, its velocity, its acceleration.
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
        """Mean period between upward zero crossings, 2 pi sqrt(m0 / m2), s (Rice 1945); infinite without motion."""
        return 2.0 * math.pi * math.sqrt(self.m0 / self.m2) if self.m2 > 0.0 else math.inf

    def exceedance(self, amplitude: float) -> float:
        """Probability that an amplitude exceeds this one, exp(-a^2 / (2 m0)) (Rayleigh; Longuet-Higgins 1952)."""
        return math.exp(-(amplitude**2) / (2.0 * self.m0)) if self.m0 else 0.0

    def most_probable_maximum(self, duration: float) -> float:
        """Return most probable largest amplitude in `duration` [s], sqrt(2 m0 ln N), N = duration / T_z (same source).

        Raises:
            InputError: the duration holds no whole period.
        """
        count = duration / self.zero_crossing_period
        if not count > 1.0:
            raise InputError(
                f"{duration:g} s hold no whole period of {self.zero_crossing_period:.3g} s; ask for a longer time"
            )
        return math.sqrt(2.0 * self.m0 * math.log(count))


def response_spectrum(spectrum: Spectrum, omega: Array, operator: Complex) -> Array:
    """Return |H|^2 S over the wave frequency, shape of `omega`."""
    return np.abs(operator) ** 2 * spectrum.density(omega)


def motion_statistics(spectrum: Spectrum, omega: Array, omega_e: Array, operator: Complex) -> MotionStatistics:
    """Return statistics of the motion `operator`, all arrays (n,), rad/s; trapezoids over rising omega.

    Raises:
        InputError: omega does not rise, an operator is not finite, or the sea has no energy between the ends.
    """
    if len(omega) < 2 or np.any(np.diff(omega) <= 0.0):
        raise InputError("the wave frequencies of a response must be two or more, and rise")
    _require_finite(omega, operator)
    share = float(spectrum.energy_between(omega[0], omega[-1])) / spectrum.moment(0)
    resolved = float(np.trapezoid(spectrum.density(omega), omega)) / spectrum.moment(0)
    if min(share, resolved) < _LEAST_ENERGY:
        raise InputError(
            f"the sea has no energy between {omega[0]:.3g} and {omega[-1]:.3g} rad/s; it peaks at "
            f"{spectrum.modal_frequency:.3g} rad/s"
        )
    density = response_spectrum(spectrum, omega, operator)
    m0, m2, m4 = (float(np.trapezoid(omega_e**n * density, omega)) for n in (0, 2, 4))
    return MotionStatistics(m0, m2, m4)


def vertical_motion(heave: Complex, pitch: Complex, x: float) -> Complex:
    """Return the upward motion at x [m, forward of midship] from heave [up] and pitch [rad, bow down]: z - x theta."""
    return heave - x * pitch


def motion_sickness(motion: MotionStatistics) -> float:
    """Return share of people sick within two hours in a vertical motion, 0 to 1 (O'Hanlon & McCauley 1974; Lloyd 1989).

    Phi((log10(a / g) - mu) / 0.4), mu = -0.819 + 2.32 log10(omega_e)^2, a = 0.798 sqrt(m4) the mean absolute
    acceleration, omega_e = sqrt(m4 / m2) its mean frequency.
    """
    if motion.m4 <= 0.0:
        return 0.0
    mean_absolute = 0.798 * motion.acceleration  # sqrt(2 / pi): mean over r.m.s. of a Gaussian
    mu = -0.819 + 2.32 * math.log10(math.sqrt(motion.m4 / motion.m2)) ** 2  # O'Hanlon & McCauley 1974
    from scipy.special import ndtr

    return float(ndtr((math.log10(mean_absolute / G) - mu) / 0.4))  # standard deviation 0.4, O'Hanlon & McCauley 1974


def _require_finite(omega: Array, operator: Complex) -> None:
    if np.shape(operator) != np.shape(omega):
        raise InputError(
            f"give one operator for each of the {np.size(omega)} wave frequencies, not {np.size(operator)}"
        )
    broken = np.flatnonzero(~np.isfinite(operator))
    if broken.size:
        raise InputError(f"the response operator at {omega[broken[0]]:.4g} rad/s is not a finite number")
