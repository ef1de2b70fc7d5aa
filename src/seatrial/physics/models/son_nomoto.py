"""Manoeuvring and rolling of a container ship in four degrees of freedom (Son & Nomoto 1981): surge, sway, roll, yaw.

Axes at G, x forward, y starboard, z down, psi clockwise; positive rudder turns to starboard, phi and p are positive to
starboard. Hull forces are a series in v' = v/U, r' = r L/U, p' = p L/U and heel; forces in rho/2 L^2 U^2, moments in
rho/2 L^3 U^2, masses in rho/2 L^3 and inertias in rho/2 L^5. Propeller and rudder are modular, for a ship that goes
ahead with the screw turning ahead. Wind, fins and waves are those of `roll_coupling`, neutral at their default values.

Of the secondary print (Fossen 1994, appendix E.1.3) u_P' = cos(v') [...] is read as cos(beta) [...] = u' [...].
"""

from dataclasses import dataclass
from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.abkowitz import taylor_series
from seatrial.physics.models.forces import EXTENSION
from seatrial.physics.models.roll_coupling import (
    ROLL_TERMS,
    SON_NOMOTO,
    ShipForces,
    ShipInertia,
    ShipMotion,
    coupled_accelerations,
    roll_moment,
    rolling_motion,
    wind_on_rolling_ship,
)

X_TERMS = ("uu", "vr", "vv", "rr", "phiphi")
CUBIC_TERMS = ("vvv", "rrr", "vvr", "vrr")
SIDE_TERMS = ("v", "r", "p", *CUBIC_TERMS, *ROLL_TERMS)
"""Of sway force, roll and yaw moment."""
FREE = (
    "X_uu", "X_vr", "X_vv", "X_rr", "K_v", "K_r", "K_p",
    *(f"{force}_{term}" for force in "YN" for term in ("v", "r", *CUBIC_TERMS)),
)  # fmt: skip
"""What turns, zigzags and decays of one ship identify together, besides GM."""


@dataclass(frozen=True)
class _Flow:
    """Scales and dimensionless velocities that every force needs; q_U: rho/2 L^2 U^2."""

    L: sp.Symbol
    rho: sp.Symbol
    U_0: sp.Symbol
    U: sp.Symbol
    q: sp.Symbol
    q_U: sp.Symbol
    u_p: sp.Symbol
    v_p: sp.Symbol
    r_p: sp.Symbol
    p_p: sp.Symbol


def _flow(sheet: Sheet, motion: ShipMotion) -> _Flow:
    L = sheet.parameter("L", unit="m", meaning="length between perpendiculars")
    rho = sheet.parameter("rho", unit="kg/m^3", meaning="water density")
    U_0 = sheet.parameter("U_0", 1e-3, "m/s", "speed below which denominators are rounded off", EXTENSION)
    U = sheet.bind("U", sp.sqrt(motion.u**2 + motion.v**2 + U_0**2), f"{SON_NOMOTO}, speed U", "m/s")
    q = sheet.bind("q", rho / 2 * L**2, f"{SON_NOMOTO}, dimensions of forces", "kg/m")
    slowness = sheet.bind("s_U", 1 / U, "slowness 1/U", "s/m")
    lengths = sheet.bind("L_U", L * slowness, "time in which a length is travelled, L/U", "s")
    return _Flow(
        L, rho, U_0, U, q,
        q_U=sheet.bind("q_U", q * U**2, f"{SON_NOMOTO}, dimensions of forces", "N"),
        u_p=sheet.bind("u_p", motion.u * slowness, "u'"),
        v_p=sheet.bind("v_p", motion.v * slowness, "v'"),
        r_p=sheet.bind("r_p", motion.r * lengths, "r'"),
        p_p=sheet.bind("p_p", motion.p * lengths, "p'"),
    )  # fmt: skip


def _hull(sheet: Sheet, motion: ShipMotion, flow: _Flow) -> ShipForces:
    variables = {"u": flow.u_p, "v": flow.v_p, "r": flow.r_p, "p": flow.p_p, "phi": motion.heel}
    X, Y, K, N = (
        taylor_series(sheet, force, X_TERMS if force == "X" else SIDE_TERMS, variables, FREE) for force in "XYKN"
    )
    source, arm = f"{SON_NOMOTO}, hull", flow.q_U * flow.L
    return ShipForces(
        sheet.bind("X_H", flow.q_U * X, source, "N"),
        sheet.bind("Y_H", flow.q_U * Y, source, "N"),
        sheet.bind("K_H", arm * K, source, "N m"),
        sheet.bind("N_H", arm * N, source, "N m"),
    )


@dataclass(frozen=True)
class _Propeller:
    """Thrust [N], T/(rho D_P^2) [m^2/s^2], inflow u_P [m/s]."""

    thrust: sp.Symbol
    head: sp.Symbol
    u_P: sp.Symbol


