"""Wave spectra, the seas that states stand for, and their frequencies as a ship meets them."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED, Excitation, G

# Wave spectra of one height and one period: S(omega) = A / omega^5 exp(-B / omega^4), the peak raised or not.

SIGMA_BELOW, SIGMA_ABOVE = 0.07, 0.09  # peak widths of JONSWAP, Hasselmann et al. 1973
# beyond nine sigma the raised peak adds less than a rounding error
_PEAK_REACH = 9.0
_LOWEST_RATIO = 0.1  # of the modal frequency: exp(-1.25 / x^4) is zero below
_STEEPNESS = 1.25  # 5/4: B over the fourth power of the modal frequency, where S is largest
_BISECTIONS = 64  # halve an interval below rounding
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)  # 64 points of Gauss-Legendre quadrature; chosen


@dataclass(frozen=True)
class Spectrum:
    """One-sided density over wave frequency, A / omega^5 exp(-B / omega^4) gamma^r (Bretschneider 1959; ITTC 1978).

    r = exp(-(omega / omega_p - 1)^2 / (2 sigma^2)), sigma = 0.07 up to the peak and 0.09 above it (JONSWAP: Hasselmann
    et al. 1973); gamma = 1 leaves the peak alone. Made by `ittc`, `ittc_two_parameter`, `bretschneider`, `jonswap`.

    Attributes:
        A: m^2 rad^4/s^4; B: rad^4/s^4; gamma: 1.
    """

    name: str
    A: float
    B: float
    gamma: float = 1.0

    @property
    def modal_frequency(self) -> float:
        """Where the density is largest, (4 B / 5)^(1/4), rad/s."""
        return (0.8 * self.B) ** 0.25  # maximum of omega^-5 exp(-B / omega^4)

    @property
    def significant_height(self) -> float:
        """4 sqrt(m0), m; the constants of the one-parameter spectrum make it 1.0013 times the height put in."""
        return 4.0 * math.sqrt(self.moment(0))

    @property
    def mean_period(self) -> float:
        """T1 = 2 pi m0 / m1, s."""
        return 2.0 * math.pi * self.moment(0) / self.moment(1)

    def with_height(self, height: float) -> "Spectrum":
        """Return the sea of that significant height [m] and the same steepness and shape: periods go with its root.

        Raises:
            InputError: the height is not positive.
        """
        ratio = _positive("significant height", height, "m") / self.significant_height
        return replace(self, B=self.B / ratio**2)

    def density(self, omega: ArrayLike) -> Array:
        """Return S [m^2 s/rad] at `omega` [rad/s], any shape; zero where omega is not positive."""
        x = np.asarray(omega, dtype=np.float64) / self.modal_frequency
        return np.asarray(self._base_density(x) * self._peak_factor(x), dtype=np.float64)

    def moment(self, n: float) -> float:
        """m_n = int omega^n S d omega [m^2 (rad/s)^n] = A B^(n/4 - 1) Gamma(1 - n/4) / 4, and what the peak adds.

        Raises:
            InputError: n is 4 or more, where the integral does not exist; bound the band instead.
        """
        if n >= 4:
            raise InputError(f"moment {n:g} of the {self.name} spectrum is infinite; take a band of frequencies")
        plain = self.A / 4.0 * self.B ** (n / 4.0 - 1.0) * _gamma(1.0 - n / 4.0)
        return plain + float(self._peak_excess(np.array(np.inf), n))

    def share_below(self, omega: ArrayLike) -> Array:
        """Return share of the energy below `omega` [rad/s], any shape: exp(-B / omega^4), and what the peak adds."""
        x = np.asarray(omega, dtype=np.float64) / self.modal_frequency
        plain = self.A / (4.0 * self.B) * np.exp(-_STEEPNESS / np.maximum(x, _LOWEST_RATIO) ** 4)
        return np.asarray((plain + self._peak_excess(x, 0.0)) / self.moment(0), dtype=np.float64)

    def energy_between(self, lower: ArrayLike, upper: ArrayLike) -> Array:
        """Return int S [m^2] from `lower` to `upper` [rad/s], shapes that go together."""
        return self.moment(0) * (self.share_below(upper) - self.share_below(lower))

    def frequency_of_share(self, share: ArrayLike) -> Array:
        """omega [rad/s] below which that share of the energy lies, any shape; by bisection where the peak is raised.

        Raises:
            InputError: a share does not lie between 0 and 1.
        """
        part = np.asarray(share, dtype=np.float64)
        if not np.all((part > 0.0) & (part < 1.0)):
            raise InputError("shares of a spectrum's energy must lie between 0 and 1, both excluded")
        plain = (self.B / -np.log(part)) ** 0.25
        if self.gamma == 1.0:
            return np.asarray(plain, dtype=np.float64)
        low, high = np.zeros_like(part), np.maximum(plain, 2.0 * self.modal_frequency)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            above = self.share_below(middle) > part
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return np.asarray(0.5 * (low + high), dtype=np.float64)

    def band(self, lower: float = 0.001, upper: float = 0.99) -> tuple[float, float]:  # shares of Qi et al. 2025
        """Return frequencies [rad/s] below which the shares `lower` and `upper` of the energy lie (Qi et al. 2025).

        Raises:
            InputError: as `frequency_of_share`, or the shares do not rise.
        """
        if not lower < upper:
            raise InputError(f"a band needs a lower share below its upper one, not {lower:g} and {upper:g}")
        first, last = self.frequency_of_share([lower, upper])
        return float(first), float(last)

    def _base_density(self, x: Array) -> Array:
        """Return the density without the raised peak at omega = x omega_p; exp(-1.25 / x^4) is zero below x = 0.1."""
        safe = np.maximum(x, _LOWEST_RATIO)
        return self.A / (safe * self.modal_frequency) ** 5 * np.exp(-_STEEPNESS / safe**4)

    def _peak_factor(self, x: Array) -> Array:
        sigma = np.where(x <= 1.0, SIGMA_BELOW, SIGMA_ABOVE)
        return self.gamma ** np.exp(-0.5 * ((x - 1.0) / sigma) ** 2)

    def _peak_excess(self, x: Array, n: float) -> Array:
        """int of omega^n S (1 - gamma^-r) up to x omega_p: Gauss-Legendre below and above the kink at the peak."""
        if self.gamma == 1.0:
            return np.zeros_like(x)
        added = np.zeros_like(x)
        for start, stop in ((1.0 - _PEAK_REACH * SIGMA_BELOW, 1.0), (1.0, 1.0 + _PEAK_REACH * SIGMA_ABOVE)):
            half = 0.5 * (np.clip(x, start, stop) - start)
            at = start + half[..., None] * (1.0 + _NODES)
            # nodes never touch the kink, so each side has its own sigma
            values = at**n * self._base_density(at) * (self._peak_factor(at) - 1.0)
            added = added + half * (values @ _WEIGHTS)
        return self.modal_frequency ** (n + 1.0) * added


def ittc(height: float) -> Spectrum:
    """One-parameter ITTC spectrum: A = 8.1e-3 g^2, B = 3.11 / h13^2 (Qi et al. 2025, eq. 13, its h^-3 corrected).

    Raises:
        InputError: the significant height [m] is not positive.
    """
    h = _positive("significant height", height, "m")
    return Spectrum("ITTC one-parameter", 8.1e-3 * G**2, 3.11 / h**2)


def ittc_two_parameter(height: float, mean_period: float) -> Spectrum:
    """ITTC 1978: A = 173 h13^2 / T1^4, B = 691 / T1^4, unrounded: B = (2 pi / (Gamma(3/4) T1))^4, A = B h13^2 / 4.

    Raises:
        InputError: the significant height [m] or the mean period T1 = 2 pi m0 / m1 [s] is not positive.
    """
    h, T1 = _positive("significant height", height, "m"), _positive("mean period", mean_period, "s")
    B = (2.0 * math.pi / (_gamma(0.75) * T1)) ** 4  # Gamma(3/4), as above
    return Spectrum("ITTC two-parameter", B * h**2 / 4.0, B)


def bretschneider(height: float, peak_period: float) -> Spectrum:
    """B = 5/4 omega_p^4, A = B h13^2 / 4, so that 4 sqrt(m0) = h13 (Bretschneider 1959; Pierson & Moskowitz 1964).

    Raises:
        InputError: the significant height [m] or the peak period [s] is not positive.
    """
    h, period = _positive("significant height", height, "m"), _positive("peak period", peak_period, "s")
    B = 1.25 * (2.0 * math.pi / period) ** 4  # maximum of omega^-5 exp(-B / omega^4)
    return Spectrum("Bretschneider", B * h**2 / 4.0, B)


# gamma 3.3: mean of JONSWAP, Hasselmann et al. 1973
def jonswap(height: float, peak_period: float, gamma: float = 3.3) -> Spectrum:
    """Return JONSWAP (Hasselmann et al. 1973), scaled so that 4 sqrt(m0) = height.

    Raises:
        InputError: the significant height [m] or the peak period [s] is not positive, or gamma is not from 1 to 20.
    """
    if not 1.0 <= gamma <= 20.0:  # the records of JONSWAP have 1 to 7; beyond 20 is a mistake
        raise InputError(f"the peak enhancement gamma of a JONSWAP spectrum lies from 1 to 20, not at {gamma:g}")
    raw = replace(bretschneider(height, peak_period), name="JONSWAP", gamma=gamma)
    return replace(raw, A=raw.A * height**2 / (16.0 * raw.moment(0)))  # significant height is four standard deviations


def _positive(quantity: str, value: float, unit: str) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(f"the {quantity} of a sea must be positive, not {value:g} {unit}")
    return value


def _gamma(x: float) -> float:
    from scipy.special import gamma

    return float(gamma(x))


# The sea as a moving ship meets it, in deep water: omega_e = omega - q omega^2, q = U cos(beta) / g.

# |cos(beta)| below which the sea is from abeam, -: cos(pi / 2) is 6e-17 by rounding
_BEAM_TOLERANCE = 1e-12


@dataclass(frozen=True)
class WaveEncounter:
    """The encounter of a run with waves: ship speed [m/s], heading [rad, 0 following, pi head], excitation.

    `spectrum`: of the sea, where its elevation was not recorded.
    """

    excitation: Excitation
    U: float
    beta: float
    spectrum: Spectrum | None = None


def speed_factor(U: float, beta: float) -> float:
    """Return q = U cos(beta) / g [s/rad]; exactly zero in beam seas.

    Args:
        U: ship speed, m/s.
        beta: heading to the waves, rad; 0 following, pi head.

    Raises:
        InputError: U is negative or above `MAX_SHIP_SPEED`, or beta lies outside 0 to pi.
    """
    if not 0.0 <= U <= MAX_SHIP_SPEED:
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
    if not 0.0 <= beta <= math.pi:
        raise InputError(
            f"the heading to the waves must lie between 0 and pi rad (head), not {beta:g}; is it in degrees?"
        )
    cosine = math.cos(beta)
    return U * cosine / G if abs(cosine) > _BEAM_TOLERANCE else 0.0


def wave_frequency(omega_e: ArrayLike, U: float, beta: float) -> Array:
    """Return the wave frequency [rad/s] of each frequency of encounter [rad/s, >= 0] in head and beam seas, any shape.

    Raises:
        InputError: the sea is following, where up to three waves share one frequency of encounter; as `speed_factor`.
    """
    q = speed_factor(U, beta)
    if q > 0.0:
        raise InputError(
            f"at {math.degrees(beta):.0f} deg and {U:.3g} m/s up to three waves share one frequency of encounter, and "
            "an elevation recorded on board cannot separate them; give the waves themselves, or F3 and M5"
        )
    encountered = np.asarray(omega_e, dtype=np.float64)
    # the root of omega - q omega^2 = omega_e that vanishes with omega_e, free of cancellation
    return np.asarray(2.0 * encountered / (1.0 + np.sqrt(1.0 - 4.0 * q * encountered)), dtype=np.float64)


# Sea states by number: heights of the WMO code, and the periods that go with them on the open ocean.


@dataclass(frozen=True)
class SeaState:
    """One row of the table.

    Attributes:
        number: 0 to 9.
        name: in the words of the WMO.
        lowest, highest: range of the significant height, m; the last has no upper end.
        significant_height: typical, m; none where the range has no middle.
        modal_period: most probable peak period, s; none where waves are ripples.
    """

    number: int
    name: str
    lowest: float
    highest: float
    significant_height: float | None
    modal_period: float | None

    def spectrum(self) -> Spectrum:
        """Return the Bretschneider spectrum of the typical height and period.

        Raises:
            InputError: the state has no typical height or no typical period (0, 1, 9).
        """
        if self.significant_height is None or self.modal_period is None:
            raise InputError(
                f"sea state {self.number} ({self.name}) has no typical height and period; give a height and a period"
            )
        return bretschneider(self.significant_height, self.modal_period)


# Ranges and names: WMO code table 3700. Typical heights and modal periods: Bales 1983, open North Atlantic
# (a transcription was at hand, not the report), with one row for 0 and 1.
_STATES = (
    SeaState(0, "calm (glassy)", 0.0, 0.0, 0.0, None),
    SeaState(1, "calm (rippled)", 0.0, 0.1, 0.05, None),
    SeaState(2, "smooth (wavelets)", 0.1, 0.5, 0.3, 7.5),
    SeaState(3, "slight", 0.5, 1.25, 0.88, 7.5),
    SeaState(4, "moderate", 1.25, 2.5, 1.88, 8.8),
    SeaState(5, "rough", 2.5, 4.0, 3.25, 9.7),
    SeaState(6, "very rough", 4.0, 6.0, 5.0, 12.4),
    SeaState(7, "high", 6.0, 9.0, 7.5, 15.0),
    SeaState(8, "very high", 9.0, 14.0, 11.5, 16.4),
    SeaState(9, "phenomenal", 14.0, float("inf"), None, 20.0),
)


def sea_state(number: int) -> SeaState:
    """Return the sea state of that number.

    Raises:
        InputError: the number is not one of 0 to 9.
    """
    if number not in range(len(_STATES)):
        raise InputError(f"there is no sea state {number}; sea states go from 0 to {len(_STATES) - 1}")
    return _STATES[number]
