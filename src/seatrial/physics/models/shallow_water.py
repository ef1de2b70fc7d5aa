"""Shallow water: factors on the coefficients of hull, wake and rudder, from depth over draught.

    coefficient = coefficient in deep water (1 + share (published factor - 1))

Each has a share of its own: 1 is the change as published, 0 is none. In deep water, and where the depth is not
recorded, every factor is exactly 1. They are those that Tang et al. 2020 put together: Kijima et al. for hull, wake and
rudder, Li & Wu for the added masses. Terms of higher order, the force v r of surge and its added mass among them, squat
and waves of the ship's own are those of deep water, as no source of their change could be checked.
"""

from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.published import FURUKAWA, KIJIMA, LI_WU, SHARE_SPREAD, share_name

LEAST_RATIO = 1.1
"""Depth over draught down to which the factors change; in less water they stay what they are there; chosen."""

_ONE = sp.S.One
_Factor = sp.Expr | float


@dataclass(frozen=True)
class DepthFactors:
    """Factors on deep-water values; w_P and t_P: on 1 - w_P and 1 - t_P."""

    Y_v: sp.Expr = _ONE
    Y_r: sp.Expr = _ONE
    N_v: sp.Expr = _ONE
    N_r: sp.Expr = _ONE
    m_y: sp.Expr = _ONE
    J_z: sp.Expr = _ONE
    R_0: sp.Expr = _ONE
    w_P: sp.Expr = _ONE
    t_P: sp.Expr = _ONE
    gamma_R: sp.Expr = _ONE


DEEP = DepthFactors()


def depth_factors(sheet: Sheet, L: sp.Symbol, d: sp.Symbol) -> DepthFactors:
    """Declare the input depth [m, 0: deep], B, C_b and the shares, and write the factors.

    Depth is that of the water at rest, from surface to bottom.
    """
    depth = sheet.input("depth")
    B = sheet.parameter("B", unit="m", meaning="breadth")
    C_b = sheet.parameter("C_b", meaning="block coefficient", latex="C_b")
    least = sp.Float(LEAST_RATIO) * d
    ratio = sp.Piecewise((sp.Integer(0), depth <= 0), (d / depth, depth > least), (1 / sp.Float(LEAST_RATIO), True))
    d_h = sheet.bind("d_h", ratio, "draught over depth; 0: deep")
    published: dict[str, tuple[_Factor, str]] = {
        **_hull(sheet, d_h, 2 * d / L, C_b * B / L),
        **_added_masses(sheet, d_h, B / d),
    }
    published["R_0"] = (1 + sp.Float(0.388) * d_h**2, FURUKAWA)  # Furukawa et al. 2016, resistance
    # 1 - w_P, 1 - t_P and flow straightening over those in deep water
    published["w_P"] = (sp.cos(sp.Float(1.4) * C_b * d_h), KIJIMA)  # Kijima et al. 1990, wake
    published["t_P"] = (1 / (1 - sp.Float(0.2) * d_h + sp.Float(0.7295) * d_h**2), KIJIMA)  # the same, deduction
    straightening = 1 + sp.Float(0.0161) * d_h + sp.Float(4.4222) * d_h**2 - sp.Float(4.9825) * d_h**3  # the same
    published["gamma_R"] = (straightening, KIJIMA)
    return DepthFactors(**{name: _shared(sheet, name, *factor) for name, factor in published.items()})


def _shared(sheet: Sheet, name: str, factor: _Factor, source: str) -> sp.Symbol:
    share = sheet.parameter(
        share_name(name), 1.0, meaning=f"share of the published change of {name} with depth", source=source,
        scale=SHARE_SPREAD[name], latex=rf"h_{{{name.replace('_', ' ')}}}",
    )  # fmt: skip
    return sheet.bind(f"f_{name}", 1 + share * (factor - 1), source)


def _hull(sheet: Sheet, d_h: sp.Symbol, k: sp.Expr, fullness: sp.Expr) -> dict[str, tuple[_Factor, str]]:
    """Factors of the linear derivatives: the aspect ratio k becomes k / (d/2h + (x cot x)^q), x = pi d / 2h."""
    x = sp.pi * d_h / 2
    shut = sheet.bind("x_cot_x", sp.Piecewise((_ONE, d_h <= 0), (x / sp.tan(x), True)), f"{KIJIMA}, x cot x")
    slender = sheet.bind("x_cot_x_r", shut ** sp.Float(0.7), f"{KIJIMA}, exponent 0.7")

    def aspect(power: sp.Expr) -> sp.Expr:
        """The effective aspect ratio over that in deep water."""
        return 1 / (d_h / 2 + power)

    in_sway, in_drift = aspect(shut**3 / slender), aspect(shut * slender)  # exponents 2.3 and 1.7
    in_turn = sheet.bind("k_r", aspect(slender), f"{KIJIMA}, effective over geometric aspect ratio, yaw rate")
    lift, drag = sp.pi / 2 * k, sp.Float(1.4) * fullness  # Kijima et al. 1990, Y_v
    damping = sp.Float(0.54)  # Kijima et al. 1990, N_r
    return {
        "Y_v": ((lift * in_sway + drag) / (lift + drag), KIJIMA),
        "Y_r": (in_turn, KIJIMA),
        "N_v": (in_drift, KIJIMA),
        "N_r": (in_turn * (damping - k * in_turn) / (damping - k), KIJIMA),
    }


def _added_masses(sheet: Sheet, d_h: sp.Symbol, B_d: sp.Expr) -> dict[str, tuple[_Factor, str]]:
    clearance = sp.Piecewise((sp.Integer(0), d_h <= 0), ((d_h / (1 - d_h)) ** sp.Float(0.82), True))
    near = sheet.bind("c_h", clearance, f"{LI_WU}, (h/d - 1)^-0.82")
    sway = sp.Float(0.413) + sp.Float(0.0320) * B_d + sp.Float(0.129) * B_d**2  # Li & Wu 1990
    yaw = sp.Float(0.413) + sp.Float(0.0192) * B_d + sp.Float(0.00554) * B_d**2  # Li & Wu 1990
    return {"m_y": (1 + near * sway, LI_WU), "J_z": (1 + near * yaw, LI_WU)}