def _propeller(sheet: Sheet, motion: ShipMotion, flow: _Flow) -> _Propeller:
    n = sheet.input("n")
    D_P = sheet.parameter("D_P", unit="m", meaning="propeller diameter")
    w_P = sheet.parameter("w_P0", meaning="wake fraction straight ahead", latex="w_{P0}")
    tau = sheet.parameter("tau_P", meaning="change of wake, square of the drift at the propeller", latex=r"\tau")
    x_P = sheet.parameter("x_P_prime", meaning="propeller position over L", latex="x'_P")
    k_0, k_1 = (sheet.parameter(f"k_{i}", meaning=f"K_T polynomial, J_P^{i}") for i in range(2))
    inflow = motion.u * (1 - w_P + tau * (flow.v_p + x_P * flow.r_p) ** 2)
    u_P = sheet.bind("u_P", inflow, f"{SON_NOMOTO}, u_P' = cos(beta) (1 - w_P + ...)", "m/s")
    n_D = sheet.bind("n_D", n * D_P, "n D_P", "m/s")
    head = sheet.bind("z_T", sp.Abs(n_D) * (k_0 * n_D + k_1 * u_P), f"{SON_NOMOTO}, T/(rho D_P^2)", "m^2/s^2")
    thrust = sheet.output("thrust", flow.rho * D_P**2 * head, f"{SON_NOMOTO}, T = rho D_P^4 K_T n|n|", "N")
    return _Propeller(thrust, head, u_P)


def _normal_force(sheet: Sheet, flow: _Flow, propeller: _Propeller, sine: sp.Symbol, cosine: sp.Symbol) -> sp.Symbol:
    A_R = sheet.parameter("A_R", unit="m^2", meaning="movable rudder area")
    f_alpha = sheet.parameter("f_alpha", meaning="gradient of the rudder's lift", latex=r"f_\alpha")
    epsilon = sheet.parameter("epsilon", meaning="wake ratio, rudder over propeller", latex=r"\varepsilon")
    kappa = sheet.parameter("kappa", meaning="slipstream acceleration at the rudder", latex=r"\kappa")
    gamma = sheet.parameter("gamma_R", meaning="flow straightening of drift", latex=r"\gamma")
    c_r, c_rrr, c_rrv = (
        sheet.parameter(f"c_R{term}", meaning=f"flow at the rudder from {term}", latex=f"c_{{R{term}}}")
        for term in ("r", "rrr", "rrv")
    )
    v_p, r_p = flow.v_p, flow.r_p
    side = gamma * v_p + c_r * r_p + c_rrr * r_p**3 + c_rrv * r_p**2 * v_p
    v_R = sheet.bind("v_R", flow.U * side, f"{SON_NOMOTO}, v_R'", "m/s")
    slipstream = propeller.u_P**2 + 8 / sp.pi * kappa * propeller.head  # 8 / pi: momentum theory, as printed
    z = sheet.bind("z", slipstream, f"{SON_NOMOTO}, u_R, square of the slipstream", "m^2/s^2")
    ahead = sp.Piecewise((z, z > 0), (sp.Integer(0), True))
    u_R = sheet.bind("u_R", epsilon * sp.sqrt(ahead + flow.U_0**2), f"{SON_NOMOTO}, u_R'", "m/s")
    U_R = sheet.bind("U_R", sp.sqrt(u_R**2 + v_R**2), f"{SON_NOMOTO}, U_R'", "m/s")
    normal = -flow.rho / 2 * A_R * f_alpha * U_R * (u_R * sine + v_R * cosine)
    return sheet.bind("F_N", normal, f"{SON_NOMOTO}, F_N: U_R sin(alpha_R) = u_R sin(delta) + v_R cos(delta)", "N")


def _rudder(sheet: Sheet, flow: _Flow, propeller: _Propeller) -> ShipForces:
    zero = sheet.parameter("delta_0", 0.0, "rad", "added to the recorded rudder angle", EXTENSION, scale=0.02)
    delta_R = sheet.bind("delta_R", sheet.input("delta") + zero, "rudder angle with its zero", "rad")
    sine = sheet.bind("sin_delta", sp.sin(delta_R), "of the rudder angle")
    cosine = sheet.bind("cos_delta", sp.cos(delta_R), "of the rudder angle")
    F_N = _normal_force(sheet, flow, propeller, sine, cosine)
    a_H = sheet.parameter("a_H", meaning="rudder force increase", latex="a_H")
    c_RX = sheet.parameter("c_RX", meaning="share of the rudder's force in surge", latex="c_{RX}")
    x_R = sheet.parameter("x_R_prime", meaning="rudder position over L", latex="x'_R")
    x_H = sheet.parameter("x_H_prime", meaning="position of the additional force over L", latex="x'_H")
    z_R = sheet.parameter("z_R_prime", meaning="depth of the rudder's force below G over L", latex="z'_R")
    F_C = sheet.bind("F_C", F_N * cosine, "athwartships part of the normal force", "N")
    source = f"{SON_NOMOTO}, rudder"
    return ShipForces(
        sheet.bind("X_R", c_RX * F_N * sine, source, "N"),
        sheet.bind("Y_R", (1 + a_H) * F_C, source, "N"),
        sheet.bind("K_R", -(1 + a_H) * z_R * flow.L * F_C, source, "N m"),
        sheet.bind("N_R", (x_R + a_H * x_H) * flow.L * F_C, source, "N m"),
    )


