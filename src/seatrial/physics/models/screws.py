"""Screws of the MMG method and the rudders behind them, one or two (Yasukawa & Yoshimura 2015).

Two screws and rudders are equal and stand as far to port as to starboard, as Lee & Fujino 2003 extended the method to
them: each rudder works in the slipstream of its own screw, and hull, wake and rudder have one set of coefficients, that
of the starboard side; left and right of the flow change places to port. Forces off the centre line turn the ship by
their arm, and a screw meets the water at the speed of its own place, u - y r (rigid body). What one screw or rudder
does to the flow at the other is not modelled: no source that could be checked gives it.
"""

from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.forces import (
    EXTENSION,
    KITAGAWA,
    YASUKAWA,
    PlanarForce,
    RudderCoefficients,
    RudderFlow,
    derivative_meaning,
    normal_force,
)
from seatrial.physics.models.shallow_water import DepthFactors

LEE = "Lee & Fujino 2003, Int. Shipbuilding Progress 50, 109-123, two screws and two rudders"
RIGID = "rigid body: moment and velocity of a place off the centre line"


@dataclass(frozen=True)
class ShipFlow:
    """Symbols that every force needs; water: factors of the depth."""

    u: sp.Symbol
    v: sp.Symbol
    r: sp.Symbol
    U: sp.Symbol
    r_L: sp.Symbol
    beta: sp.Symbol
    s_u: sp.Symbol
    U_0: sp.Symbol
    L: sp.Symbol
    rho: sp.Symbol
    q: sp.Symbol
    delta_R: sp.Symbol
    water: DepthFactors


_HULL_SIZE = 0.02
"""Characteristic size of a dimensionless coefficient of the hull; chosen."""
_ASTERN_SIDE_SIZE = 1e-3
"""The same of the side force astern: a tenth of the thrust, which is 2 K_T D_P^2/(L d) = 0.01 with K_T 0.22; chosen."""


def hull_coefficient(
    sheet: Sheet, name: str, meaning: str = "", *, free: bool = False, size: float = _HULL_SIZE
) -> sp.Symbol:
    """Declare a dimensionless coefficient of hull, propeller or rudder."""
    latex = f"{name[0]}'_{{{name[2:].replace('_', ' ')}}}"
    return sheet.parameter(name, 0.0, "1", meaning or derivative_meaning(name), free=free, scale=size, latex=latex)


@dataclass(frozen=True)
class _Screw:
    """A screw and the rudder behind it.

    Attributes:
        n: turns a second; delta_R: rudder angle with its zero [rad].
        suffix: with which names of its bindings end.
        y: place to starboard of the centre line [m].
        is_mirrored: whether left and right of the flow change places in its coefficients.
    """

    n: sp.Expr
    delta_R: sp.Expr
    suffix: str = ""
    y: sp.Expr = sp.S.Zero
    is_mirrored: bool = False


@dataclass(frozen=True)
class _Thrust:
    """Axial inflow [m/s], n D_P [m/s], diameter [m] and thrust [N] of one screw."""

    u_P: sp.Symbol
    n_D: sp.Symbol
    D_P: sp.Symbol
    thrust: sp.Symbol


@dataclass(frozen=True)
class _PropellerCoefficients:
    D_P: sp.Symbol
    t_P: sp.Symbol
    ahead: tuple[sp.Symbol, ...]
    astern: tuple[sp.Symbol, ...]
    J_a: sp.Symbol


@dataclass(frozen=True)
class _Wake:
    x_P: sp.Symbol
    w_P0: sp.Symbol
    C_1: sp.Symbol
    C_2: tuple[sp.Symbol, ...]


