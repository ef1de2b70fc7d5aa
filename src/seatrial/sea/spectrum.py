"""Wave spectra of one height and one period: S(omega) = A / omega^5 exp(-B / omega^4), peaked or not."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import gamma as gamma_function

from seatrial.values import Array, InputError

G = 9.81
ITTC_A = 8.1e-3
ITTC_B = 3.11
# from a thousandth of the peak's energy density to where the tail holds less than 1e-9 of the energy
_LOWEST, _HIGHEST, _POINTS = 0.2, 200.0, 40_001


@dataclass(frozen=True)
class Spectrum:
    """One-sided density over wave frequency, A / omega^5 exp(-B / omega^4) gamma^r (Bretschneider 1959; ITTC 1978).

    r = exp(-(omega - omega_p)^2 / (2 sigma^2 omega_p^2)), sigma = .07 below the peak, .09 above (JONSWAP, Hasselmann
    et al. 1973); gamma = 1 has no such peak.

    Attributes:
        A: m^2 rad^4/s^4; B: rad^4/s^4.
    """

    name: str
    A: float
    B: float
    gamma: float = 1.0

    @property
    def modal_frequency(self) -> float:
        """Of the largest density, (4 B / 5)^(1/4), rad/s."""
        return (0.8 * self.B) ** 0.25

    @property
    def significant_height(self) -> float:
        """4 sqrt(m0), m."""
        return 4.0 * math.sqrt(self.moment(0))

    def density(self, omega: Array) -> Array:
        """S [m^2 s/rad] at omega [rad/s]; zero where omega is not positive."""
        w = np.asarray(omega, dtype=np.float64)
        known = np.where(w > 0.0, w, 1.0)
        plain = self.A / known**5 * np.exp(-self.B / known**4)
        if self.gamma != 1.0:
            peak = self.modal_frequency
            sigma = np.where(known <= peak, 0.07, 0.09)
            plain = plain * self.gamma ** np.exp(-((known - peak) ** 2) / (2.0 * (sigma * peak) ** 2))
        return np.where(w > 0.0, plain, 0.0)

    def moment(self, order: int) -> float:
        """m_n = int omega^n S d omega [m^2 (rad/s)^n], n < 4: A B^(n/4 - 1) Gamma(1 - n/4) / 4 without a peak.

        Raises:
            InputError: the fourth moment of these spectra does not exist; cut the band instead.
        """
        if order >= 4:
            raise InputError(f"moment {order} of the {self.name} spectrum is infinite; bound the band of frequencies")
        if self.gamma == 1.0:
            return self.A / 4.0 * self.B ** (order / 4.0 - 1.0) * float(gamma_function(1.0 - order / 4.0))
        omega = self._grid
        tail = self.A * omega[-1] ** (order - 4) / (4 - order)
        return float(np.trapezoid(omega**order * self.density(omega), omega)) + tail

    @property
    def mean_period(self) -> float:
        """T_1 = 2 pi m0 / m1, s."""
        return 2.0 * math.pi * self.moment(0) / self.moment(1)

    @cached_property
    def _grid(self) -> Array:
        return self.modal_frequency * np.geomspace(_LOWEST, _HIGHEST, _POINTS)

    @cached_property
    def _share(self) -> Array:
        """Share of the energy below each frequency of the grid."""
        omega, s = self._grid, self.density(self._grid)
        summed = np.concatenate([[0.0], np.cumsum(0.5 * (s[1:] + s[:-1]) * np.diff(omega))])
        return summed / (summed[-1] + self.A / (4.0 * omega[-1] ** 4))

    def share_below(self, omega: Array) -> Array:
        """Share of the energy below omega [rad/s]."""
        w = np.asarray(omega, dtype=np.float64)
        if self.gamma == 1.0:
            return np.where(w > 0.0, np.exp(-self.B / np.where(w > 0.0, w, 1.0) ** 4), 0.0)
        return np.interp(w, self._grid, self._share, left=0.0)

    def frequency_of_share(self, share: Array) -> Array:
        """The inverse of `share_below`: omega [rad/s] below which that share of the energy lies, 0 < share < 1."""
        part = np.asarray(share, dtype=np.float64)
        if self.gamma == 1.0:
            return (self.B / -np.log(part)) ** 0.25
        return np.interp(part, self._share, self._grid)

    def band(self, lower: float = 0.001, upper: float = 0.99) -> tuple[float, float]:
        """Frequencies [rad/s] below which the shares `lower` and `upper` of the energy lie."""
        low, high = self.frequency_of_share(np.array([lower, upper]))
        return float(low), float(high)


def _positive(what: str, value: float, unit: str) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(f"{what} of a sea must be positive and finite, not {value:g} {unit}")
    return value


def ittc(height: float) -> Spectrum:
    """One-parameter ITTC spectrum: A = 8.1e-3 g^2, B = 3.11 / h^2 (Qi et al. 2025, eq. (13), its h^-3 mended).

    Raises:
        InputError: the significant height [m] is not positive.
    """
    h = _positive("the significant height", height, "m")
    return Spectrum("ITTC one-parameter", ITTC_A * G**2, ITTC_B / h**2)


def ittc_two_parameter(height: float, mean_period: float) -> Spectrum:
    """ITTC 1978: A = 173 h^2 / T_1^4, B = 691 / T_1^4, the constants exact: B = (2 pi / (Gamma(3/4) T_1))^4.

    Raises:
        InputError: the significant height [m] or mean period T_1 [s] is not positive.
    """
    h, period = _positive("the significant height", height, "m"), _positive("the mean period", mean_period, "s")
    B = (2.0 * math.pi / (float(gamma_function(0.75)) * period)) ** 4
    return Spectrum("ITTC two-parameter", h**2 * B / 4.0, B)


def bretschneider(height: float, peak_period: float) -> Spectrum:
    """B = 5/4 omega_p^4, A = B h^2 / 4 (Bretschneider 1959).

    Raises:
        InputError: the significant height [m] or peak period [s] is not positive.
    """
    h, period = _positive("the significant height", height, "m"), _positive("the peak period", peak_period, "s")
    B = 1.25 * (2.0 * math.pi / period) ** 4
    return Spectrum("Bretschneider", h**2 * B / 4.0, B)


def jonswap(height: float, peak_period: float, gamma: float = 3.3) -> Spectrum:
    """JONSWAP (Hasselmann et al. 1973), scaled so that 4 sqrt(m0) is the significant height.

    Raises:
        InputError: height [m] or peak period [s] is not positive, or gamma lies outside 1 to 20.
    """
    if not 1.0 <= gamma <= 20.0:
        raise InputError(f"the peak enhancement of a JONSWAP spectrum lies between 1 and 20, not {gamma:g}")
    plain = bretschneider(height, peak_period)
    raw = Spectrum("JONSWAP", plain.A, plain.B, gamma)
    return Spectrum("JONSWAP", plain.A * height**2 / (16.0 * raw.moment(0)), plain.B, gamma)
