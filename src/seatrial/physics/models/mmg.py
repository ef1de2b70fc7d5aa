"""MMG standard method in three degrees of freedom (Yasukawa & Yoshimura 2015), with the extensions real records need.

Axes at midship, x forward, y starboard, psi clockwise; v is the sway velocity at midship; positive rudder turns to
starboard. Forces are made dimensionless with rho/2 L d U^2, moments with rho/2 L^2 d U^2, r' = r L / U.

Extensions, neutral at their default values: asymmetry (Y_0, N_0), rudder zero, side forces of a single screw
(proportional to thrust, to delta^2, to n^2 astern), wind, a propeller turning astern, and continuation to zero and
astern speed. For that, speeds in denominators carry the small constant U_0, odd terms change sign with the direction
of advance as for a hull with fore-and-aft symmetry, and J_P never appears: with T / (rho D_P^2) = K_T (n D_P)^2 every
expression is finite at n = 0 and u = 0. At u >> U_0 and n > 0 all of them are the published ones to (U_0/u)^2.
"""

from dataclasses import dataclass
from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.forces import (
    EXTENSION,
    KITAGAWA,
    SERIES,
    YASUKAWA,
    RudderCoefficients,
    RudderFlow,
    derivative_meaning,
    normal_force,
    pose_rates,
    wind_force,
)
from seatrial.physics.models.roll_coupling import (
    ROLL_TERMS,
    ShipForces,
    ShipInertia,
    ShipMotion,
    coupled_accelerations,
    roll_moment,
    rolling_motion,
    wind_on_rolling_ship,
)

HULL_X = ("R_0", "X_vv", "X_vr", "X_rr", "X_vvvv")
HULL_Y = ("Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr")
HULL_N = ("N_v", "N_r", "N_vvv", "N_vvr", "N_vrr", "N_rrr")
HULL = (*HULL_X, *HULL_Y, *HULL_N)


@dataclass(frozen=True)
class _Motion:
    """Symbols that every force needs."""

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


_HULL_SIZE = 0.02
"""Characteristic size of a dimensionless coefficient of the hull; chosen."""
_ASTERN_SIDE_SIZE = 1e-3
"""The same of the side force astern: a tenth of the thrust, which is 2 K_T D_P^2/(L d) = 0.01 with K_T 0.22; chosen."""


def _coefficient(
    sheet: Sheet, name: str, meaning: str = "", *, free: bool = False, size: float = _HULL_SIZE
) -> sp.Symbol:
    latex = f"{name[0]}'_{{{name[2:].replace('_', ' ')}}}"
    return sheet.parameter(name, 0.0, "1", meaning or derivative_meaning(name), free=free, scale=size, latex=latex)


def _motion(sheet: Sheet, u: sp.Symbol, v: sp.Symbol, r: sp.Symbol, delta: sp.Symbol) -> _Motion:
    L = sheet.parameter("L", unit="m", meaning="length between perpendiculars")
    d = sheet.parameter("d", unit="m", meaning="draught")
    rho = sheet.parameter("rho", unit="kg/m^3", meaning="water density")
    U_0 = sheet.parameter("U_0", 1e-3, "m/s", "speed below which denominators are rounded off", EXTENSION)
    delta_0 = sheet.parameter("delta_0", 0.0, "rad", "added to the recorded rudder angle", EXTENSION, scale=0.02)
    U = sheet.bind("U", sp.sqrt(u**2 + v**2 + U_0**2), f"{YASUKAWA}, speed U", "m/s")
    ahead = sheet.bind("u_0", sp.sqrt(u**2 + U_0**2), EXTENSION, "m/s")
    return _Motion(
        u, v, r, U,
        r_L=sheet.bind("r_L", L * r, "r' U", "m/s"),
        beta=sheet.bind("beta", -sp.atan(v / ahead), f"{YASUKAWA}, drift angle", "rad"),
        s_u=sheet.bind("s_u", u / ahead, "direction of advance, +1 ahead, -1 astern"),
        U_0=U_0, L=L, rho=rho,
        q=sheet.bind("q", rho / 2 * L * d, f"{YASUKAWA}, dimensions of forces", "kg/m^2"),
        delta_R=sheet.bind("delta_R", delta + delta_0, "rudder angle with its zero", "rad"),
    )  # fmt: skip