def propelled_by_one(sheet: Sheet, motion: ShipFlow, n: sp.Symbol) -> tuple[PlanarForce, PlanarForce]:
    """Write a screw on the centre line and its rudder; return the forces of both; output thrust."""
    screw = _Screw(n, motion.delta_R)
    by = _propeller_coefficients(sheet)
    J_s = sheet.parameter("J_side", -0.35, meaning="u/(n D_P) where the side force levels off", source=KITAGAWA)
    Y_T = hull_coefficient(sheet, "Y_T", "side force over thrust of a single screw")
    N_T = hull_coefficient(sheet, "N_T", "yaw moment over thrust times L of a single screw")
    Y_nn, Y_nu, N_nn, N_nu = (
        hull_coefficient(sheet, name, "side force or moment of the propeller astern", size=_ASTERN_SIDE_SIZE)
        for name in ("Y_nn", "Y_nu", "N_nn", "N_nu")
    )
    u_P = _inflow(sheet, motion, _wake(sheet), screw)
    n_D, driven = _driven(sheet, motion, by, screw, u_P)
    u_s = sheet.bind("u_s", sp.Piecewise((motion.u, motion.u < J_s * n_D), (J_s * n_D, True)), KITAGAWA, "m/s")
    T = sheet.output("thrust", _force(motion, by, u_P, driven), _THRUST, "N")
    X_P = sheet.bind("X_P", (1 - by.t_P) * motion.water.t_P * T, f"{YASUKAWA}, propeller force", "N")
    side = sp.Piecewise((sp.Integer(0), n >= 0), (n_D * (Y_nn * n_D + Y_nu * u_s), True))
    Y_P = sheet.bind("Y_P", Y_T * T + motion.q * side, f"{EXTENSION}; astern {KITAGAWA}", "N")
    turn = sp.Piecewise((sp.Integer(0), n >= 0), (n_D * (N_nn * n_D + N_nu * u_s), True))
    N_P = sheet.bind("N_P", motion.L * (N_T * T + motion.q * turn), f"{EXTENSION}; astern {KITAGAWA}", "N m")
    return PlanarForce(X_P, Y_P, N_P), _single_rudder(sheet, motion, screw, _Thrust(u_P, n_D, by.D_P, T))


def propelled_by_two(sheet: Sheet, motion: ShipFlow, n: sp.Symbol) -> tuple[PlanarForce, PlanarForce]:
    """Write two screws and the rudders behind them; return the forces of screws and of rudders; output thrust: both.

    n and delta are the means of both sides; their differences are inputs.
    """
    n_d, delta_d = sheet.input("n_difference"), sheet.input("delta_difference")
    y_P = sheet.parameter("y_P", unit="m", meaning="screws and rudders off the centre line")
    half = "half the difference to each side"
    sides = tuple(
        _Screw(
            sheet.bind(f"n{suffix}", n + sign * n_d / 2, half, "1/s"),
            sheet.bind(f"delta{suffix}", motion.delta_R + sign * delta_d / 2, half, "rad"),
            suffix, -sign * y_P, is_mirrored=sign > 0,
        )
        for suffix, sign in (("_port", 1), ("_starboard", -1))
    )  # fmt: skip
    by, wake = _propeller_coefficients(sheet), _wake(sheet)
    thrusts = tuple(_thrust_of(sheet, motion, by, wake, screw) for screw in sides)
    T = sheet.output("thrust", sp.Add(*(thrust.thrust for thrust in thrusts)), "both screws", "N")
    deducted = (1 - by.t_P) * motion.water.t_P
    X_P = sheet.bind("X_P", deducted * T, f"{LEE}, propeller forces", "N")
    arms = sp.Add(*(screw.y * thrust.thrust for screw, thrust in zip(sides, thrusts, strict=True)))
    N_P = sheet.bind("N_P", -deducted * arms, f"{LEE}, propeller forces; {RIGID}", "N m")
    Y_P = sheet.bind("Y_P", sp.Integer(0), f"{LEE}, none of two screws that turn opposite ways", "N")
    return PlanarForce(X_P, Y_P, N_P), _twin_rudders(sheet, motion, sides, thrusts)


_THRUST = f"{YASUKAWA}, thrust, T = rho n^2 D_P^4 K_T; astern {KITAGAWA}"


def _propeller_coefficients(sheet: Sheet) -> _PropellerCoefficients:
    D_P = sheet.parameter("D_P", unit="m", meaning="propeller diameter")
    t_P = sheet.parameter("t_P", meaning="thrust deduction", latex="t_P")
    ahead = tuple(sheet.parameter(f"k_{i}", meaning=f"K_T polynomial, J_P^{i}") for i in range(3))
    a_0 = sheet.parameter("k_0_astern", -0.22, meaning="K_T astern at u = 0", source=KITAGAWA, latex="k_0^-")
    a_1 = sheet.parameter("k_1_astern", 0.42, meaning="K_T astern, slope in u/(n D_P)", source=KITAGAWA, latex="k_1^-")
    J_a = sheet.parameter("J_astern", -0.233, meaning="u/(n D_P) where K_T astern levels off", source=KITAGAWA)
    return _PropellerCoefficients(D_P, t_P, ahead, (a_0, a_1), J_a)


