"""Kinematics shared by every manoeuvring model: heading and position, with a uniform current as parameters."""

from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet

KINEMATICS = "Fossen 2021, eq. (2.50), horizontal plane"


@dataclass(frozen=True)
class Current:
    """A uniform current towards north and east [m/s]."""

    north: sp.Symbol
    east: sp.Symbol


def pose_rates(
    sheet: Sheet, u: sp.Expr, v: sp.Expr, r: sp.Symbol, psi: sp.Symbol, x0: sp.Symbol, y0: sp.Symbol
) -> Current:
    """Give the rates of psi, x0, y0 for velocities u, v through the water; return the current."""
    north = sheet.parameter("current_north", 0.0, "m/s", "current towards north", "none assumed", scale=0.1)
    east = sheet.parameter("current_east", 0.0, "m/s", "current towards east", "none assumed", scale=0.1)
    sheet.rate(psi, r, KINEMATICS)
    sheet.rate(x0, u * sp.cos(psi) - v * sp.sin(psi) + north, KINEMATICS)
    sheet.rate(y0, u * sp.sin(psi) + v * sp.cos(psi) + east, KINEMATICS)
    return Current(north, east)