def _hull(sheet: Sheet, motion: _Motion) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    c = {name: _coefficient(sheet, name, free=True) for name in HULL}
    Y_0, N_0 = (_coefficient(sheet, n, "asymmetry of the hull") for n in ("Y_0", "N_0"))
    N_rr = _coefficient(sheet, "N_rr", "yaw drag r|r|, for turning on the spot")
    v, r_L, U, s = motion.v, motion.r_L, motion.U, motion.s_u
    r_s = sheet.bind("r_s", s * r_L, "r' U, odd in the direction of advance", "m/s")
    v_s = sheet.bind("v_s", s * v, "v, odd in the direction of advance", "m/s")
    even = s * (-c["R_0"] * U**2 + c["X_vv"] * v**2 + c["X_rr"] * r_L**2 + c["X_vvvv"] * v**4 / U**2)
    X_H = sheet.bind("X_H", motion.q * (even + c["X_vr"] * v * r_L), f"{YASUKAWA}, hull force polynomial", "N")
    cubic = c["Y_vvv"] * v**3 + c["Y_vvr"] * v**2 * r_s + c["Y_vrr"] * v * r_L**2 + c["Y_rrr"] * r_s * r_L**2
    side = Y_0 * U**2 + c["Y_v"] * v * U + c["Y_r"] * r_s * U + cubic / U
    Y_H = sheet.bind("Y_H", motion.q * side, f"{YASUKAWA}, hull force polynomial; Y_0 {EXTENSION}", "N")
    cubic = c["N_vvv"] * v_s * v**2 + c["N_vvr"] * v**2 * r_L + c["N_vrr"] * v_s * r_L**2 + c["N_rrr"] * r_L**3
    turn = N_0 * U**2 + c["N_v"] * v_s * U + c["N_r"] * r_L * U + cubic / U + N_rr * r_L * sp.Abs(r_L)
    source = f"{YASUKAWA}, hull force polynomial; N_0, N_rr {EXTENSION}"
    N_H = sheet.bind("N_H", motion.q * motion.L * turn, source, "N m")
    return X_H, Y_H, N_H


@dataclass(frozen=True)
class _Propeller:
    u_P: sp.Symbol
    n_D: sp.Symbol
    D_P: sp.Symbol
    thrust: sp.Symbol
    X_P: sp.Symbol
    Y_P: sp.Symbol
    N_P: sp.Symbol


def _propeller_inflow(sheet: Sheet, motion: _Motion) -> sp.Symbol:
    """Return the axial inflow u (1 - w_P) of the propeller; no wake where the ship goes astern."""
    x_P = sheet.parameter("x_P_prime", -0.48, meaning="propeller position over L", source=YASUKAWA, latex="x'_P")
    w_P0 = sheet.parameter("w_P0", meaning="wake fraction straight ahead", latex="w_{P0}")
    C_1 = sheet.parameter("C_1", 0.0, meaning="change of wake with drift, rate", latex="C_1")
    C_2p = sheet.parameter("C_2_plus", 1.0, meaning="limit of 1 - w_P over 1 - w_P0, beta_P > 0", latex="C_2^+")
    C_2m = sheet.parameter("C_2_minus", 1.0, meaning="limit of 1 - w_P over 1 - w_P0, beta_P < 0", latex="C_2^-")
    beta_P = sheet.bind("beta_P", motion.beta - x_P * motion.r_L / motion.U, f"{YASUKAWA}, beta_P", "rad")
    C_2 = sheet.bind("C_2", sp.Piecewise((C_2p, beta_P > 0), (C_2m, True)), f"{YASUKAWA}, change of wake with beta_P")
    wake = 1 - (1 - w_P0) * (1 + (1 - sp.exp(-C_1 * sp.Abs(beta_P))) * (C_2 - 1))
    w_P = sheet.bind("w_P", wake, f"{YASUKAWA}, change of wake with beta_P")
    return sheet.bind("u_P", sp.Piecewise((motion.u * (1 - w_P), motion.u > 0), (motion.u, True)), "u (1 - w_P)", "m/s")


