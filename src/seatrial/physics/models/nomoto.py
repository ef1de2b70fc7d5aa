"""Steering models of Nomoto: first order, and second order with the zero of the rudder's transfer function.

Positive rudder turns to starboard (K > 0). Position follows at a constant speed U without drift, so that tracks of a
short manoeuvre can be compared; U = 0 leaves the position where it is.
"""

from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.forces import pose_rates

NOMOTO = "Nomoto et al. 1957, Int. Shipbuilding Progress 4(35), 354-370"
NORRBIN = "Norrbin 1963, cubic manoeuvring characteristic"
NOMOTO_SECOND_ORDER = "Nomoto et al. 1957, transfer function of second order, observer form"
CHOSEN_START = "start value, chosen"


def _speed(sheet: Sheet) -> sp.Symbol:
    meaning = "constant speed along the heading, also in turns; 0: position is not modelled"
    return sheet.parameter("U", 0.0, "m/s", meaning, scale=1.0)


def _rudder(sheet: Sheet) -> sp.Expr:
    delta = sheet.input("delta")
    return delta + sheet.parameter("delta_0", 0.0, "rad", "added to the recorded rudder angle", scale=0.02)


def _cubic(sheet: Sheet) -> sp.Symbol:
    meaning = "cubic coefficient, K delta = r + alpha r^3: the gain falls as the rudder goes farther over"
    scale = 100.0  # s^2/rad^2: (L/U)^2 of a ship of 60 m at 6 m/s, whose yaw rates are shares of U/L; chosen
    return sheet.parameter("alpha", 0.0, "s^2/rad^2", meaning, "linear unless freed", scale=scale)


@cache
def nomoto() -> Model:
    """Return the model of first order: T dr/dt + r + alpha r^3 = K (delta + delta_0).

    States r [rad/s], psi [rad], x0, y0 [m]; input delta [rad]. Free: K [1/s], T [s]; the cubic alpha is fixed at 0.
    """
    sheet = Sheet("nomoto", NOMOTO, "steering model of first order")
    r, psi, x0, y0 = sheet.states("r psi x0 y0")
    delta = _rudder(sheet)
    U = _speed(sheet)
    K = sheet.parameter("K", 0.1, "1/s", "gain", CHOSEN_START, free=True)  # start value, chosen
    T = sheet.parameter("T", 10.0, "s", "time constant", CHOSEN_START, free=True)
    alpha = _cubic(sheet)
    sheet.rate(r, (K * delta - r - alpha * r**3) / T, f"{NOMOTO}, first order; cubic term {NORRBIN}")
    pose_rates(sheet, U, sp.Integer(0), r, psi, x0, y0)
    return sheet.model()


@cache
def nomoto2() -> Model:
    """Return the model of second order: T_1 T_2 r'' + (T_1 + T_2) r' + r + alpha r^3 = K (delta + T_3 delta').

    The rate of the rudder is no input: the state r_rest = r' - K T_3 delta / (T_1 T_2) takes its place.
    States r [rad/s], r_rest [rad/s^2], psi [rad], x0, y0 [m]; input delta [rad]. Free: K, T_1, T_2, T_3.
    """
    sheet = Sheet("nomoto2", NOMOTO, "steering model of second order")
    r, r_rest, psi, x0, y0 = sheet.states("r r_rest psi x0 y0")
    delta = _rudder(sheet)
    U = _speed(sheet)
    K = sheet.parameter("K", 0.1, "1/s", "gain", CHOSEN_START, free=True)  # start value, chosen
    T_1 = sheet.parameter("T_1", 20.0, "s", "slow time constant", CHOSEN_START, free=True)
    T_2 = sheet.parameter("T_2", 2.0, "s", "fast time constant", CHOSEN_START, free=True)
    T_3 = sheet.parameter("T_3", 4.0, "s", "time constant of the zero", CHOSEN_START, free=True)
    alpha = _cubic(sheet)
    r_dot = sheet.bind("r_dot", r_rest + K * T_3 / (T_1 * T_2) * delta, NOMOTO_SECOND_ORDER, "rad/s^2")
    sheet.rate(r, r_dot, NOMOTO_SECOND_ORDER)
    balance = K * delta - r - alpha * r**3 - (T_1 + T_2) * r_dot
    sheet.rate(r_rest, balance / (T_1 * T_2), f"{NOMOTO_SECOND_ORDER}; {NORRBIN}")
    pose_rates(sheet, U, sp.Integer(0), r, psi, x0, y0)
    return sheet.model()
