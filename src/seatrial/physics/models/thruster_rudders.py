"""Rudders behind the screws of a craft with thrusters, by the rudder of the MMG method."""

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.planar_force import PlanarForce
from seatrial.physics.models.rudder import YASUKAWA, RudderCoefficients, RudderFlow, normal_force
from seatrial.physics.models.thruster_layout import Rudder, Thruster

Coefficient = Callable[..., sp.Symbol]

# start value by Yasukawa & Yoshimura 2015, table 3 (gamma_R: between its two sides), meaning, and whether it is free
_COEFFICIENTS = {
    "epsilon": (1.09, "wake ratio, rudder over propeller", False),
    "kappa": (0.5, "slipstream acceleration at the rudder", False),
    "kappa_astern": (0.0, "flow at the rudder over n D, propeller astern", False),
    "gamma_R": (0.5, "flow straightening", True),
    "l_R_prime": (-0.71, "effective position of the rudder over L", False),
    "t_R": (0.387, "steering resistance deduction", False),
    "a_H": (0.312, "rudder force increase", False),
    "x_H_prime": (-0.464, "position of the additional force over L", False),
}
_SCALE = 0.05
"""Size of a dimensionless coefficient that counts; chosen."""


@dataclass(frozen=True)
class Screw:
    """The propeller ahead of a rudder: rate, rate times diameter, diameter, axial inflow, own thrust, water density."""

    n: sp.Expr
    n_D: sp.Symbol
    D: sp.Symbol
    u_P: sp.Symbol
    thrust: sp.Symbol
    rho: sp.Symbol


@dataclass(frozen=True)
class CraftFlow:
    """Speed, drift angle, yaw rate times length, length, and the speed below which denominators are rounded off."""

    U: sp.Symbol
    beta: sp.Symbol
    r_L: sp.Symbol
    L: sp.Symbol
    U_0: sp.Symbol


def craft_flow(sheet: Sheet, u: sp.Symbol, v: sp.Symbol, r: sp.Symbol, L: sp.Symbol, U_0: sp.Symbol) -> CraftFlow:
    """Write speed and drift angle of the craft as rudders and wind take them."""
    ahead = sheet.bind("u_0", sp.sqrt(u**2 + U_0**2), "rounded off at rest", "m/s")
    return CraftFlow(
        sheet.bind("U", sp.sqrt(u**2 + v**2 + U_0**2), f"{YASUKAWA}, speed U", "m/s"),
        sheet.bind("beta", -sp.atan(v / ahead), f"{YASUKAWA}, drift angle", "rad"),
        sheet.bind("r_L", L * r, "r' U", "m/s"), L, U_0,
    )  # fmt: skip


def lift_gradient(rudder: Rudder) -> float:
    """Return the slope of the normal force coefficient, 6.13 A / (A + 2.25) with aspect ratio A (Fujii & Tuda 1961)."""
    aspect = rudder.span**2 / rudder.area
    return 6.13 * aspect / (aspect + 2.25)  # Fujii & Tuda 1961, dimensionless fit to rudders


def rudder_force(
    sheet: Sheet, thruster: Thruster, rudder: Rudder, delta: sp.Symbol, screw: Screw, flow: CraftFlow,
    coefficient: Coefficient,
) -> PlanarForce:  # fmt: skip
    """Write the force of the rudder behind one screw.

    coefficient: declares one that thrusters may share (symbol, value, unit, meaning, and whether it is free).
    """
    name, suffix = thruster.name, f"_{thruster.name}"
    A_R = sheet.parameter(f"A_R_{name}", rudder.area, "m^2", f"movable area of the rudder behind '{name}'", "layout")
    H_R = sheet.parameter(f"H_R_{name}", rudder.span, "m", f"span of the rudder behind '{name}'", "layout")
    x_R = sheet.parameter(f"x_R_{name}", rudder.x, "m", f"place of the rudder behind '{name}' forward", "layout")
    f_alpha = coefficient(
        "f_alpha", lift_gradient(rudder), "1", "gradient of the rudder's lift", lower=0.0, scale=_SCALE
    )
    c = {
        symbol: coefficient(symbol, value, "1", meaning, free=free, scale=_SCALE)
        for symbol, (value, meaning, free) in _COEFFICIENTS.items()
    }
    coefficients = RudderCoefficients(
        A_R, H_R, f_alpha, c["epsilon"], c["kappa"], c["kappa_astern"], c["gamma_R"], c["gamma_R"], c["l_R_prime"]
    )
    past = RudderFlow(
        flow.U, flow.beta, flow.r_L, flow.U_0, screw.rho, screw.n, screw.n_D, screw.D, screw.u_P, screw.thrust
    )
    force = normal_force(sheet, past, coefficients, delta, suffix)
    F_C = sheet.bind(f"F_C{suffix}", force.F_N * force.cosine, "athwartships part of the normal force", "N")
    source = f"{YASUKAWA}, rudder forces"
    X = sheet.bind(f"X_R{suffix}", -(1 - c["t_R"]) * force.F_N * force.sine, source, "N")
    Y = sheet.bind(f"Y_R{suffix}", -(1 + c["a_H"]) * F_C, source, "N")
    y = sp.Symbol(f"y_{name}", real=True)
    N = -(x_R + c["a_H"] * c["x_H_prime"] * flow.L) * F_C - y * X
    return PlanarForce(
        X, Y, sheet.bind(f"N_R{suffix}", N, f"{source}; the side of a rudder off the centre line", "N m")
    )
