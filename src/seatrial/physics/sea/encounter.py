"""The sea as a moving ship meets it, in deep water: omega_e = omega - q omega^2, q = U cos(beta) / g.

In head and beam seas every frequency of encounter belongs to one wave. In following seas (q > 0) omega_e rises to
1 / (4 q) at omega = 1 / (2 q), falls to zero at 1 / q, where the wave keeps up with the ship, and then turns negative:
the ship overtakes. |omega_e| then belongs to three waves below 1 / (4 q) and to one above (Lloyd 1989, section 7.4).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED, Excitation
from seatrial.physics.sea.spectrum import Spectrum

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