def _wake(sheet: Sheet) -> _Wake:
    x_P = sheet.parameter("x_P_prime", -0.48, meaning="propeller position over L", source=YASUKAWA, latex="x'_P")
    w_P0 = sheet.parameter("w_P0", meaning="wake fraction straight ahead", latex="w_{P0}")
    C_1 = sheet.parameter("C_1", 0.0, meaning="change of wake with drift, rate", latex="C_1")
    C_2p = sheet.parameter("C_2_plus", 1.0, meaning="limit of 1 - w_P over 1 - w_P0, beta_P > 0", latex="C_2^+")
    C_2m = sheet.parameter("C_2_minus", 1.0, meaning="limit of 1 - w_P over 1 - w_P0, beta_P < 0", latex="C_2^-")
    return _Wake(x_P, w_P0, C_1, (C_2p, C_2m))


def _inflow(sheet: Sheet, motion: ShipFlow, wake: _Wake, screw: _Screw) -> sp.Symbol:
    """Return the axial inflow (u - y r) (1 - w_P) of a propeller; no wake where it goes astern."""
    suffix, (plus, minus) = screw.suffix, reversed(wake.C_2) if screw.is_mirrored else wake.C_2
    angle = motion.beta - wake.x_P * motion.r_L / motion.U
    beta_P = sheet.bind(f"beta_P{suffix}", angle, f"{YASUKAWA}, beta_P", "rad")
    limit = sp.Piecewise((plus, beta_P > 0), (minus, True))
    C_2 = sheet.bind(f"C_2{suffix}", limit, f"{YASUKAWA}, change of wake with beta_P")
    wake_share = (1 - wake.w_P0) * (1 + (1 - sp.exp(-wake.C_1 * sp.Abs(beta_P))) * (C_2 - 1))
    w_P = sheet.bind(f"w_P{suffix}", 1 - motion.water.w_P * wake_share, f"{YASUKAWA}, change of wake with beta_P")
    ahead = motion.u - screw.y * motion.r
    inflow = sp.Piecewise((ahead * (1 - w_P), ahead > 0), (ahead, True))
    return sheet.bind(f"u_P{suffix}", inflow, "u (1 - w_P)", "m/s")


def _driven(
    sheet: Sheet, motion: ShipFlow, by: _PropellerCoefficients, screw: _Screw, u_P: sp.Symbol
) -> tuple[sp.Symbol, sp.Expr]:
    """Write n D_P, and return it with what of the thrust over rho D_P^2 changes its form astern."""
    (k_0, k_1, _), (a_0, a_1), ahead = by.ahead, by.astern, motion.u - screw.y * motion.r
    n_D = sheet.bind(f"n_D{screw.suffix}", screw.n * by.D_P, "n D_P", "m/s")
    least = sp.Piecewise((ahead, ahead < by.J_a * n_D), (by.J_a * n_D, True))
    u_a = sheet.bind(f"u_a{screw.suffix}", least, KITAGAWA, "m/s")
    return n_D, sp.Piecewise((n_D * (k_0 * n_D + k_1 * u_P), screw.n >= 0), (n_D * (a_0 * n_D + a_1 * u_a), True))


def _force(motion: ShipFlow, by: _PropellerCoefficients, u_P: sp.Symbol, driven: sp.Expr) -> sp.Expr:
    return motion.rho * by.D_P**2 * (driven + by.ahead[2] * u_P * sp.Abs(u_P))


def _thrust_of(sheet: Sheet, motion: ShipFlow, by: _PropellerCoefficients, wake: _Wake, screw: _Screw) -> _Thrust:
    u_P = _inflow(sheet, motion, wake, screw)
    n_D, driven = _driven(sheet, motion, by, screw, u_P)
    T = sheet.bind(f"thrust{screw.suffix}", _force(motion, by, u_P, driven), _THRUST, "N")
    return _Thrust(u_P, n_D, by.D_P, T)


# Rudders behind the screws.


@dataclass(frozen=True)
class _RudderInteraction:
    """Coefficients of one or two equal rudders, and of what their forces do to the hull."""

    rudder: RudderCoefficients
    x_R: sp.Symbol
    t_R: sp.Symbol
    a_H: sp.Symbol
    x_H: sp.Symbol


