"""One sea out of a spectrum: harmonic lines with random phases, and what a ship meets of them."""

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from seatrial.core.values import Array, Channel, Index, InputError, Provenance, Record, RecordKind, frozen
from seatrial.physics.hydro.excitation import Complex, Excitation, encounter_frequency
from seatrial.physics.sea.spectrum import Spectrum, speed_factor

DEFAULT_COMPONENTS = 30  # wave components of a realisation; chosen
_NO_ENERGY = 1e-6  # share of the sea's energy that counts as none; chosen


@dataclass(frozen=True, eq=False)
class WaveComponents:
    """Harmonics of a sea: elevation at the ship's origin Re sum amplitude exp(i omega_e t), metres up.

    Each line has a frequency of its own, so that its energy is |amplitude|^2 / 2 in every realisation; two lines of one
    frequency would stand in a fixed phase to one another (Jefferys 1987).

    Attributes:
        omega: rad/s, of the waves; amplitude: complex, m; direction: heading of the ship to each, rad; all (n,).
        U: m/s, the ship's speed.
    """

    omega: Array
    amplitude: Complex
    direction: Array
    U: float = 0.0

    @property
    def variance(self) -> float:
        """Of the elevation, sum |amplitude|^2 / 2, m^2."""
        return float(0.5 * np.sum(np.abs(self.amplitude) ** 2))

    @property
    def omega_e(self) -> Array:
        """Signed frequencies of encounter, rad/s; negative where the ship overtakes the wave."""
        return encounter_frequency(self.omega, self.U, self.direction)

    def elevation(self, time: Array) -> Array:
        """Return the elevation [m] at the ship's origin at `time` [s]."""
        return harmonic_sum(self.omega_e, self.amplitude, time)

    def forces(self, excitation: Excitation) -> Complex:
        """Return complex amplitudes of F3 [N, up] and M5 [N m, bow down] of each line, (n, 2)."""
        F3, M5 = excitation.forces(self.omega, self.U, self.direction)
        return np.stack([F3, M5], axis=1) * self.amplitude[:, None]


def harmonic_sum(omega: Array, amplitude: Complex, time: Array) -> Array:
    """Re sum_k amplitude_k exp(i omega_k t), shape of `time`; line by line, so that memory stays that of the record."""
    total = np.zeros(np.shape(time))
    for frequency, part in zip(omega, amplitude, strict=True):
        total += np.abs(part) * np.cos(frequency * time + np.angle(part))
    return total


class Spacing(Enum):
    """How lines lie in the band."""

    EQUAL_INTERVAL = "xi_k = sqrt(2 S(omega_k) d omega) at the middle of equal intervals (Qi et al. 2025, eq. (14))"
    EQUAL_ENERGY = "lines of one amplitude, each at the middle of its share of the energy"
    JITTERED = "the energy of equal intervals, each at a random place of its interval: the sea does not repeat"


