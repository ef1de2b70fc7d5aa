"""Kinematics and forces that models share: pose, rudder, wind; and what a derivative's name means."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import sympy as sp

from seatrial.core.equations import Sheet

# What a hydrodynamic coefficient stands for, from its name: ``Y_vvr`` multiplies v^2 r in the sway force.

_FORCES = {"X": "surge force", "Y": "sway force", "K": "roll moment", "N": "yaw moment", "R": "resistance"}
_VARIABLES = {"d": "delta"}


def variables_of(term: str) -> list[str]:
    """Return the variables that a coefficient multiplies, from the letters behind its underscore: ``vvphi``."""
    return re.findall("phi|[a-z]", term)


def derivative_meaning(name: str, term: str = "") -> str:
    """Return force or moment and what the coefficient multiplies there: ``sway force from v^2 r``.

    term: what it multiplies, where that is not the product of the letters behind the underscore, such as ``v|v|``.
    """
    force, _, letters = name.partition("_")
    powers = ((_VARIABLES.get(letter, letter), len(list(same))) for letter, same in groupby(variables_of(letters)))
    product = term or " ".join(f"{letter}^{power}" if power > 1 else letter for letter, power in powers)
    return f"{_FORCES[force]} from {product}" if product else f"{_FORCES[force]} straight ahead"


# Kinematics shared by every manoeuvring model: heading and position, with a uniform current as parameters.

KINEMATICS = "Fossen 2021, eq. (2.50), horizontal plane"


@dataclass(frozen=True)
class Current:
    """A uniform current towards north and east [m/s]."""

    north: sp.Symbol
    east: sp.Symbol


def pose_rates(
    sheet: Sheet, u: sp.Expr, v: sp.Expr, r: sp.Expr, psi: sp.Symbol, x0: sp.Symbol, y0: sp.Symbol
) -> Current:
    """Give the rates of psi, x0, y0 for velocities u, v through the water; return the current."""
    north = sheet.parameter("current_north", 0.0, "m/s", "current towards north", "none assumed", scale=0.1)
    east = sheet.parameter("current_east", 0.0, "m/s", "current towards east", "none assumed", scale=0.1)
    sheet.rate(psi, r, KINEMATICS)
    sheet.rate(x0, u * sp.cos(psi) - v * sp.sin(psi) + north, KINEMATICS)
    sheet.rate(y0, u * sp.sin(psi) + v * sp.cos(psi) + east, KINEMATICS)
    return Current(north, east)


# A force in the plane of motion, as symbols of a model's sheet.


@dataclass(frozen=True)
class PlanarForce:
    """Forces ahead and to starboard, and the moment about the origin."""

    X: sp.Symbol
    Y: sp.Symbol
    N: sp.Symbol


# Normal force of a rudder in the slipstream of a propeller (Yasukawa & Yoshimura 2015), shared by the models.

YASUKAWA = "Yasukawa & Yoshimura 2015, J Mar Sci Technol 20, 37-52"
EXTENSION = "extension for records"
KITAGAWA = "after Kitagawa et al. 2015, as used by Miyauchi et al. 2022, doi 10.1007/s00773-022-00889-3"


@dataclass(frozen=True)
class RudderFlow:
    """What flows past a rudder.

    Attributes:
        U, beta: speed and drift angle of the craft [m/s, rad]; r_L: yaw rate times length [m/s].
        U_0: speed below which denominators are rounded off; rho: density of water.
        n, n_D: rate of the propeller, and that times its diameter D_P; u_P: its axial inflow [m/s]; thrust: its own.
        straightening: factor on gamma_R, of the depth of the water.
    """

    U: sp.Symbol
    beta: sp.Symbol
    r_L: sp.Symbol
    U_0: sp.Symbol
    rho: sp.Symbol
    n: sp.Expr
    n_D: sp.Symbol
    D_P: sp.Symbol
    u_P: sp.Symbol
    thrust: sp.Symbol
    straightening: sp.Expr = sp.S.One


@dataclass(frozen=True)
class RudderCoefficients:
    """Area and span [m^2, m], lift gradient, slipstream at the rudder, straightening of the flow by either side."""

    A_R: sp.Symbol
    H_R: sp.Symbol
    f_alpha: sp.Symbol
    epsilon: sp.Symbol
    kappa: sp.Symbol
    kappa_astern: sp.Symbol
    gamma_plus: sp.Symbol
    gamma_minus: sp.Symbol
    l_R: sp.Symbol


@dataclass(frozen=True)
class RudderForce:
    """Normal force of a rudder, sine and cosine of its angle."""

    F_N: sp.Symbol
    sine: sp.Symbol
    cosine: sp.Symbol


def normal_force(
    sheet: Sheet, flow: RudderFlow, rudder: RudderCoefficients, delta: sp.Expr, suffix: str = "", *,
    is_mirrored: bool = False,
) -> RudderForce:  # fmt: skip
    """Write the normal force at the angle delta [rad, positive turns to starboard]; bindings end in `suffix`.

    is_mirrored: whether left and right of the flow change places in its coefficients.
    """
    u_R, v_R = _inflow(sheet, flow, rudder, suffix, is_mirrored=is_mirrored)
    sine = sheet.bind(f"sin_delta{suffix}", sp.sin(delta), "of the rudder angle")
    cosine = sheet.bind(f"cos_delta{suffix}", sp.cos(delta), "of the rudder angle")
    U_R = sheet.bind(f"U_R{suffix}", sp.sqrt(u_R**2 + v_R**2 + flow.U_0**2), f"{YASUKAWA}, U_R", "m/s")
    normal = flow.rho / 2 * rudder.A_R * rudder.f_alpha * U_R * (u_R * sine - v_R * cosine)
    source = f"{YASUKAWA}, normal force: U_R sin(alpha_R) = u_R sin(delta) - v_R cos(delta)"
    return RudderForce(sheet.bind(f"F_N{suffix}", normal, source, "N"), sine, cosine)


def _inflow(
    sheet: Sheet, flow: RudderFlow, rudder: RudderCoefficients, suffix: str, *, is_mirrored: bool
) -> tuple[sp.Symbol, sp.Symbol]:
    def bind(name: str, expression: sp.Expr, source: str, unit: str = "1") -> sp.Symbol:
        return sheet.bind(f"{name}{suffix}", expression, source, unit)

    eta = bind("eta", flow.D_P / rudder.H_R, f"{YASUKAWA}, eta = D_P / H_R")
    # momentum theory of the slipstream, Yasukawa and Yoshimura 2015
    slipstream = flow.u_P**2 + 8 / sp.pi * flow.thrust / (flow.rho * flow.D_P**2)
    z = bind("z", slipstream, "square of the slipstream", "m^2/s^2")
    z_root = bind("z_root", sp.sqrt(z**2 + flow.U_0**4), EXTENSION, "m^2/s^2")
    # where z is negative its sum with the root loses all digits; their product with the difference is U_0^4
    far_aft = sp.Piecewise((sp.sqrt((z + z_root) / 2), z >= 0), (flow.U_0**2 / sp.sqrt(2 * (z_root - z)), True))
    u_inf = bind("u_inf", far_aft, "slipstream far aft, positive part of z", "m/s")
    backwash = sp.Piecewise((sp.Integer(0), flow.n >= 0), (rudder.kappa_astern * flow.n_D, True))
    inside = rudder.epsilon * (flow.u_P + rudder.kappa * (u_inf - flow.u_P)) + backwash
    u_slip = bind("u_slip", inside, f"{YASUKAWA}, u_R inside the slipstream; astern {KITAGAWA}", "m/s")
    u_free = bind("u_free", rudder.epsilon * flow.u_P, f"{YASUKAWA}, u_R", "m/s")
    both = eta * u_slip * sp.Abs(u_slip) + (1 - eta) * u_free * sp.Abs(u_free)
    square = bind("u_R_2", both, f"{YASUKAWA}, u_R, squared", "m^2/s^2")
    root = bind("u_R_abs", sp.sqrt(square**2 + flow.U_0**4), EXTENSION, "m^2/s^2")
    u_R = bind("u_R", square / sp.sqrt(root), f"{YASUKAWA}, u_R", "m/s")
    v_B = bind("v_B", flow.U * flow.beta - rudder.l_R * flow.r_L, f"{YASUKAWA}, U beta_R", "m/s")
    plus, minus = rudder.gamma_plus, rudder.gamma_minus
    side = sp.Piecewise((minus if is_mirrored else plus, v_B > 0), (plus if is_mirrored else minus, True))
    gamma_R = bind("gamma_R", side, f"{YASUKAWA}, gamma_R by the side of beta_R")
    return u_R, bind("v_R", flow.straightening * gamma_R * v_B, f"{YASUKAWA}, v_R", "m/s")


# Force of the wind on areas above water: a Fourier series in its apparent direction, shared by the models.

WIND = "Fujiwara et al. 1998, J. Soc. Nav. Archit. Japan 183, 77-90, Fourier series in the apparent direction"
SERIES: dict[str, float] = dict.fromkeys(("C_X0", "C_X1", "C_X3", "C_Y1", "C_Y3", "C_N1", "C_N2", "C_N3"), 0.0)
"""Coefficients of the series; none acts until it has a value."""
_SCALE = 0.1
"""Size of a coefficient that counts; chosen."""


def wind_force(
    sheet: Sheet, velocity: tuple[sp.Symbol, sp.Symbol, sp.Symbol], current: Current, L: sp.Symbol, U_0: sp.Symbol,
    series: Mapping[str, float], *, free: bool = False,
) -> PlanarForce:  # fmt: skip
    """Return the wind force; the apparent wind is that of the ship over ground, current included.

    velocity: u, v through the water, and psi. series: coefficient -> value; those that are not named are zero.
    U_0: speed below which the direction is rounded off.
    """
    u, v, psi = velocity
    speed, direction = sheet.input("wind_speed"), sheet.input("wind_direction")
    A_T = sheet.parameter("A_T", 0.0, "m^2", "transverse projected area above water, 0: no wind force")
    A_L = sheet.parameter("A_L", 0.0, "m^2", "lateral projected area above water, 0: no wind force")
    rho_air = sheet.parameter("rho_air", 1.22, "kg/m^3", "air density", "ISO 2533, 15 degC", latex=r"\rho_A")
    c: dict[str, sp.Expr] = dict.fromkeys(SERIES, sp.Integer(0))
    for name, value in series.items():
        c[name] = sheet.parameter(
            name, value, meaning="wind force coefficient", free=free, scale=_SCALE, latex=f"C_{{{name[2:]}}}"
        )
    sine = sheet.bind("sin_psi", sp.sin(psi), "of the heading")
    cosine = sheet.bind("cos_psi", sp.cos(psi), "of the heading")
    air_north = sheet.bind("air_north", current.north + speed * sp.cos(direction), "water against air", "m/s")
    air_east = sheet.bind("air_east", current.east + speed * sp.sin(direction), "water against air", "m/s")
    u_A = sheet.bind("u_A", u + air_north * cosine + air_east * sine, "apparent wind from ahead", "m/s")
    v_A = sheet.bind("v_A", v - air_north * sine + air_east * cosine, "apparent wind from starboard", "m/s")
    V_A = sheet.bind("V_A", sp.sqrt(u_A**2 + v_A**2 + U_0**2), "apparent wind speed", "m/s")
    k = sheet.bind("cos_gamma", u_A / V_A, "of the apparent direction, off the bow")
    s = sheet.bind("sin_gamma", v_A / V_A, "of the apparent direction, positive from starboard")
    q_A = sheet.bind("q_A", rho_air / 2 * V_A**2, "dynamic pressure of the wind", "N/m^2")
    C_X = sheet.bind("C_X", c["C_X0"] + c["C_X1"] * k + c["C_X3"] * (4 * k**3 - 3 * k), WIND)
    C_Y = sheet.bind("C_Y", c["C_Y1"] * s + c["C_Y3"] * (3 * s - 4 * s**3), WIND)
    C_N = sheet.bind("C_N", c["C_N1"] * s + c["C_N2"] * 2 * s * k + c["C_N3"] * (3 * s - 4 * s**3), WIND)
    X_W = sheet.bind("X_W", q_A * A_T * C_X, WIND, "N")
    Y_W = sheet.bind("Y_W", q_A * A_L * C_Y, WIND, "N")
    return PlanarForce(X_W, Y_W, sheet.bind("N_W", q_A * A_L * L * C_N, WIND, "N m"))
