"""A ship section in beam waves: sway, heave and roll about its centre of gravity, each of them free or held.

(m + a22) v' + a24 p' + (b22 + d22 |v|) v + f22 sign(v) + b24 p + c22 y + c24 phi = F2, heave and roll alike; heave is
coupled with neither, as of a section alike to port and starboard (Newman 1977, Marine Hydrodynamics, section 6.15).
"""

import math
from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet

NEWMAN = "Newman 1977, Marine Hydrodynamics, section 6.15, a body alike to port and starboard"
VISCOUS = "Himeno 1981, Univ. of Michigan report 239, quadratic damping"
FRICTION = "dry friction of the guides (Coulomb), smooth about rest"
SPRINGS = "springs and restoring, linear"
HELD = "chosen: a held motion has no acceleration"
AT_REST = 1e-3
"""Velocity [m/s, rad/s] below which dry friction falls to zero; chosen."""
_MOTIONS = {"22": "sway", "24": "sway and roll", "33": "heave", "44": "roll"}
_UNITS = {
    "a": {"22": "kg", "24": "kg m", "33": "kg", "44": "kg m^2"},
    "b": {"22": "kg/s", "24": "kg m/s", "33": "kg/s", "44": "kg m^2/s"},
    "c": {"22": "N/m", "24": "N/rad", "33": "N/m", "44": "N m/rad"},
    "d": {"22": "kg/m", "33": "kg/m", "44": "kg m^2"},
    "f": {"22": "N", "33": "N", "44": "N m"},
}


@cache
def section() -> Model:
    """Return the section with states y0 v [sway], z z_dot [heave, down], phi p [roll], origin at its centre of gravity.

    Inputs F2 [N, starboard], F3 [N, up], M4 [N m, to starboard] of the waves, continuous between samples. Free: added
    masses a22 a24 a33 a44 and dampings b22 b24 b33 b44. Fixed unless freed: quadratic dampings d22 d33 d44, dry
    friction f22 f33 f44, springs c22 c24; s_2, s_3, s_4 are 1 where the section is free to sway, heave or roll, 0 where
    it is held.
    """
    sheet = Sheet("section", NEWMAN, "a ship section in beam waves")
    y, v, z, z_dot, phi, p = sheet.states("y0 v z z_dot phi p")
    F2, F3, M4 = sheet.input("F2"), sheet.input("F3", positive="down"), sheet.input("M4")
    m = sheet.parameter("m", unit="kg", meaning="mass")
    I_x = sheet.parameter("I_x", unit="kg m^2", meaning="moment of inertia in roll", latex="I_x")
    added, damping = _coefficients(sheet, "a", "added mass"), _coefficients(sheet, "b", "damping")
    stiffness = _coefficients(sheet, "c", "stiffness")
    sway, heave, roll = (_resisted(sheet, pair, velocity) for pair, velocity in (("22", v), ("33", z_dot), ("44", p)))
    free = [
        sheet.parameter(f"s_{n}", 1.0, "1", f"1 where the section may {motion}, 0 where it is held", HELD)
        for n, motion in (("2", "sway"), ("3", "heave"), ("4", "roll"))
    ]
    Y = sheet.bind("Y", F2 - damping["22"] * v - damping["24"] * p - stiffness["22"] * y - stiffness["24"] * phi - sway,
                   f"{NEWMAN}; {VISCOUS}", "N")  # fmt: skip
    Z = sheet.bind("Z", F3 - damping["33"] * z_dot - stiffness["33"] * z - heave, f"{NEWMAN}; {VISCOUS}", "N")
    K = sheet.bind("K", M4 - damping["24"] * v - damping["44"] * p - stiffness["24"] * y - stiffness["44"] * phi - roll,
                   f"{NEWMAN}; {VISCOUS}", "N m")  # fmt: skip
    M_2 = sheet.bind("m_2", m + added["22"], NEWMAN, "kg")
    M_4 = sheet.bind("I_4", I_x + added["44"], NEWMAN, "kg m^2")
    shared = sheet.bind("a_shared", free[0] * free[2] * added["24"], f"{NEWMAN}; {HELD}", "kg m")
    det = sheet.bind("det", M_2 * M_4 - shared**2, "determinant of the mass matrix", "kg^2 m^2")
    sheet.rate(y, v, NEWMAN)
    sheet.rate(v, free[0] * (M_4 * Y - shared * K) / det, f"{NEWMAN}, mass matrix inverted")
    sheet.rate(z, z_dot, NEWMAN)
    sheet.rate(z_dot, free[1] * Z / (m + added["33"]), NEWMAN)
    sheet.rate(phi, p, NEWMAN)
    sheet.rate(p, free[2] * (M_2 * K - shared * Y) / det, f"{NEWMAN}, mass matrix inverted")
    return sheet.model()


def _coefficients(sheet: Sheet, letter: str, meaning: str) -> dict[str, sp.Symbol]:
    """Declare a coefficient of each motion and the coupling of sway and roll, which is zero where nothing is known."""
    named = {}
    for pair, unit in _UNITS[letter].items():
        is_zero = pair == "24" or (letter, pair) == ("c", "22")
        named[pair] = sheet.parameter(
            f"{letter}{pair}", 0.0 if is_zero else math.nan, unit, f"{meaning}, {_MOTIONS[pair]}", free=letter != "c",
            scale=1.0 if is_zero else 0.0, latex=f"{letter}_{{{pair}}}",
        )  # fmt: skip
    return named


def _resisted(sheet: Sheet, pair: str, velocity: sp.Symbol) -> sp.Symbol:
    """Return quadratic damping and dry friction of a motion."""
    motion = _MOTIONS[pair]
    # scales: of the order of a section's in a flume, chosen
    d = sheet.parameter(f"d{pair}", 0.0, _UNITS["d"][pair], f"quadratic damping, {motion}", VISCOUS, scale=1.0,
                        latex=f"d_{{{pair}}}")  # fmt: skip
    f = sheet.parameter(f"f{pair}", 0.0, _UNITS["f"][pair], f"dry friction, {motion}", FRICTION, scale=1.0,
                        latex=f"f_{{{pair}}}")  # fmt: skip
    direction = velocity / sp.sqrt(velocity**2 + sp.Float(AT_REST) ** 2)
    resistance = d * sp.Abs(velocity) * velocity + f * direction
    return sheet.bind(f"R_{pair[0]}", resistance, f"{VISCOUS}; {FRICTION}", _UNITS["f"][pair])
