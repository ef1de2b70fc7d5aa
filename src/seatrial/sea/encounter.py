"""The sea as a moving ship meets it: omega_e = omega - omega^2 U cos(beta) / g, deep water.

beta: heading to the waves, rad, 0 following, pi head. In head and beam seas each frequency of encounter has one wave.
In following seas it may have three: q = U cos(beta) / g > 0, the frequency met rises to 1 / (4 q) at omega = 1 / (2 q),
falls to nothing at 1 / q, where the ship runs with the wave, and rises again with the waves that she overtakes.
"""

import math

import numpy as np

from seatrial.hydro.excitation import FASTEST, encounter_frequency
from seatrial.sea.spectrum import G, Spectrum
from seatrial.values import Array, InputError


def speed_factor(U: float, beta: float) -> float:
    """q = U cos(beta) / g, s/rad.

    Raises:
        InputError: speed [m/s] or heading [rad] is out of sense.
    """
    if not 0.0 <= U <= FASTEST:
        raise InputError(f"the ship speed must lie between 0 and {FASTEST:g} m/s, not {U:g}; is it in knots?")
    if not 0.0 <= beta <= math.pi + 1e-12:
        raise InputError(f"the heading to the waves must lie between 0 and pi rad, not {beta:g}; is it in degrees?")
    factor = U * math.cos(beta) / G
    return factor if abs(factor) > 1e-12 else 0.0


def waves_met(omega_e: float, U: float, beta: float) -> tuple[float, ...]:
    """The wave frequencies [rad/s] met at the frequency `omega_e` > 0 [rad/s], rising: one, in following seas up to 3.

    Raises:
        InputError: as `speed_factor`, or omega_e is not positive.
    """
    if not omega_e > 0.0:
        raise InputError(f"a frequency of encounter must be positive, not {omega_e:g} rad/s")
    q = speed_factor(U, beta)
    if q == 0.0:
        return (omega_e,)
    roots = []
    for sign in (1.0, -1.0):  # omega - q omega^2 = +- omega_e
        inside = 1.0 - 4.0 * q * sign * omega_e
        if inside >= 0.0:
            # the small root in the form that loses no digits
            roots += [2.0 * sign * omega_e / (1.0 + math.sqrt(inside)), (1.0 + math.sqrt(inside)) / (2.0 * q)]
    return tuple(sorted({w for w in roots if w > 0.0}))


def wave_of(omega_e: Array, U: float, beta: float) -> Array:
    """The one wave frequency of each frequency of encounter [rad/s], as a record of encounters must be read.

    Raises:
        InputError: in following seas one frequency has up to three waves, which no record of elevation tells apart.
    """
    q = speed_factor(U, beta)
    if q > 0.0:
        raise InputError(
            f"in following seas (heading {math.degrees(beta):.0f} deg at {U:.3g} m/s) one frequency of encounter has "
            "up to three waves, which a record of the elevation does not tell apart; give F3 and M5, or the sea's lines"
        )
    w = np.asarray(omega_e, dtype=np.float64)
    return 2.0 * w / (1.0 + np.sqrt(1.0 - 4.0 * q * w))


def encounter_density(spectrum: Spectrum, U: float, beta: float, edges: Array) -> Array:
    """Mean density over |omega_e| [m^2 s/rad] between neighbouring `edges` (rising, >= 0), shape (edges - 1,).

    The energy of a bin is that of the one to three intervals of waves that are met in it: no Jacobian, and so no
    singularity where waves run with the ship's speed; the sum over bins is the energy of the sea.
    """
    q = speed_factor(U, beta)
    below = np.zeros(len(edges))
    for i, edge in enumerate(edges):
        below[i] = _share_met_below(spectrum, float(edge), q)
    return spectrum.moment(0) * np.diff(below) / np.diff(edges)


def _share_met_below(spectrum: Spectrum, omega_e: float, q: float) -> float:
    """Share of the energy in waves with |omega - q omega^2| <= omega_e."""
    if q <= 0.0:
        upper = 2.0 * omega_e / (1.0 + math.sqrt(1.0 - 4.0 * q * omega_e))
        return float(spectrum.share_below(np.array([upper]))[0])
    overtaken = (1.0 + math.sqrt(1.0 + 4.0 * q * omega_e)) / (2.0 * q)
    if 4.0 * q * omega_e >= 1.0:
        return float(spectrum.share_below(np.array([overtaken]))[0])
    root = math.sqrt(1.0 - 4.0 * q * omega_e)
    short, long = 2.0 * omega_e / (1.0 + root), (1.0 + root) / (2.0 * q)
    shares = spectrum.share_below(np.array([short, long, overtaken]))
    return float(shares[0] + shares[2] - shares[1])


__all__ = ["encounter_density", "encounter_frequency", "speed_factor", "wave_of", "waves_met"]
