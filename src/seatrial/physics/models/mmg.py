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
    SERIES,
    YASUKAWA,
    pose_rates,
    wind_force,
)
from seatrial.physics.models.published import KIJIMA, LI_WU
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
from seatrial.physics.models.screws import LEE, ShipFlow, hull_coefficient, propelled_by_one, propelled_by_two
from seatrial.physics.models.shallow_water import DEEP, depth_factors

HULL_X = ("R_0", "X_vv", "X_vr", "X_rr", "X_vvvv")
HULL_Y = ("Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr")
HULL_N = ("N_v", "N_r", "N_vvv", "N_vvr", "N_vrr", "N_rrr")
HULL = (*HULL_X, *HULL_Y, *HULL_N)


def _motion(
    sheet: Sheet, u: sp.Symbol, v: sp.Symbol, r: sp.Symbol, delta: sp.Symbol, *, is_shallow: bool = False
) -> ShipFlow:
    L = sheet.parameter("L", unit="m", meaning="length between perpendiculars")
    d = sheet.parameter("d", unit="m", meaning="draught")
    rho = sheet.parameter("rho", unit="kg/m^3", meaning="water density")
    U_0 = sheet.parameter("U_0", 1e-3, "m/s", "speed below which denominators are rounded off", EXTENSION)
    delta_0 = sheet.parameter("delta_0", 0.0, "rad", "added to the recorded rudder angle", EXTENSION, scale=0.02)
    U = sheet.bind("U", sp.sqrt(u**2 + v**2 + U_0**2), f"{YASUKAWA}, speed U", "m/s")
    ahead = sheet.bind("u_0", sp.sqrt(u**2 + U_0**2), EXTENSION, "m/s")
    water = depth_factors(sheet, L, d) if is_shallow else DEEP
    return ShipFlow(
        u, v, r, U, water=water,
        r_L=sheet.bind("r_L", L * r, "r' U", "m/s"),
        beta=sheet.bind("beta", -sp.atan(v / ahead), f"{YASUKAWA}, drift angle", "rad"),
        s_u=sheet.bind("s_u", u / ahead, "direction of advance, +1 ahead, -1 astern"),
        U_0=U_0, L=L, rho=rho,
        q=sheet.bind("q", rho / 2 * L * d, f"{YASUKAWA}, dimensions of forces", "kg/m^2"),
        delta_R=sheet.bind("delta_R", delta + delta_0, "rudder angle with its zero", "rad"),
    )  # fmt: skip


def _hull(sheet: Sheet, motion: ShipFlow) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    c = {name: hull_coefficient(sheet, name, free=True) for name in HULL}
    Y_0, N_0 = (hull_coefficient(sheet, n, "asymmetry of the hull") for n in ("Y_0", "N_0"))
    N_rr = hull_coefficient(sheet, "N_rr", "yaw drag r|r|, for turning on the spot")
    v, r_L, U, s, water = motion.v, motion.r_L, motion.U, motion.s_u, motion.water
    r_s = sheet.bind("r_s", s * r_L, "r' U, odd in the direction of advance", "m/s")
    v_s = sheet.bind("v_s", s * v, "v, odd in the direction of advance", "m/s")
    even = s * (-water.R_0 * c["R_0"] * U**2 + c["X_vv"] * v**2 + c["X_rr"] * r_L**2 + c["X_vvvv"] * v**4 / U**2)
    X_H = sheet.bind("X_H", motion.q * (even + c["X_vr"] * v * r_L), f"{YASUKAWA}, hull force polynomial", "N")
    cubic = c["Y_vvv"] * v**3 + c["Y_vvr"] * v**2 * r_s + c["Y_vrr"] * v * r_L**2 + c["Y_rrr"] * r_s * r_L**2
    side = Y_0 * U**2 + water.Y_v * c["Y_v"] * v * U + water.Y_r * c["Y_r"] * r_s * U + cubic / U
    Y_H = sheet.bind("Y_H", motion.q * side, f"{YASUKAWA}, hull force polynomial; Y_0 {EXTENSION}", "N")
    cubic = c["N_vvv"] * v_s * v**2 + c["N_vvr"] * v**2 * r_L + c["N_vrr"] * v_s * r_L**2 + c["N_rrr"] * r_L**3
    turn = N_0 * U**2 + water.N_v * c["N_v"] * v_s * U + water.N_r * c["N_r"] * r_L * U
    turn += cubic / U + N_rr * r_L * sp.Abs(r_L)
    source = f"{YASUKAWA}, hull force polynomial; N_0, N_rr {EXTENSION}"
    N_H = sheet.bind("N_H", motion.q * motion.L * turn, source, "N m")
    return X_H, Y_H, N_H


