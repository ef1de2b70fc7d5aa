"""Simplified modular model of a waterjet craft in three degrees of freedom (Song et al. 2025), misprints corrected.

Origin at G, x forward, y starboard, psi clockwise. A positive nozzle angle gives a force to starboard at the stern and
so turns the craft to port.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.core.values.notation import TWIN_DIFFERENCES
from seatrial.physics.models.forces import PlanarForce, derivative_meaning, pose_rates

SONG = "Song et al. 2025, doi 10.19693/j.issn.1673-3185.03832"
ZHOU = "Zhou et al. 1983, through Song et al. 2025"
MOMENTUM = "momentum theorem of the jet that the bucket turns"
RHO = 1025.0  # kg/m^3, sea water
JET_AREA = 0.035  # m^2, of all jets of the published craft; chosen
LENGTH, DRAUGHT, MASS = 9.8, 0.71, 5540.0  # m, m, kg; Song et al. 2025, principal particulars

# Table 2, column CFD; N_v is -0.1708: with the printed sign the steady turn reverses and no zigzag finishes
TABLE_2 = {
    "X_uu": -0.03125, "X_vv": 0.04657, "X_rr": 0.00414,
    "Y_v": -0.27670, "Y_r": 0.08811, "Y_vv": -1.00740, "Y_vr": -0.16437, "Y_rr": -0.07020,
    "N_v": -0.17080, "N_r": -0.05240, "N_rr": -0.04350,
}  # fmt: skip
WATERJET_COEFFICIENTS = tuple(TABLE_2)
MODULUS_TERMS = {"Y_vv": "v|v|", "Y_vr": "|v| r", "Y_rr": "r|r|", "N_rr": "r|r|"}  # of eq. (2), as corrected


CANDIDATE_TERMS = ("N_vrr", "N_vvr")  # of eq. (2); Lasso takes them out, eq. (13), and table 2 has no values of them


@cache
def waterjet() -> Model:
    """Return the eleven-coefficient model with the published ship; free parameters are the coefficients of Table 2.

    States u, v, r [m/s, m/s, rad/s], psi, x0, y0; inputs nozzle angle delta [rad], jet velocity v_j [m/s].
    A uniform current (current_north, current_east) moves the water; u and v are through it.
    """
    return _craft("waterjet", ())


@cache
def waterjet_candidates() -> Model:
    """Return the model with all thirteen terms of eq. (2); those that table 2 does not have are free and zero.

    q L (N_vrr v (L r)^2 + N_vvr v^2 L r) / U in yaw makes both nondimensional.
    """
    return _craft("waterjet_candidates", CANDIDATE_TERMS)


@cache
def waterjet_twin() -> Model:
    """Return the eleven-coefficient model with two equal nozzles and a reversing bucket behind each.

    As `waterjet`, with delta and v_j the means of both sides and the inputs bucket, the mean share of the jets that
    the buckets send forward (0 to 1), and the differences of all three, port less starboard; those that are not
    recorded are zero. A_j is the area of one jet, y_T [m] its place off the centre line.
    """
    return _craft("waterjet_twin", (), is_twin=True)


@dataclass(frozen=True)
class _Jet:
    """One nozzle: angle, jet velocity, share that its bucket sends forward, place to starboard, suffix of its names."""

    delta: sp.Expr
    v_j: sp.Expr
    bucket: sp.Expr = sp.S.Zero
    y: sp.Expr = sp.S.Zero
    suffix: str = ""


def _twin_jets(sheet: Sheet, delta: sp.Symbol, v_j: sp.Symbol) -> tuple[_Jet, _Jet]:
    bucket = sheet.input("bucket")
    delta_d = sheet.input(TWIN_DIFFERENCES["delta"])
    v_j_d, bucket_d = (sheet.input(TWIN_DIFFERENCES[name]) for name in ("v_j", "bucket"))
    y_T = sheet.parameter("y_T", 0.12 * LENGTH, "m", "nozzles off the centre line", "chosen")
    port, starboard = (
        _Jet(delta + s * delta_d / 2, v_j + s * v_j_d / 2, bucket + s * bucket_d / 2, -s * y_T, suffix)
        for suffix, s in (("_port", 1), ("_starboard", -1))
    )
    return port, starboard


def _jet_forces(sheet: Sheet, jets: Sequence[_Jet], unit: sp.Expr, alpha_u: sp.Expr, x_T: sp.Symbol) -> PlanarForce:
    """Write the forces of nozzles with buckets; unit: rho A_j.

    The momentum that leaves: of the share b of a jet, which its bucket turns, c_b goes straight ahead.
    """
    c_b = sheet.parameter("c_b", 0.6, "1", "part of its momentum with which a turned jet goes ahead", "chosen")
    X, Y, N = [], [], []
    for jet in jets:
        cosine, sine, reach = sp.cos(jet.delta), sp.sin(jet.delta), unit * jet.v_j**2 * jet.bucket
        T = sheet.bind(f"T_jet{jet.suffix}", unit * jet.v_j * (jet.v_j - alpha_u), "eq. (3)", "N")
        X.append(sheet.bind(f"X_P{jet.suffix}", T * cosine - reach * (cosine + c_b), f"eq. (3); {MOMENTUM}", "N"))
        Y.append(sheet.bind(f"Y_P{jet.suffix}", (T - reach) * sine, f"eq. (3); {MOMENTUM}", "N"))
        N.append(x_T * Y[-1] - jet.y * X[-1])
    X_P = sheet.bind("X_P", sp.Add(*X), "both nozzles", "N")
    Y_P = sheet.bind("Y_P", sp.Add(*Y), "both nozzles", "N")
    return PlanarForce(X_P, Y_P, sheet.bind("N_P", sp.Add(*N), "moments of both nozzles", "N m"))


def _single_jet(
    sheet: Sheet, delta: sp.Symbol, unit: sp.Expr, v_j: sp.Symbol, alpha_u: sp.Expr, x_T: sp.Symbol
) -> PlanarForce:
    T = sheet.bind("T_jet", unit * v_j * (v_j - alpha_u), "eq. (3)", "N")
    X_P = sheet.bind("X_P", T * sp.cos(delta), "eq. (3)", "N")
    Y_P = sheet.bind("Y_P", T * sp.sin(delta), "eq. (3), alpha u in place of alpha v", "N")
    return PlanarForce(X_P, Y_P, sheet.bind("N_P", x_T * Y_P, "eq. (3)", "N m"))


def _craft(name: str, candidate_terms: tuple[str, ...], *, is_twin: bool = False) -> Model:
    """The craft with the terms of table 2 and these candidates."""
    meaning = "waterjet craft with two nozzles and buckets" if is_twin else "waterjet craft, simplified MMG"
    sheet = Sheet(name, SONG, meaning)
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    delta = sheet.input("delta", positive="port")
    v_j = sheet.input("v_j")
    L = sheet.parameter("L", LENGTH, "m", "length", f"{SONG}, table 1")
    d = sheet.parameter("d", DRAUGHT, "m", "draught", f"{SONG}, table 1")
    m = sheet.parameter("m", MASS, "kg", "mass", f"{SONG}, table 1")
    rho = sheet.parameter("rho", RHO, "kg/m^3", "water density", "sea water, chosen")
    I_z = sheet.parameter("I_z", MASS * (0.25 * LENGTH) ** 2, "kg m^2", "yaw inertia", "m (0.25 L)^2, chosen")
    m_x = sheet.parameter("m_x", 0.0281 * MASS, "kg", "surge added mass", ZHOU)
    m_y = sheet.parameter("m_y", 0.785 * MASS, "kg", "sway added mass", ZHOU)
    J_z = sheet.parameter("J_z", 0.0699 * MASS * LENGTH**2, "kg m^2", "yaw added inertia", ZHOU)
    A_j = sheet.parameter("A_j", JET_AREA / 2 if is_twin else JET_AREA, "m^2", "jet area", "chosen")
    alpha = sheet.parameter("alpha", 1.0, "1", "inflow fraction of the jet", "chosen")
    x_T = sheet.parameter("x_T", -0.45 * LENGTH, "m", "nozzle position forward of G", "chosen")

    def coefficient(name: str) -> sp.Symbol:
        source = f"{SONG}, table 2 (CFD)" if name in TABLE_2 else f"{SONG}, eq. (2); not in table 2"
        meaning = derivative_meaning(name, MODULUS_TERMS.get(name, ""))
        return sheet.parameter(
            name, TABLE_2.get(name, 0.0), meaning=meaning, source=source, free=True,
            latex=f"{name[0]}'_{{{name[2:]}}}",
        )  # fmt: skip

    # 1e-12 m^2/s^2 keeps the root smooth at rest
    U = sheet.bind("U", sp.sqrt(u**2 + v**2 + sp.Float(1e-12)), "speed through water", "m/s")
    q = sheet.bind("q", rho * L * d / 2, "q = rho L d / 2", "kg/m^2")
    r_L = sheet.bind("r_L", L * r, "L r", "m/s")
    X_H = sheet.bind(
        "X_H",
        q * (coefficient("X_uu") * u**2 + coefficient("X_vv") * v**2 + coefficient("X_rr") * r_L**2),
        "eq. (2)",
        "N",
    )
    Y_H = sheet.bind(
        "Y_H",
        q
        * (
            coefficient("Y_v") * v * U
            + coefficient("Y_r") * r_L * U
            + coefficient("Y_vv") * v * sp.Abs(v)
            + coefficient("Y_vr") * sp.Abs(v) * r_L
            + coefficient("Y_rr") * r_L * sp.Abs(r_L)
        ),
        "eq. (2), v|v| and r|r| corrected",
        "N",
    )
    yaw = coefficient("N_v") * v * U + coefficient("N_r") * r_L * U + coefficient("N_rr") * r_L * sp.Abs(r_L)
    features = {"N_vrr": v * r_L**2 / U, "N_vvr": v**2 * r_L / U}
    N_H = sheet.bind(
        "N_H",
        q * L * (yaw + sum(coefficient(term) * features[term] for term in candidate_terms)),
        "eq. (2), r|r| corrected",
        "N m",
    )
    unit, alpha_u = rho * A_j, alpha * u
    if is_twin:
        by = _jet_forces(sheet, _twin_jets(sheet, delta, v_j), unit, alpha_u, x_T)
    else:
        by = _single_jet(sheet, delta, unit, v_j, alpha_u, x_T)
    X = sheet.bind("X_sum", X_H + by.X, "all forces, eq. (1)", "N")
    Y = sheet.bind("Y_sum", Y_H + by.Y, "all forces, eq. (1)", "N")
    N = sheet.bind("N_sum", N_H + by.N, "all moments, eq. (1)", "N m")
    X_m = sheet.bind("X_m", (m + m_y) * v * r + X, "eq. (1), with the centripetal terms", "N")
    Y_m = sheet.bind("Y_m", -(m + m_x) * u * r + Y, "eq. (1), with the centripetal terms, u r corrected", "N")
    N_m = sheet.bind("N_m", N, "eq. (1), no centripetal terms about G", "N m")
    sheet.rate(u, X_m / (m + m_x), "eq. (1), parentheses corrected")
    sheet.rate(v, Y_m / (m + m_y), "eq. (1)")
    sheet.rate(r, N_m / (I_z + J_z), "eq. (1), parentheses corrected")
    pose_rates(sheet, u, v, r, psi, x0, y0)
    return sheet.model()