def _propeller(sheet: Sheet, motion: _Motion, n: sp.Symbol) -> _Propeller:
    D_P = sheet.parameter("D_P", unit="m", meaning="propeller diameter")
    t_P = sheet.parameter("t_P", meaning="thrust deduction", latex="t_P")
    k_0, k_1, k_2 = (sheet.parameter(f"k_{i}", meaning=f"K_T polynomial, J_P^{i}") for i in range(3))
    a_0 = sheet.parameter("k_0_astern", -0.22, meaning="K_T astern at u = 0", source=KITAGAWA, latex="k_0^-")
    a_1 = sheet.parameter("k_1_astern", 0.42, meaning="K_T astern, slope in u/(n D_P)", source=KITAGAWA, latex="k_1^-")
    J_a = sheet.parameter("J_astern", -0.233, meaning="u/(n D_P) where K_T astern levels off", source=KITAGAWA)
    J_s = sheet.parameter("J_side", -0.35, meaning="u/(n D_P) where the side force levels off", source=KITAGAWA)
    Y_T = _coefficient(sheet, "Y_T", "side force over thrust of a single screw")
    N_T = _coefficient(sheet, "N_T", "yaw moment over thrust times L of a single screw")
    Y_nn, Y_nu, N_nn, N_nu = (
        _coefficient(sheet, name, "side force or moment of the propeller astern", size=_ASTERN_SIDE_SIZE)
        for name in ("Y_nn", "Y_nu", "N_nn", "N_nu")
    )
    u_P = _propeller_inflow(sheet, motion)
    n_D = sheet.bind("n_D", n * D_P, "n D_P", "m/s")
    u_a = sheet.bind("u_a", sp.Piecewise((motion.u, motion.u < J_a * n_D), (J_a * n_D, True)), KITAGAWA, "m/s")
    u_s = sheet.bind("u_s", sp.Piecewise((motion.u, motion.u < J_s * n_D), (J_s * n_D, True)), KITAGAWA, "m/s")
    driven = sp.Piecewise((n_D * (k_0 * n_D + k_1 * u_P), n >= 0), (n_D * (a_0 * n_D + a_1 * u_a), True))
    force = motion.rho * D_P**2 * (driven + k_2 * u_P * sp.Abs(u_P))
    thrust = sheet.output("thrust", force, f"{YASUKAWA}, thrust, T = rho n^2 D_P^4 K_T; astern {KITAGAWA}", "N")
    X_P = sheet.bind("X_P", (1 - t_P) * thrust, f"{YASUKAWA}, propeller force", "N")
    side = sp.Piecewise((sp.Integer(0), n >= 0), (n_D * (Y_nn * n_D + Y_nu * u_s), True))
    Y_P = sheet.bind("Y_P", Y_T * thrust + motion.q * side, f"{EXTENSION}; astern {KITAGAWA}", "N")
    turn = sp.Piecewise((sp.Integer(0), n >= 0), (n_D * (N_nn * n_D + N_nu * u_s), True))
    N_P = sheet.bind("N_P", motion.L * (N_T * thrust + motion.q * turn), f"{EXTENSION}; astern {KITAGAWA}", "N m")
    return _Propeller(u_P, n_D, D_P, thrust, X_P, Y_P, N_P)