@dataclass(frozen=True)
class _Masses:
    """Masses and inertia with added ones, M_c = m x_G; m, m_y' and rho/2 L^2 d.

    M_s: sway mass of the surge force v r, deep water's at any depth, as X_vr of the same force is.
    """

    M_u: sp.Symbol
    M_v: sp.Symbol
    M_c: sp.Symbol
    M_r: sp.Symbol
    m: sp.Symbol
    m_y: sp.Symbol
    unit: sp.Symbol
    M_s: sp.Symbol


_EQUATIONS = f"{YASUKAWA}, equations of motion"


def _masses(sheet: Sheet, motion: ShipFlow) -> _Masses:
    m = sheet.parameter("m", unit="kg", meaning="mass")
    x_G = sheet.parameter("x_G", unit="m", meaning="centre of gravity forward of midship")
    I_z = sheet.parameter("I_z", unit="kg m^2", meaning="yaw inertia about the centre of gravity")
    m_x = sheet.parameter("m_x_prime", meaning="surge added mass over rho/2 L^2 d", latex="m'_x")
    m_y = sheet.parameter("m_y_prime", meaning="sway added mass over rho/2 L^2 d", latex="m'_y")
    J_z = sheet.parameter("J_z_prime", meaning="yaw added inertia over rho/2 L^4 d", latex="J'_z")
    unit = sheet.bind("m_L", motion.q * motion.L, "rho/2 L^2 d", "kg")
    M_u = sheet.bind("M_u", m + m_x * unit, _EQUATIONS, "kg")
    M_v = sheet.bind("M_v", m + motion.water.m_y * m_y * unit, _EQUATIONS, "kg")
    M_c = sheet.bind("M_c", m * x_G, _EQUATIONS, "kg m")
    M_r = sheet.bind("M_r", I_z + M_c * x_G + motion.water.J_z * J_z * unit * motion.L**2, _EQUATIONS, "kg m^2")
    M_s = M_v if motion.water is DEEP else sheet.bind("M_s", m + m_y * unit, f"{_EQUATIONS}, deep water", "kg")
    return _Masses(M_u, M_v, M_c, M_r, m, m_y, unit, M_s)


