"""The sea as a moving ship meets it, in deep water: omega_e = omega - q omega^2, q = U cos(beta) / g.

In head and beam seas every frequency of encounter has one wave. In following seas (q > 0) omega_e rises to 1 / (4 q)
at omega = 1 / (2 q), falls to zero at 1 / q, where the wave keeps up with the ship, and then turns negative: the ship
overtakes. A frequency felt, |omega_e|, then has three waves below 1 / (4 q) and one above (Lloyd 1989, section 7.4).
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED, encounter_frequency
from seatrial.physics.sea.spectrum import Spectrum

__all__ = ["encounter_density", "encounter_frequency", "speed_factor", "wave_frequency", "waves_at_encounter"]

_BEAM_TOLERANCE = 1e-12
# rad/s: ripples beyond this do not exist, and a ship so slow as to overtake nothing else stands still
_HIGHEST_FREQUENCY = 1e6


def speed_factor(U: float, beta: float) -> float:
    """q = U cos(beta) / g [s/rad]; zero in beam seas, where cos(pi / 2) leaves a rounding error.

    Raises:
        InputError: U [m/s] is negative or beyond any ship, or beta [rad] lies outside 0 to pi.
    """
    if not 0.0 <= U <= MAX_SHIP_SPEED:
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
    if not 0.0 <= beta <= math.pi:
        raise InputError(
            f"the heading to the waves must lie between 0 and pi rad (head), not {beta:g}; is it in degrees?"
        )
    cosine = math.cos(beta)
    return U * cosine / G if abs(cosine) > _BEAM_TOLERANCE else 0.0


def waves_at_encounter(omega_e: float, U: float, beta: float) -> tuple[float, ...]:
    """The wave frequencies [rad/s] met at |omega_e| = `omega_e` [rad/s], rising: one, in following seas up to three.

    Two only where |omega_e| is the turning point 1 / (4 q) itself.

    Raises:
        InputError: omega_e is not positive and finite, or as `speed_factor`.
    """
    if not (math.isfinite(omega_e) and omega_e > 0.0):
        raise InputError(f"a frequency of encounter must be positive, not {omega_e:g} rad/s")
    branches = _waves_by_branch(np.array([omega_e]), speed_factor(U, beta))
    return tuple(np.unique(np.concatenate(branches)).tolist())


def wave_frequency(omega_e: ArrayLike, U: float, beta: float) -> Array:
    """The one wave frequency [rad/s] of each frequency of encounter [rad/s, >= 0] in head and beam seas, any shape.

    Raises:
        InputError: following seas, where there may be three, or as `speed_factor`.
    """
    q = speed_factor(U, beta)
    if q > 0.0:
        raise InputError(
            f"at {math.degrees(beta):.0f} deg and {U:.3g} m/s one frequency of encounter has up to three waves, which "
            "a record of the elevation on board does not tell apart; give the waves themselves, or F3 and M5"
        )
    return _longest_wave(np.asarray(omega_e, dtype=np.float64), q)


def encounter_density(spectrum: Spectrum, U: float, beta: float, edges: ArrayLike) -> Array:
    """Mean density over |omega_e| [m^2 s/rad] between `edges` [rad/s], rising from 0 or more, shape (n + 1,) to (n,).

    The energy of a bin is that of all waves met in it, between the branch points; d omega / d omega_e, which is
    singular where omega_e turns, never appears, and the sum over bins keeps the energy of the sea.

    Raises:
        InputError: edges are fewer than two or do not rise from zero or more, or as `speed_factor`.
    """
    felt = np.asarray(edges, dtype=np.float64)
    if felt.ndim != 1 or felt.size < 2 or not (np.all(np.diff(felt) > 0.0) and felt[0] >= 0.0 and felt[-1] < np.inf):
        raise InputError("the edges of an encounter spectrum must be two or more frequencies rising from zero or more")
    return np.diff(_energy_within(spectrum, felt, speed_factor(U, beta))) / np.diff(felt)


def _energy_within(spectrum: Spectrum, omega_e: Array, q: float) -> Array:
    """Energy [m^2] of all waves with |omega - q omega^2| <= omega_e, shape of `omega_e`."""
    if q * _HIGHEST_FREQUENCY <= 1.0:
        return spectrum.energy_between(0.0, _longest_wave(omega_e, q))
    within = spectrum.energy_between(0.0, _overtaken_wave(omega_e, q))
    slow = 4.0 * q * omega_e < 1.0
    within[slow] -= spectrum.energy_between(_longest_wave(omega_e[slow], q), _middle_wave(omega_e[slow], q))
    return within


def _waves_by_branch(omega_e: Array, q: float) -> list[Array]:
    """Roots of |omega - q omega^2| = felt, branch by branch."""
    if q * _HIGHEST_FREQUENCY <= 1.0:
        return [_longest_wave(omega_e, q)]
    slow = omega_e[4.0 * q * omega_e <= 1.0]
    return [_longest_wave(slow, q), _middle_wave(slow, q), _overtaken_wave(omega_e, q)]


def _longest_wave(omega_e: Array, q: float) -> Array:
    """The longest wave: the root of omega - q omega^2 = felt that goes with felt to zero, free of cancellation."""
    return np.asarray(2.0 * omega_e / (1.0 + np.sqrt(np.maximum(1.0 - 4.0 * q * omega_e, 0.0))), dtype=np.float64)


def _middle_wave(omega_e: Array, q: float) -> Array:
    return (1.0 + np.sqrt(1.0 - 4.0 * q * omega_e)) / (2.0 * q)


def _overtaken_wave(omega_e: Array, q: float) -> Array:
    """The wave that the ship overtakes: omega - q omega^2 = -felt."""
    return (1.0 + np.sqrt(1.0 + 4.0 * q * omega_e)) / (2.0 * q)