def _rudder(
    sheet: Sheet, motion: _Motion, propeller: _Propeller, n: sp.Symbol
) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    A_R = sheet.parameter("A_R", unit="m^2", meaning="movable rudder area")
    H_R = sheet.parameter("H_R", unit="m", meaning="rudder span")
    x_R = sheet.parameter("x_R_prime", -0.5, meaning="rudder position over L", source=YASUKAWA, latex="x'_R")
    f_alpha = sheet.parameter("f_alpha", meaning="gradient of the rudder's lift", latex=r"f_\alpha")
    t_R = sheet.parameter("t_R", meaning="steering resistance deduction", latex="t_R")
    a_H = sheet.parameter("a_H", meaning="rudder force increase", latex="a_H")
    x_H = sheet.parameter("x_H_prime", meaning="position of the additional force over L", latex="x'_H")
    Y_dd, N_dd = (_coefficient(sheet, name, "even in the rudder angle, single screw") for name in ("Y_dd", "N_dd"))
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
    flow = RudderFlow(
        motion.U, motion.beta, motion.r_L, motion.U_0, motion.rho, n, propeller.n_D, propeller.D_P, propeller.u_P,
        propeller.thrust,
    )  # fmt: skip
    force = normal_force(sheet, flow, rudder, motion.delta_R)
    F_N, sine, cosine = force.F_N, force.sine, force.cosine
    even = sheet.bind("even", motion.q * (motion.U * motion.delta_R) ** 2, EXTENSION, "N")
    F_C = sheet.bind("F_C", F_N * cosine, "athwartships part of the normal force", "N")
    X_R = sheet.bind("X_R", -(1 - t_R) * F_N * sine, f"{YASUKAWA}, rudder forces", "N")
    Y_R = sheet.bind("Y_R", -(1 + a_H) * F_C + Y_dd * even, f"{YASUKAWA}, rudder forces; Y_dd {EXTENSION}", "N")
    yaw = motion.L * (-(x_R + a_H * x_H) * F_C + N_dd * even)
    N_R = sheet.bind("N_R", yaw, f"{YASUKAWA}, rudder forces; N_dd {EXTENSION}", "N m")
    return X_R, Y_R, N_R


@dataclass(frozen=True)
class _Masses:
    """Masses and inertia with added ones, M_c = m x_G; m, m_y' and rho/2 L^2 d."""

    M_u: sp.Symbol
    M_v: sp.Symbol
    M_c: sp.Symbol
    M_r: sp.Symbol
    m: sp.Symbol
    m_y: sp.Symbol
    unit: sp.Symbol


_EQUATIONS = f"{YASUKAWA}, equations of motion"


def _masses(sheet: Sheet, motion: _Motion) -> _Masses:
    m = sheet.parameter("m", unit="kg", meaning="mass")
    x_G = sheet.parameter("x_G", unit="m", meaning="centre of gravity forward of midship")
    I_z = sheet.parameter("I_z", unit="kg m^2", meaning="yaw inertia about the centre of gravity")
    m_x = sheet.parameter("m_x_prime", meaning="surge added mass over rho/2 L^2 d", latex="m'_x")
    m_y = sheet.parameter("m_y_prime", meaning="sway added mass over rho/2 L^2 d", latex="m'_y")
    J_z = sheet.parameter("J_z_prime", meaning="yaw added inertia over rho/2 L^4 d", latex="J'_z")
    unit = sheet.bind("m_L", motion.q * motion.L, "rho/2 L^2 d", "kg")
    M_u = sheet.bind("M_u", m + m_x * unit, _EQUATIONS, "kg")
    M_v = sheet.bind("M_v", m + m_y * unit, _EQUATIONS, "kg")
    M_c = sheet.bind("M_c", m * x_G, _EQUATIONS, "kg m")
    M_r = sheet.bind("M_r", I_z + M_c * x_G + J_z * unit * motion.L**2, _EQUATIONS, "kg m^2")
    return _Masses(M_u, M_v, M_c, M_r, m, m_y, unit)