def _single_rudder(sheet: Sheet, motion: ShipFlow, screw: _Screw, thrust: _Thrust) -> PlanarForce:
    """Write the force of the rudder behind a single screw."""
    by, (Y_dd, N_dd) = _rudder_coefficients(sheet, ("Y_dd", "N_dd"))
    force = normal_force(sheet, _past(motion, screw, thrust), by.rudder, screw.delta_R)
    even = sheet.bind("even", motion.q * (motion.U * motion.delta_R) ** 2, EXTENSION, "N")
    F_C = sheet.bind("F_C", force.F_N * force.cosine, "athwartships part of the normal force", "N")
    X_R = sheet.bind("X_R", -(1 - by.t_R) * force.F_N * force.sine, f"{YASUKAWA}, rudder forces", "N")
    Y_R = sheet.bind("Y_R", -(1 + by.a_H) * F_C + Y_dd * even, f"{YASUKAWA}, rudder forces; Y_dd {EXTENSION}", "N")
    yaw = motion.L * (-(by.x_R + by.a_H * by.x_H) * F_C + N_dd * even)
    return PlanarForce(X_R, Y_R, sheet.bind("N_R", yaw, f"{YASUKAWA}, rudder forces; N_dd {EXTENSION}", "N m"))


def _twin_rudders(
    sheet: Sheet, motion: ShipFlow, screws: tuple[_Screw, ...], thrusts: tuple[_Thrust, ...]
) -> PlanarForce:
    """Write the forces of the rudders behind two screws; area and span are those of one."""
    by, _ = _rudder_coefficients(sheet, ())
    ahead, across, arms = [], [], []
    for screw, thrust in zip(screws, thrusts, strict=True):
        force = normal_force(
            sheet, _past(motion, screw, thrust), by.rudder, screw.delta_R, screw.suffix, is_mirrored=screw.is_mirrored
        )
        drag = -(1 - by.t_R) * force.F_N * force.sine
        ahead.append(sheet.bind(f"X_R{screw.suffix}", drag, f"{LEE}, rudder forces", "N"))
        part = force.F_N * force.cosine
        across.append(sheet.bind(f"F_C{screw.suffix}", part, "athwartships part of the normal force", "N"))
        arms.append(screw.y * ahead[-1])
    F_C = sheet.bind("F_C", sp.Add(*across), "both rudders", "N")
    X_R = sheet.bind("X_R", sp.Add(*ahead), f"{LEE}, rudder forces", "N")
    Y_R = sheet.bind("Y_R", -(1 + by.a_H) * F_C, f"{LEE}, rudder forces", "N")
    yaw = -motion.L * (by.x_R + by.a_H * by.x_H) * F_C - sp.Add(*arms)
    return PlanarForce(X_R, Y_R, sheet.bind("N_R", yaw, f"{LEE}, rudder forces; {RIGID}", "N m"))


def _past(motion: ShipFlow, screw: _Screw, thrust: _Thrust) -> RudderFlow:
    return RudderFlow(
        motion.U, motion.beta, motion.r_L, motion.U_0, motion.rho, screw.n, thrust.n_D, thrust.D_P, thrust.u_P,
        thrust.thrust, motion.water.gamma_R,
    )  # fmt: skip


def _rudder_coefficients(sheet: Sheet, even: tuple[str, ...]) -> tuple[_RudderInteraction, tuple[sp.Symbol, ...]]:
    A_R = sheet.parameter("A_R", unit="m^2", meaning="movable rudder area")
    H_R = sheet.parameter("H_R", unit="m", meaning="rudder span")
    x_R = sheet.parameter("x_R_prime", -0.5, meaning="rudder position over L", source=YASUKAWA, latex="x'_R")
    f_alpha = sheet.parameter("f_alpha", meaning="gradient of the rudder's lift", latex=r"f_\alpha")
    t_R = sheet.parameter("t_R", meaning="steering resistance deduction", latex="t_R")
    a_H = sheet.parameter("a_H", meaning="rudder force increase", latex="a_H")
    x_H = sheet.parameter("x_H_prime", meaning="position of the additional force over L", latex="x'_H")
    in_square = tuple(hull_coefficient(sheet, name, "even in the rudder angle, single screw") for name in even)
    rudder = RudderCoefficients(
        A_R, H_R, f_alpha,
        sheet.parameter("epsilon", meaning="wake ratio, rudder over propeller", latex=r"\varepsilon"),
        sheet.parameter("kappa", meaning="slipstream acceleration at the rudder", latex=r"\kappa"),
        sheet.parameter("kappa_astern", 0.0, meaning="flow at the rudder over n D_P, propeller astern",
                        source=KITAGAWA, latex=r"\kappa^-"),
        sheet.parameter("gamma_R_plus", meaning="flow straightening, beta_R > 0", latex=r"\gamma_R^+"),
        sheet.parameter("gamma_R_minus", meaning="flow straightening, beta_R < 0", latex=r"\gamma_R^-"),
        sheet.parameter("l_R_prime", meaning="effective position of the rudder over L", latex=r"\ell'_R"),
    )  # fmt: skip
    return _RudderInteraction(rudder, x_R, t_R, a_H, x_H), in_square