def _frequencies_and_amplitudes(
    spacing: Spacing, spectrum: Spectrum, band: tuple[float, float], count: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return frequencies and amplitudes."""
    edges = np.linspace(*band, count + 1)
    match spacing:
        case Spacing.EQUAL_INTERVAL:
            omega = 0.5 * (edges[1:] + edges[:-1])
            return omega, np.sqrt(2.0 * spectrum.density(omega) * np.diff(edges))
        case Spacing.EQUAL_ENERGY:
            low, high = spectrum.share_below(np.array(band))
            shares = low + (np.arange(count) + 0.5) / count * (high - low)
            amplitude = math.sqrt(2.0 * spectrum.moment(0) * (high - low) / count)
            return spectrum.frequency_of_share(shares), np.full(count, amplitude)
        case Spacing.JITTERED:
            energy = spectrum.moment(0) * np.diff(spectrum.share_below(edges))
            return edges[:-1] + rng.uniform(size=count) * np.diff(edges), np.sqrt(2.0 * energy)


def _random_phases(rng: np.random.Generator, shape: int | tuple[int, ...]) -> Complex:
    return np.asarray(np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, shape)), dtype=np.complex128)


def realise(
    spectrum: Spectrum,
    U: float,
    beta: float,
    rng: np.random.Generator,
    *,
    count: int = DEFAULT_COMPONENTS,
    spacing: Spacing = Spacing.EQUAL_INTERVAL,
    band: tuple[float, float] | None = None,
) -> WaveComponents:
    """Return a long-crested sea of `count` lines with phases drawn uniformly; band in rad/s, 0.1 to 99 % of the energy.

    Raises:
        InputError: speed or heading out of sense, no line, a band upside down or without energy.
    """
    speed_factor(U, beta)
    chosen = spectrum.band() if band is None else band
    if count < 1:
        raise InputError(f"a sea needs at least one line, not {count}")
    if not 0.0 <= chosen[0] < chosen[1]:
        raise InputError(f"the band from {chosen[0]:g} to {chosen[1]:g} rad/s is empty; give lower before upper")
    share = float(np.diff(spectrum.share_below(np.array(chosen)))[0])
    if share < _NO_ENERGY:
        raise InputError(
            f"the {spectrum.name} spectrum has no energy between {chosen[0]:g} and {chosen[1]:g} rad/s; "
            f"it peaks at {spectrum.modal_frequency:.3g} rad/s"
        )
    omega, height = _frequencies_and_amplitudes(spacing, spectrum, chosen, count, rng)
    return WaveComponents(omega, height * _random_phases(rng, count), np.full(count, float(beta)), U)


def short_crested(components: WaveComponents, rng: np.random.Generator, exponent: float = 1.0) -> WaveComponents:
    """Return the lines spread about their heading by cos^2s over +- 90 deg, whose integral is one.

    D = Gamma(s + 1) / (sqrt(pi) Gamma(s + 1/2)) cos^2s(chi); s = 1 is the 2 / pi cos^2 of the ITTC (St. Denis & Pierson
    1953). Each line gets one direction: the middles of equal shares of D, shuffled, so that the energy stays in every
    realisation. Give some hundred lines.

    Raises:
        InputError: the exponent s is not positive.
    """
    if not exponent > 0.0:
        raise InputError(f"the spreading exponent s of a short-crested sea must be positive, not {exponent:g}")
    shares = rng.permutation((np.arange(len(components.omega)) + 0.5) / len(components.omega))
    heading = components.direction + spread_angle(shares, exponent)
    return replace(components, direction=np.arccos(np.cos(heading)))


def spread_angle(share: Array, exponent: float) -> Array:
    """chi [rad] from the main direction below which that share of cos^2s lies; sin^2 chi has a beta distribution."""
    from scipy.special import betaincinv

    sine = np.sqrt(betaincinv(0.5, exponent + 0.5, np.abs(2.0 * share - 1.0)))
    return np.sign(share - 0.5) * np.arcsin(sine)


def above_nyquist(components: WaveComponents, dt: float) -> Index:
    """Return which lines are met at more than half the sampling rate of a step of `dt` [s]."""
    return np.flatnonzero(np.abs(components.omega_e) > np.pi / dt)


def refuse_above_nyquist(components: WaveComponents, dt: float) -> None:
    """Refuse a time step that cannot show all lines."""
    beyond = above_nyquist(components, dt)
    if beyond.size:
        met = np.abs(components.omega_e)
        worst = int(np.argmax(met))
        count = "one line lies" if beyond.size == 1 else f"{beyond.size} lines lie"
        raise InputError(
            f"{count} above the Nyquist frequency {np.pi / dt:.3g} rad/s of a step of {dt:g} s: the wave of "
            f"{components.omega[worst]:.3g} rad/s is met at {met[worst]:.3g} rad/s; shorten the step or the band"
        )


def refuse_short_record(components: WaveComponents, duration: float) -> None:
    """Refuse a record that does not last one period of its longest wave, as met.

    In following seas shorter waves may run along with the ship for any time; no record can be required to hold them.
    """
    longest = int(np.argmin(components.omega))
    met = abs(float(components.omega_e[longest]))
    if duration * met < 2.0 * np.pi:
        needed = f"needs {2.0 * np.pi / met:.3g} s" if met > 0.0 else "runs along with the ship for ever"
        raise InputError(
            f"the record of {duration:g} s is too short for its longest wave: that of "
            f"{components.omega[longest]:.3g} rad/s {needed} to pass; record longer, or raise the lower end of the band"
        )


def wave_record(components: WaveComponents, time: Array, excitation: Excitation | None = None) -> Record:
    """Return the sea as a planned record: zeta [m, up], and with an excitation F3 [N, up] and M5 [N m, bow down].

    Raises:
        InputError: the time step cannot show all lines, or the time is too short for the longest wave.
    """
    plan = Record.from_arrays("sea", time, {"zeta": components.elevation(time)}, RecordKind.PLANNED)
    refuse_above_nyquist(components, plan.dt)
    refuse_short_record(components, plan.duration)
    channels = dict(plan.channels)
    if excitation is not None:
        for symbol, amplitude in zip(("F3", "M5"), components.forces(excitation).T, strict=True):
            force = harmonic_sum(components.omega_e, amplitude, time)
            channels[symbol] = Channel.from_notation(symbol, frozen(force))
    return replace(plan, channels=channels, provenance=Provenance("sum of harmonics"))