def _with_centripetal(
    sheet: Sheet, motion: _Motion, masses: _Masses, X: sp.Symbol, Y: sp.Symbol, N: sp.Symbol
) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Return X_m, Y_m, N_m: what a balance feels that holds the ship in steady motion."""
    u_r = sheet.bind("u_r", motion.u * motion.r, _EQUATIONS, "m/s^2")
    X_m = sheet.bind("X_m", X + masses.M_v * motion.v * motion.r + masses.M_c * motion.r**2, _EQUATIONS, "N")
    Y_m = sheet.bind("Y_m", Y - masses.M_u * u_r, _EQUATIONS, "N")
    return X_m, Y_m, sheet.bind("N_m", N - masses.M_c * u_r, _EQUATIONS, "N m")


def _accelerations(sheet: Sheet, motion: _Motion, X: sp.Symbol, Y: sp.Symbol, N: sp.Symbol) -> None:
    masses = _masses(sheet, motion)
    M_v, M_c, M_r = masses.M_v, masses.M_c, masses.M_r
    D = sheet.bind("D_M", M_v * M_r - M_c**2, "determinant of the inertia matrix", "kg^2 m^2")
    X_m, Y_m, N_m = _with_centripetal(sheet, motion, masses, X, Y, N)
    sheet.rate(motion.u, X_m / masses.M_u, _EQUATIONS)
    sheet.rate(motion.v, (Y_m * M_r - N_m * M_c) / D, f"{_EQUATIONS}, inertia matrix inverted")
    sheet.rate(motion.r, (N_m * M_v - Y_m * M_c) / D, f"{_EQUATIONS}, inertia matrix inverted")


@cache
def mmg() -> Model:
    """Return the standard method with all extensions; hull coefficients are free, everything else fixed.

    States u, v, r [m/s, m/s, rad/s] through the water at midship, psi [rad], x0, y0 [m]; inputs delta [rad, positive
    turns to starboard], n [rps, negative astern], wind_speed [m/s], wind_direction [rad, the heading it comes from].
    Output thrust [N], the propeller's own, not reduced by t_P. Parameters without a value (particulars, added masses,
    propeller and rudder coefficients) come from the ship or a parameter set.
    """
    sheet = Sheet("mmg", YASUKAWA, "MMG standard method with propeller, rudder and wind")
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    delta, n = sheet.input("delta"), sheet.input("n")
    motion = _motion(sheet, u, v, r, delta)
    current = pose_rates(sheet, u, v, r, psi, x0, y0)
    X_H, Y_H, N_H = _hull(sheet, motion)
    by = _propeller(sheet, motion, n)
    X_R, Y_R, N_R = _rudder(sheet, motion, by, n)
    wind = wind_force(sheet, (u, v, psi), current, motion.L, motion.U_0, SERIES)
    X = sheet.bind("X_sum", X_H + by.X_P + X_R + wind.X, f"{YASUKAWA}, X of the equations of motion", "N")
    Y = sheet.bind("Y_sum", Y_H + by.Y_P + Y_R + wind.Y, f"{YASUKAWA}, Y of the equations of motion", "N")
    N = sheet.bind("N_sum", N_H + by.N_P + N_R + wind.N, f"{YASUKAWA}, N_m of the equations of motion", "N m")
    _accelerations(sheet, motion, X, Y, N)
    return sheet.model()


# With roll: the side forces of hull and rudder act below G, and heel changes those of the hull.

ROLLING = "Yasukawa, Sakuno & Yoshimura 2019, J Mar Sci Technol 24, 1280-1296, doi 10.1007/s00773-019-00625-4"
HEEL = (*(f"X_{t}" for t in ("phiphi", "vphi", "rphi")), *(f"{f}_{t}" for f in "YN" for t in ROLL_TERMS))
HEEL_FREE = ("Y_phi", "N_phi")


def _heeled(sheet: Sheet, motion: _Motion, ship: ShipMotion) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Return what heel adds to surge and sway force and yaw moment of the hull."""
    c = {name: _coefficient(sheet, name, free=name in HEEL_FREE) for name in HEEL}
    v, r_L, U, phi = motion.v, motion.r_L, motion.U, ship.heel
    powers = {"phi": phi * U**2, "vvphi": v**2 * phi, "vphiphi": v * phi**2 * U, "rrphi": r_L**2 * phi,
              "rphiphi": r_L * phi**2 * U}  # fmt: skip
    Y, N = (sum(c[f"{force}_{term}"] * value for term, value in powers.items()) for force in "YN")
    X = c["X_phiphi"] * phi**2 * U**2 + c["X_vphi"] * v * phi * U + c["X_rphi"] * r_L * phi * U
    source = f"{ROLLING}, derivatives of heel"
    return (
        sheet.bind("X_heel", motion.q * X, source, "N"),
        sheet.bind("Y_heel", motion.q * Y, source, "N"),
        sheet.bind("N_heel", motion.q * motion.L * N, source, "N m"),
    )


