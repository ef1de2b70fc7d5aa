"""Force of the wind on areas above water: a Fourier series in its apparent direction, shared by the models."""

from collections.abc import Mapping

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.planar_force import PlanarForce
from seatrial.physics.models.pose import Current

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