def _with_centripetal(
    sheet: Sheet, motion: ShipFlow, masses: _Masses, X: sp.Symbol, Y: sp.Symbol, N: sp.Symbol
) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Return X_m, Y_m, N_m: what a balance feels that holds the ship in steady motion."""
    u_r = sheet.bind("u_r", motion.u * motion.r, _EQUATIONS, "m/s^2")
    X_m = sheet.bind("X_m", X + masses.M_s * motion.v * motion.r + masses.M_c * motion.r**2, _EQUATIONS, "N")
    Y_m = sheet.bind("Y_m", Y - masses.M_u * u_r, _EQUATIONS, "N")
    return X_m, Y_m, sheet.bind("N_m", N - masses.M_c * u_r, _EQUATIONS, "N m")


def _accelerations(sheet: Sheet, motion: ShipFlow, X: sp.Symbol, Y: sp.Symbol, N: sp.Symbol) -> None:
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
    return _in_the_plane(Sheet("mmg", YASUKAWA, "MMG standard method with propeller, rudder and wind"))


@cache
def mmg_twin() -> Model:
    """Return the method for two screws with a rudder behind each; hull coefficients are free.

    As `mmg`, with n and delta the means of both sides and the inputs n_difference [rps] and delta_difference [rad],
    port less starboard, zero where they are not recorded. y_P [m] is the place of screws and rudders off the centre
    line; D_P, A_R and H_R are those of one. Output thrust is that of both. No side forces of a single screw.
    """
    sheet = Sheet("mmg_twin", f"{YASUKAWA}; {LEE}", "MMG with two screws, two rudders and wind")
    return _in_the_plane(sheet, is_twin=True)


@cache
def mmg_shallow() -> Model:
    """Return the method in water of the depth that the input depth [m] says, 0 or not recorded: deep.

    As `mmg`, whose equations it has in deep water. B [m] and C_b come from the ship; h_NAME is the share of the
    published change of a coefficient with depth, 1 as published.
    """
    sheet = Sheet("mmg_shallow", f"{YASUKAWA}; {KIJIMA}; {LI_WU}", "MMG in water of any depth")
    return _in_the_plane(sheet, is_shallow=True)


def _in_the_plane(sheet: Sheet, *, is_twin: bool = False, is_shallow: bool = False) -> Model:
    """The model in surge, sway and yaw."""
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    delta, n = sheet.input("delta"), sheet.input("n")
    motion = _motion(sheet, u, v, r, delta, is_shallow=is_shallow)
    current = pose_rates(sheet, u, v, r, psi, x0, y0)
    X_H, Y_H, N_H = _hull(sheet, motion)
    by, rudder = (propelled_by_two if is_twin else propelled_by_one)(sheet, motion, n)
    wind = wind_force(sheet, (u, v, psi), current, motion.L, motion.U_0, SERIES)
    X = sheet.bind("X_sum", X_H + by.X + rudder.X + wind.X, f"{YASUKAWA}, X of the equations of motion", "N")
    Y = sheet.bind("Y_sum", Y_H + by.Y + rudder.Y + wind.Y, f"{YASUKAWA}, Y of the equations of motion", "N")
    N = sheet.bind("N_sum", N_H + by.N + rudder.N + wind.N, f"{YASUKAWA}, N_m of the equations of motion", "N m")
    _accelerations(sheet, motion, X, Y, N)
    return sheet.model()


# With roll: the side forces of hull and rudder act below G, and heel changes those of the hull.

ROLLING = "Yasukawa, Sakuno & Yoshimura 2019, J Mar Sci Technol 24, 1280-1296, doi 10.1007/s00773-019-00625-4"
HEEL = (*(f"X_{t}" for t in ("phiphi", "vphi", "rphi")), *(f"{f}_{t}" for f in "YN" for t in ROLL_TERMS))
HEEL_FREE = ("Y_phi", "N_phi")


def _heeled(sheet: Sheet, motion: ShipFlow, ship: ShipMotion) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Return what heel adds to surge and sway force and yaw moment of the hull."""
    c = {name: hull_coefficient(sheet, name, free=name in HEEL_FREE) for name in HEEL}
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


def _roll_inertia(sheet: Sheet, motion: ShipFlow, masses: _Masses) -> ShipInertia:
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
    by, rudder = propelled_by_one(sheet, motion, n)
    wind = wind_on_rolling_ship(sheet, ship, current, motion.L, motion.U_0)
    X = sheet.bind("X_sum", X_H + X_F + by.X + rudder.X + wind.X, f"{ROLLING}, X of the equations of motion", "N")
    Y = sheet.bind("Y_sum", Y_H + Y_F + by.Y + rudder.Y + wind.Y, f"{ROLLING}, Y of the equations of motion", "N")
    N = sheet.bind("N_sum", N_H + N_F + by.N + rudder.N + wind.N, f"{ROLLING}, N of the equations of motion", "N m")
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
    levers = motion.L * (z_H * (Y_H + Y_F) + z_R * rudder.Y)
    K = sheet.bind("K_sum", static - levers + wind.K, f"{ROLLING}, side force times its lever", "N m")
    coupled_accelerations(sheet, ship, inertia, ShipForces(X_m, Y_m, K, N_m))
    model = sheet.model()
    return model.with_parameters(model.parameters.freed("b_1", "b_2"))
