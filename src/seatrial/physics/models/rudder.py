"""Normal force of a rudder in the slipstream of a propeller (Yasukawa & Yoshimura 2015), shared by the models.

Continued to astern speed and a propeller turning astern as the model `mmg` says.
"""

from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet

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


@dataclass(frozen=True)
class _Inflow:
    u: sp.Symbol
    v: sp.Symbol


def normal_force(
    sheet: Sheet, flow: RudderFlow, rudder: RudderCoefficients, delta: sp.Symbol, suffix: str = ""
) -> RudderForce:
    """Write the normal force at the angle delta [rad, positive turns to starboard]; bindings end in `suffix`."""
    inflow = _inflow(sheet, flow, rudder, suffix)
    sine = sheet.bind(f"sin_delta{suffix}", sp.sin(delta), "of the rudder angle")
    cosine = sheet.bind(f"cos_delta{suffix}", sp.cos(delta), "of the rudder angle")
    U_R = sheet.bind(f"U_R{suffix}", sp.sqrt(inflow.u**2 + inflow.v**2 + flow.U_0**2), f"{YASUKAWA}, U_R", "m/s")
    normal = flow.rho / 2 * rudder.A_R * rudder.f_alpha * U_R * (inflow.u * sine - inflow.v * cosine)
    source = f"{YASUKAWA}, normal force: U_R sin(alpha_R) = u_R sin(delta) - v_R cos(delta)"
    return RudderForce(sheet.bind(f"F_N{suffix}", normal, source, "N"), sine, cosine)


def _inflow(sheet: Sheet, flow: RudderFlow, rudder: RudderCoefficients, suffix: str) -> _Inflow:
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
    side = sp.Piecewise((rudder.gamma_plus, v_B > 0), (rudder.gamma_minus, True))
    gamma_R = bind("gamma_R", side, f"{YASUKAWA}, gamma_R by the side of beta_R")
    return _Inflow(u_R, bind("v_R", gamma_R * v_B, f"{YASUKAWA}, v_R", "m/s"))
