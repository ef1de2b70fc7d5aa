"""Speed terms of strip theory: coefficients and excitation at rest to those at forward speed, without a transom.

Salvesen, Tuck & Faltinsen 1970 (SNAME Transactions 78), heave and pitch, end terms left out. Time factor
exp(+i omega_e t), x forward, z up, pitch bow down. The signs were compared with two independent public programs
and with the coefficients of qi2025, which obey b35 = b0 + U a33, b53 = b0 - U a33. `A`, `B` have the shape (n, 2, 2),
heave first, at the frequencies of encounter (n,).
"""

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED, Complex


def coefficients_at_speed(A: Array, B: Array, omega_e: Array, U: float) -> tuple[Array, Array]:
    """Return added mass and damping at the speed U [m/s] from those at rest.

    A35 = A35_0 - U / omega_e^2 B33, A53 = A53_0 + U / omega_e^2 B33, A55 = A55_0 + U^2 / omega_e^2 A33,
    B35 = B35_0 + U A33, B53 = B53_0 - U A33, B55 = B55_0 + U^2 / omega_e^2 B33; A33 and B33 stay.

    Raises:
        InputError: a frequency of encounter is zero, shapes do not agree, a number is not finite, or the speed is out
            of sense.
    """
    more_A, more_B = _speed_terms(A, B, omega_e, U)
    return A + more_A, B + more_B


def excitation_at_speed(
    froude_krylov: Complex, diffraction: Complex, omega: Array, omega_e: Array, U: float
) -> Complex:
    """Return excitation (n, 2) at the speed U from its two parts (n, 2) at rest, at the wave frequencies `omega`.

    The diffraction of a section is proportional to omega omega_e there, so that at rest is taken omega_e / omega
    times, and the moment gains -U / (i omega_e) F3_D = i U / omega F3_D. With `coefficients_at_speed` a hull in
    a long wave then moves with it at any speed. Omega_e / omega times is exact for the part in phase with the water's
    acceleration; a part in phase with its velocity should not be scaled, but cannot be separated in a total.

    Raises:
        InputError: shapes do not agree or a frequency is not positive.
    """
    if np.shape(froude_krylov) != np.shape(diffraction) or np.shape(diffraction) != (*np.shape(omega), 2):
        raise InputError(
            f"Froude-Krylov force {np.shape(froude_krylov)} and diffraction {np.shape(diffraction)} must both have two "
            f"columns for the {np.size(omega)} wave frequencies"
        )
    if not np.all(omega > 0.0):
        raise InputError("wave frequencies must be positive [rad/s]")
    scattered = diffraction * (omega_e / omega)[:, None]
    convected = 1j * U / omega * diffraction[:, 0]
    return froude_krylov + scattered + np.column_stack([np.zeros(omega.size), convected])


def _speed_terms(A: Array, B: Array, omega_e: Array, U: float) -> tuple[Array, Array]:
    """Return what the speed adds to A and B; A33 and B33 are the same before and after."""
    n = np.size(omega_e)
    if np.shape(A) != (n, 2, 2) or np.shape(B) != (n, 2, 2):
        raise InputError(
            f"{n} frequencies of encounter need added mass and damping of the shape ({n}, 2, 2), not {np.shape(A)} and "
            f"{np.shape(B)}"
        )
    if not (np.all(np.isfinite(A)) and np.all(np.isfinite(B)) and np.all(np.isfinite(omega_e))):
        raise InputError("added mass, damping and frequencies of encounter must be finite; leave out NaN and infinity")
    if not (np.isfinite(U) and 0.0 <= U <= MAX_SHIP_SPEED):
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
    if np.any(omega_e == 0.0):
        raise InputError(
            "strip theory has no speed terms at a frequency of encounter of zero, where the ship runs with the wave; "
            "leave that wave out"
        )
    a33, b33, none = A[:, 0, 0], B[:, 0, 0], np.zeros(n)
    slow, square = U / omega_e**2, U**2 / omega_e**2
    more_A = np.array([[none, -slow * b33], [slow * b33, square * a33]])
    more_B = np.array([[none, U * a33], [-U * a33, square * b33]])
    return np.moveaxis(more_A, 2, 0), np.moveaxis(more_B, 2, 0)