def _roll_inertia(sheet: Sheet, motion: _Motion, masses: _Masses) -> ShipInertia:
    I_x = sheet.parameter("I_x", unit="kg m^2", meaning="roll inertia about the centre of gravity")
    J_x = sheet.parameter("J_x_prime", 0.0, meaning="roll added inertia over rho/2 L^4 d", scale=1e-5, latex="J'_x")
    l_y = sheet.parameter("l_y_prime", 0.0, meaning="depth of the sway added mass below G over L", scale=0.01,
                          latex="l'_y")  # fmt: skip
    M_p = sheet.bind("M_p", I_x + J_x * masses.unit * motion.L**2, f"{ROLLING}, equations of motion", "kg m^2")
    M_vp = sheet.bind("M_vp", -masses.m_y * l_y * masses.unit * motion.L, f"{ROLLING}, equations of motion", "kg m")
    return ShipInertia(masses.M_u, masses.M_v, M_p, masses.M_r, M_vp, M_vp, masses.M_c, masses.M_c)


@cache
def mmg_roll() -> Model:
    """Return the standard method with roll; hull, lever z_H of its side force, GM and damping are free.

    States u, v, r at midship, psi, x0, y0, phi [rad], p [rad/s] about an axis at the height of G; inputs and output as
    `mmg`, with alpha_w and alpha_f [rad]. Levers are positive below G.
    """
    sheet = Sheet("mmg_roll", ROLLING, "MMG with roll, propeller, rudder, fins and wind")
    ship, current = rolling_motion(sheet)
    delta, n = sheet.input("delta"), sheet.input("n")
    motion = _motion(sheet, ship.u, ship.v, ship.r, delta)
    X_H, Y_H, N_H = _hull(sheet, motion)
    X_F, Y_F, N_F = _heeled(sheet, motion, ship)
    by = _propeller(sheet, motion, n)
    X_R, Y_R, N_R = _rudder(sheet, motion, by, n)
    wind = wind_on_rolling_ship(sheet, ship, current, motion.L, motion.U_0)
    X = sheet.bind("X_sum", X_H + X_F + by.X_P + X_R + wind.X, f"{ROLLING}, X of the equations of motion", "N")
    Y = sheet.bind("Y_sum", Y_H + Y_F + by.Y_P + Y_R + wind.Y, f"{ROLLING}, Y of the equations of motion", "N")
    N = sheet.bind("N_sum", N_H + N_F + by.N_P + N_R + wind.N, f"{ROLLING}, N of the equations of motion", "N m")
    masses = _masses(sheet, motion)
    inertia = _roll_inertia(sheet, motion, masses)
    X_m, Y_m, N_m = _with_centripetal(sheet, motion, masses, X, Y, N)
    z_H, z_R = (
        sheet.parameter(
            f"{name}_prime",
            0.0,
            meaning=f"depth of the {force} below G over L",
            free=is_free,
            scale=0.01,  # a hundredth of the length; chosen
            latex=f"z'_{name[2]}",
        )
        for name, force, is_free in (("z_H", "hull's side force", True), ("z_R", "rudder's side force", False))
    )
    unit = motion.q * motion.L * motion.U**2
    static = roll_moment(sheet, ship, inertia.M_p, masses.m, unit)
    levers = motion.L * (z_H * (Y_H + Y_F) + z_R * Y_R)
    K = sheet.bind("K_sum", static - levers + wind.K, f"{ROLLING}, side force times its lever", "N m")
    coupled_accelerations(sheet, ship, inertia, ShipForces(X_m, Y_m, K, N_m))
    model = sheet.model()
    return model.with_parameters(model.parameters.freed("b_1", "b_2"))
