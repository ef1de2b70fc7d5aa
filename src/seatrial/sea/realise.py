"""One sea out of a spectrum: harmonic lines with random phases, and what a ship meets of them."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from seatrial.hydro.excitation import Complex, Excitation
from seatrial.sea.encounter import encounter_frequency, speed_factor
from seatrial.sea.spectrum import Spectrum
from seatrial.values import Array, Channel, InputError, Kind, Provenance, Record, frozen

LINES = 30


@dataclass(frozen=True, eq=False)
class Lines:
    """Harmonics of a sea: elevation at the ship's origin Re sum amplitude exp(i omega_e t), metres up.

    Attributes:
        omega: rad/s, of the waves; amplitude: complex, m; direction: heading of the ship to each, rad; all (n,).
        U: m/s, the ship's speed.
    """

    omega: Array
    amplitude: Complex
    direction: Array
    U: float = 0.0

    @property
    def encounter(self) -> Array:
        """Signed frequencies of encounter, rad/s; negative where the ship overtakes the wave."""
        return encounter_frequency(self.omega, self.U, self.direction)

    def elevation(self, time: Array) -> Array:
        """Elevation [m] at the ship's origin at `time` [s]."""
        return harmonic_sum(self.encounter, self.amplitude, time)

    def forces(self, excitation: Excitation) -> Complex:
        """Complex amplitudes of F3 [N, up] and M5 [N m, bow down] of each line, (n, 2)."""
        F3, M5 = excitation.forces(self.omega, self.U, self.direction)
        return np.stack([F3, M5], axis=1) * self.amplitude[:, None]


def harmonic_sum(omega: Array, amplitude: Complex, time: Array) -> Array:
    """Re sum_k amplitude_k exp(i omega_k t), shape of `time`."""
    return (
        np.exp(1j * np.outer(time, omega)).real @ amplitude.real
        - np.exp(1j * np.outer(time, omega)).imag @ amplitude.imag
    )


class Spacing(Enum):
    """How lines lie in the band."""

    EQUAL_INTERVAL = "xi_k = sqrt(2 S(omega_k) d omega) at the middle of equal intervals (Qi et al. 2025, eq. (14))"
    EQUAL_ENERGY = "lines of one amplitude, each at the middle of its share of the energy"
    JITTERED = "the energy of equal intervals, each at a random place of its interval: the sea does not repeat"


def _drawn(
    spacing: Spacing, spectrum: Spectrum, band: tuple[float, float], count: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Frequencies and amplitudes."""
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


def _phases(rng: np.random.Generator, shape: int | tuple[int, ...]) -> Complex:
    return np.asarray(np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, shape)), dtype=np.complex128)


def realise(
    spectrum: Spectrum,
    U: float,
    beta: float,
    rng: np.random.Generator,
    *,
    count: int = LINES,
    spacing: Spacing = Spacing.EQUAL_INTERVAL,
    band: tuple[float, float] | None = None,
) -> Lines:
    """A long-crested sea of `count` lines with phases drawn uniformly; band in rad/s, 0.1 to 99 % of the energy.

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
    if share < 1e-6:
        raise InputError(
            f"the {spectrum.name} spectrum has no energy between {chosen[0]:g} and {chosen[1]:g} rad/s; "
            f"it peaks at {spectrum.modal_frequency:.3g} rad/s"
        )
    omega, height = _drawn(spacing, spectrum, chosen, count, rng)
    return Lines(omega, height * _phases(rng, count), np.full(count, float(beta)), U)


def short_crested(lines: Lines, rng: np.random.Generator, exponent: int = 1, directions: int = 9) -> Lines:
    """Every line spread by cos^2s about its heading, over +- 90 degrees, each part with a phase of its own.

    Weights integrate to one, so that the energy stays (ITTC 2002, directional spectra).

    Raises:
        InputError: exponent or number of directions is less than one.
    """
    if exponent < 1 or directions < 1:
        raise InputError("spreading needs an exponent and a number of directions of at least one")
    away = (np.arange(directions) + 0.5) / directions * np.pi - 0.5 * np.pi
    weight = np.cos(away) ** (2 * exponent)
    weight /= weight.sum()
    amplitude = np.abs(lines.amplitude)[:, None] * np.sqrt(weight)
    turned = amplitude * _phases(rng, amplitude.shape)
    heading = np.abs(np.arccos(np.cos(lines.direction[:, None] + away)))
    return Lines(np.repeat(lines.omega, directions), turned.ravel(), heading.ravel(), lines.U)


def refuse_above_nyquist(lines: Lines, dt: float) -> None:
    """Refuse a time step that cannot show all lines.

    Raises:
        InputError: which line is beyond half the sampling rate.
    """
    met = np.abs(lines.encounter)
    worst = int(np.argmax(met))
    if met[worst] > np.pi / dt:
        raise InputError(
            f"the wave of {lines.omega[worst]:.3g} rad/s is met at {met[worst]:.3g} rad/s, above the Nyquist frequency "
            f"{np.pi / dt:.3g} rad/s of a step of {dt:g} s; shorten the step or the band"
        )


def refuse_short(lines: Lines, duration: float) -> None:
    """Refuse a record that does not last one period of the slowest line.

    Raises:
        InputError: how long it would have to be.
    """
    slowest = float(np.min(np.abs(lines.encounter)))
    period = 2.0 * np.pi / max(slowest, 1e-12)
    if duration < period:
        raise InputError(
            f"the record of {duration:g} s is shorter than the longest period met, {period:.3g} s; record longer"
        )


def repetition_period(lines: Lines) -> float:
    """s after which the envelope of equally spaced lines repeats in beam seas, 2 pi / d omega."""
    return float(2.0 * np.pi / np.min(np.diff(np.sort(lines.omega))))


def wave_record(lines: Lines, time: NDArray[np.float64], excitation: Excitation | None = None) -> Record:
    """The sea as a planned record: zeta [m, up], and with an excitation F3 [N, up] and M5 [N m, bow down].

    Raises:
        InputError: the time step cannot show all lines.
    """
    refuse_above_nyquist(lines, float(time[1] - time[0]))
    channels = {"zeta": Channel.of("zeta", frozen(lines.elevation(time)))}
    if excitation is not None:
        amplitude = lines.forces(excitation)
        for j, symbol in enumerate(("F3", "M5")):
            channels[symbol] = Channel.of(symbol, frozen(harmonic_sum(lines.encounter, amplitude[:, j], time)))
    return Record("sea", frozen(time), channels, Kind.PLANNED, Provenance("sum of harmonics"))