_ADDED = {
    "m_x_prime": ("surge added mass over rho/2 L^3", "m'_x"),
    "m_y_prime": ("sway added mass over rho/2 L^3", "m'_y"),
    "J_z_prime": ("yaw added inertia over rho/2 L^5", "J'_z"),
    "J_x_prime": ("roll added inertia over rho/2 L^5", "J'_x"),
    "l_x_prime": ("depth of the surge added mass below G over L", "l'_x"),
    "l_y_prime": ("depth of the sway added mass below G over L", "l'_y"),
    "alpha_y_prime": ("place of the sway added mass forward of G over L", r"\alpha'_y"),
}
_EQUATIONS = f"{SON_NOMOTO}, equations of motion"


def _inertia(sheet: Sheet, flow: _Flow) -> tuple[ShipInertia, sp.Symbol, sp.Symbol]:
    """Return masses and couplings, the mass of the ship, and m_x l_x [kg m]."""
    m = sheet.parameter("m", unit="kg", meaning="mass")
    I_z = sheet.parameter("I_z", unit="kg m^2", meaning="yaw inertia about the centre of gravity")
    I_x = sheet.parameter("I_x", unit="kg m^2", meaning="roll inertia about the centre of gravity")
    m_x, m_y, J_z, J_x, l_x, l_y, a_y = (
        sheet.parameter(name, meaning=meaning, latex=latex) for name, (meaning, latex) in _ADDED.items()
    )
    unit = sheet.bind("m_L", flow.q * flow.L, "rho/2 L^3", "kg")
    arm = sheet.bind("m_LL", unit * flow.L, "rho/2 L^4", "kg m")
    M_vp = sheet.bind("M_vp", -m_y * l_y * arm, _EQUATIONS, "kg m")
    M_vr = sheet.bind("M_vr", m_y * a_y * arm, _EQUATIONS, "kg m")
    inertia = ShipInertia(
        M_u=sheet.bind("M_u", m + m_x * unit, _EQUATIONS, "kg"),
        M_v=sheet.bind("M_v", m + m_y * unit, _EQUATIONS, "kg"),
        M_p=sheet.bind("M_p", I_x + J_x * arm * flow.L, _EQUATIONS, "kg m^2"),
        M_r=sheet.bind("M_r", I_z + J_z * arm * flow.L, _EQUATIONS, "kg m^2"),
        M_vp=M_vp, M_pv=M_vp, M_vr=M_vr, M_rv=M_vr,
    )  # fmt: skip
    return inertia, m, sheet.bind("M_x", m_x * l_x * arm, _EQUATIONS, "kg m")


@cache
def son_nomoto() -> Model:
    """Return the model of a ship that turns and rolls; the coefficients of `FREE` and GM are free, all else fixed.

    States u, v, r [m/s, m/s, rad/s] through the water at G, psi [rad], x0, y0 [m], phi [rad], p [rad/s]; inputs n
    [rps, ahead], delta [rad, positive turns to starboard], alpha_w [rad], alpha_f [rad], wind_speed [m/s],
    wind_direction [rad, the heading it comes from]. Output thrust [N]. Parameters without a value come from the ship
    or the parameter set `s175`.
    """
    sheet = Sheet("son_nomoto", SON_NOMOTO, "container ship with roll, modular propeller and rudder")
    motion, current = rolling_motion(sheet)
    flow = _flow(sheet, motion)
    hull = _hull(sheet, motion, flow)
    propeller = _propeller(sheet, motion, flow)
    t_P = sheet.parameter("t_P", meaning="thrust deduction", latex="t_P")
    rudder = _rudder(sheet, flow, propeller)
    inertia, m, M_x = _inertia(sheet, flow)
    static = roll_moment(sheet, motion, inertia.M_p, m, flow.q_U * flow.L)
    wind = wind_on_rolling_ship(sheet, motion, current, flow.L, flow.U_0)
    X = sheet.bind("X_sum", hull.X + (1 - t_P) * propeller.thrust + rudder.X + wind.X, _EQUATIONS, "N")
    Y = sheet.bind("Y_sum", hull.Y + rudder.Y + wind.Y, _EQUATIONS, "N")
    K = sheet.bind("K_sum", hull.K + rudder.K + static + wind.K, _EQUATIONS, "N m")
    N = sheet.bind("N_sum", hull.N + rudder.N + wind.N, _EQUATIONS, "N m")
    u_r = sheet.bind("u_r", motion.u * motion.r, _EQUATIONS, "m/s^2")
    forces = ShipForces(
        sheet.bind("X_m", X + inertia.M_v * motion.v * motion.r, _EQUATIONS, "N"),
        sheet.bind("Y_m", Y - inertia.M_u * u_r, _EQUATIONS, "N"),
        sheet.bind("K_m", K + M_x * u_r, _EQUATIONS, "N m"),
        sheet.bind("N_m", N, _EQUATIONS, "N m"),
    )
    coupled_accelerations(sheet, motion, inertia, forces)
    return sheet.model()
