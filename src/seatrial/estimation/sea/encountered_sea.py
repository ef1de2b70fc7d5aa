"""A sea of unknown height, period and peak as the spectra of a moving ship show it.

The density of a motion at each frequency of a transform is a sum over the wave frequencies: response at the frequency
of encounter, effect of the waves, their density, and what the window shows of that frequency. No Jacobian of the
encounter appears, so that following seas, where three waves share one frequency of encounter, are as any other
(wave-buoy analogy: Nielsen 2006, Marine Structures 19, 33-69; Brodtkorb, Nielsen & Sorensen 2018, Applied Ocean
Research 73, 1-14).
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.spectral_likelihood import hann_leakage
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.loops import WaveEffect
from seatrial.physics.sea import Spectrum, bretschneider
from seatrial.physics.sea.spectrum import speed_factor

SEA_UNKNOWNS = ("height", "peak period", "peak")
"""What is unknown of a sea: logarithms of significant height [m] and peak period [s], and of gamma - 1."""

_WINDOW_POWER = 1.5  # mean of a Hann window's square over the square of its mean: the area under its leakage, in bins
_NODES_A_BIN = 3.0  # nodes over the wave frequency for each bin of the transform, at least; chosen
_LEAKAGE_BINS = 8.0  # bins beyond the band from which the window still shows power; chosen
_PLACES_A_BIN = 64  # at which leakage is tabulated: within 1 % of a node's own, either way; chosen
_KEPT = 8  # tables of leakage in memory; chosen
_LONGEST, _SHORTEST = 0.5, 4.0  # wave frequencies over the ends of the band that are looked at; chosen


@dataclass(frozen=True, eq=False)
class EncounteredSea:
    """Nodes over the wave frequency for one speed and heading.

    Attributes:
        omega: (n,), rad/s; omega_e: (n,), rad/s, the frequencies at which they are met; width: rad/s.
        effect_energy: (n,), |effect|^2 for each metre of wave; leakage: (k, n), s/rad, what each frequency of a
            transform shows of each node's energy.
    """

    omega: Array
    omega_e: Array
    width: float
    effect_energy: Array
    leakage: Array

    def disturbance_energy(self, sea: Array) -> Array:
        """Return each node's share of the variance of the disturbance, (n,), in the sea (3,) of `SEA_UNKNOWNS`."""
        return self.effect_energy * sea_spectrum(sea).density(self.omega) * self.width

    def density(self, sea: Array, power_gain: Array) -> Array:
        """Return the density of a motion as the transforms show it, (k,); power_gain: (n,), |response|^2 at omega_e."""
        return self.leakage @ (power_gain * self.disturbance_energy(sea))


def sea_spectrum(sea: Array) -> Spectrum:
    """Return the spectrum of the unknowns (3,): Bretschneider's with a peak raised as JONSWAP's."""
    height, period, peak = np.exp(sea).tolist()
    raw = replace(bretschneider(height, period), gamma=1.0 + peak)
    return replace(raw, A=raw.A * height**2 / (16.0 * raw.moment(0)))  # significant height is four standard deviations


def encountered_sea(bins: Array, U: float, beta: float, effect: WaveEffect) -> EncounteredSea:
    """Return the nodes for transforms at `bins` (k,) [rad/s], a ship of speed U [m/s], heading beta [rad, 0 following].

    Raises:
        InputError: speed or heading out of sense.
    """
    q, step = speed_factor(U, beta), float(bins[1] - bins[0])
    longest, shortest = effect.frequency_range
    lowest = max(_LONGEST * float(bins[0]), longest)
    highest = _highest_wave(float(bins[-1]) + _LEAKAGE_BINS * step, q)
    highest = min(highest, shortest, _SHORTEST * float(bins[-1]))
    steepest = max(abs(1.0 - 2.0 * q * lowest), abs(1.0 - 2.0 * q * highest))
    count = math.ceil(_NODES_A_BIN * max(steepest, 1.0) * (highest - lowest) / step)
    width = (highest - lowest) / count
    omega = np.asarray(lowest + width * (np.arange(count) + 0.5), dtype=np.float64)
    omega_e = np.abs(encounter_frequency(omega, U, beta))
    columns = _leakage_columns(len(bins))
    places = np.rint(((omega_e - bins[0]) / step + _LEAKAGE_BINS) * _PLACES_A_BIN).astype(int)
    is_near = (places >= 0) & (places < columns.shape[1])
    leakage = np.where(is_near, columns[:, np.where(is_near, places, 0)], 0.0) / step
    return EncounteredSea(omega, omega_e, width, np.abs(effect.amplitude(omega, U, beta)) ** 2, leakage)


@lru_cache(maxsize=_KEPT)
def _leakage_columns(count: int) -> Array:
    """Return what `count` bins show of energy at places from 8 bins below the first to 8 above the last, (count, p)."""
    width = round((count + 2.0 * _LEAKAGE_BINS - 1.0) * _PLACES_A_BIN) + 1
    places = np.arange(width) / _PLACES_A_BIN - _LEAKAGE_BINS
    return hann_leakage(np.arange(count)[:, None] - places) / _WINDOW_POWER


def _highest_wave(omega_e: float, q: float) -> float:
    """Return the highest wave frequency that is met at omega_e: the largest root of |omega - q omega^2| = omega_e."""
    if q > 0.0:
        return (1.0 + math.sqrt(1.0 + 4.0 * q * omega_e)) / (2.0 * q)
    return 2.0 * omega_e / (1.0 + math.sqrt(1.0 - 4.0 * q * omega_e))
