"""The Taylor expansion of Abkowitz in three degrees of freedom, to third order, with every usual term.

Generated once; a subset of terms is a mask: the others stay fixed at zero. Axes at midship, x forward, y starboard;
positive rudder turns to starboard (so Y_d < 0 < N_d). u in a subscript is the deviation from the nominal speed U_n.
Rigid-body terms are written out, so the derivatives hold hydrodynamic forces only.

Prime system (SNAME 1950, "prime I"): X' = X / (rho/2 L^2 U^2), N' = N / (rho/2 L^3 U^2), mass rho/2 L^3,
v' = v / U, r' = r L / U, u' = (u - U_n) / U. `prime` = 1 takes the instantaneous speed for U (as Chislett &
Stroem-Tejsen 1965 for the Mariner), 0 the nominal speed U_n, which makes it a plain Taylor series.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.forces import derivative_meaning, pose_rates, variables_of
from seatrial.physics.models.roll_coupling import (
    ROLL_TERMS,
    ShipForces,
    ShipInertia,
    coupled_accelerations,
    roll_moment,
    rolling_motion,
)

ABKOWITZ = "Abkowitz 1964, Hydro- and Aerodynamics Laboratory report Hy-5"
TERMS_SOURCE = "Abkowitz 1964, Taylor series; terms of Chislett & Stroem-Tejsen 1965, Hy-6"
SNAME = "SNAME 1950, TR 1-5, prime system"

X_TERMS = (
    "0", "u", "uu", "uuu", "vv", "rr", "dd", "vr", "vd", "rd", "vvu", "rru", "ddu", "vru", "vdu", "rdu",
)  # fmt: skip
# 0u, 0uu: asymmetry that changes with u
Y_TERMS = N_TERMS = (
    "0", "0u", "0uu", "v", "r", "d", "vvv", "vvr", "vrr", "rrr", "vvd", "vdd", "ddd", "rrd", "rdd", "vrd",
    "vu", "vuu", "ru", "ruu", "du", "duu",
)  # fmt: skip
TERMS = (*(f"X_{t}" for t in X_TERMS), *(f"Y_{t}" for t in Y_TERMS), *(f"N_{t}" for t in N_TERMS))

STANDARD = (
    "X_u", "X_uu", "X_vv", "X_rr", "X_dd", "X_vr",
    "Y_0", "Y_v", "Y_r", "Y_d", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr",
    "N_0", "N_v", "N_r", "N_d", "N_vvv", "N_vvr", "N_vrr", "N_rrr",
)  # fmt: skip


_SIZES = {"X": 0.01, "Y": 0.01, "N": 0.01, "K": 1e-4}
"""Characteristic size of a dimensionless coefficient of a force; roll arms are some hundredths of L; chosen."""


def taylor_series(
    sheet: Sheet, force: str, terms: Sequence[str], variables: Mapping[str, sp.Symbol], free: Sequence[str] = ()
) -> sp.Expr:
    """Return the dimensionless sum of coefficient times variables over these terms of a force X, Y, K or N.

    variables: letter of a term, or ``phi`` -> symbol. free: names of coefficients that are free.
    """
    total = sp.Integer(0)
    for term in terms:
        name, letters = f"{force}_{term}", variables_of(term)
        sub = "".join({"d": r"\delta", "phi": r"\phi "}.get(letter, letter) for letter in letters)
        coefficient = sheet.parameter(
            name, 0.0, meaning=derivative_meaning(name), free=name in free, scale=_SIZES[force],
            latex=f"{force}'_{{{sub or term}}}",
        )  # fmt: skip
        total += coefficient * sp.Mul(*(variables[letter] for letter in letters))
    return total


@dataclass(frozen=True)
class _Expansion:
    """What both models share: length, mass and yaw inertia, the prime system, variables of the series, added masses."""

    L: sp.Symbol
    m: sp.Symbol
    x_G: sp.Symbol
    I_z: sp.Symbol
    rho: sp.Symbol
    U: sp.Symbol
    q: sp.Symbol
    variables: dict[str, sp.Symbol]
    added: dict[str, sp.Symbol]


@dataclass(frozen=True)
class _Inertia:
    """rho/2 L^3 and the elements of the inertia matrix."""

    unit: sp.Symbol
    M_u: sp.Expr
    M_vv: sp.Symbol
    M_vr: sp.Symbol
    M_rv: sp.Symbol
    M_rr: sp.Symbol


def _expansion(sheet: Sheet, u: sp.Symbol, v: sp.Symbol, r: sp.Symbol) -> _Expansion:
    delta = sheet.input("delta")
    L = sheet.parameter("L", unit="m", meaning="length between perpendiculars")
    m = sheet.parameter("m", unit="kg", meaning="mass")
    x_G = sheet.parameter("x_G", unit="m", meaning="centre of gravity forward of midship")
    I_z = sheet.parameter("I_z", unit="kg m^2", meaning="yaw inertia about the centre of gravity")
    rho = sheet.parameter("rho", unit="kg/m^3", meaning="water density")
    U_n = sheet.parameter("U_n", unit="m/s", meaning="nominal speed about which is expanded", latex="U_n")
    prime = sheet.parameter("prime", 1.0, meaning="1: instantaneous speed in the prime system, 0: nominal speed")
    delta_0 = sheet.parameter("delta_0", 0.0, "rad", "added to the recorded rudder angle", scale=0.02)
    added = {
        n: sheet.parameter(n, 0.0, latex=f"{n[0]}'_{{\\dot {n[2]}}}", meaning="added mass, negative", scale=0.01)
        for n in ("X_udot", "Y_vdot", "Y_rdot", "N_vdot", "N_rdot")
    }
    # 1e-12 m^2/s^2 keeps the root smooth at rest
    U = sheet.bind("U", sp.sqrt(prime * (u**2 + v**2) + (1 - prime) * U_n**2 + sp.Float(1e-12)), SNAME, "m/s")
    variables = {
        "u": sheet.bind("du_p", (u - U_n) / U, f"u', {SNAME}"),
        "v": sheet.bind("v_p", v / U, f"v', {SNAME}"),
        "r": sheet.bind("r_p", L * r / U, f"r', {SNAME}"),
        "d": sheet.bind("delta_R", delta + delta_0, "rudder angle with its zero", "rad"),
    }
    q = sheet.bind("q", rho / 2 * L**2 * U**2, SNAME, "N")
    return _Expansion(L, m, x_G, I_z, rho, U, q, variables, added)


def _inertia(sheet: Sheet, e: _Expansion) -> _Inertia:
    unit = sheet.bind("m_L", e.rho / 2 * e.L**3, SNAME, "kg")
    added, m, source = e.added, e.m, "Abkowitz 1964, inertia matrix"
    return _Inertia(
        unit, m - added["X_udot"] * unit,
        M_vv=sheet.bind("M_vv", m - added["Y_vdot"] * unit, source, "kg"),
        M_vr=sheet.bind("M_vr", m * e.x_G - added["Y_rdot"] * unit * e.L, source, "kg m"),
        M_rv=sheet.bind("M_rv", m * e.x_G - added["N_vdot"] * unit * e.L, source, "kg m"),
        M_rr=sheet.bind("M_rr", e.I_z + m * e.x_G**2 - added["N_rdot"] * unit * e.L**2, source, "kg m^2"),
    )  # fmt: skip


@cache
def _full_model() -> Model:
    sheet = Sheet("abkowitz", ABKOWITZ, "Taylor expansion to third order")
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    e = _expansion(sheet, u, v, r)
    X = sheet.bind("X_sum", e.q * taylor_series(sheet, "X", X_TERMS, e.variables), TERMS_SOURCE, "N")
    Y = sheet.bind("Y_sum", e.q * taylor_series(sheet, "Y", Y_TERMS, e.variables), TERMS_SOURCE, "N")
    N = sheet.bind("N_sum", e.q * e.L * taylor_series(sheet, "N", N_TERMS, e.variables), TERMS_SOURCE, "N m")
    i = _inertia(sheet, e)
    D = sheet.bind("D_M", i.M_vv * i.M_rr - i.M_vr * i.M_rv, "determinant of the inertia matrix", "kg^2 m^2")
    X_m, Y_m, N_m = _with_centripetal(sheet, e, (u, v, r), (X, Y, N))
    sheet.rate(u, X_m / i.M_u, "Abkowitz 1964, rigid body")
    sheet.rate(v, (Y_m * i.M_rr - N_m * i.M_vr) / D, "inertia matrix inverted")
    sheet.rate(r, (N_m * i.M_vv - Y_m * i.M_rv) / D, "inertia matrix inverted")
    pose_rates(sheet, u, v, r, psi, x0, y0)
    return sheet.model()


def _with_centripetal(
    sheet: Sheet, e: _Expansion, velocity: Sequence[sp.Symbol], forces: Sequence[sp.Symbol]
) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
    """Return X, Y, N with the centripetal terms of the mass at velocities u, v, r."""
    (u, v, r), (X, Y, N) = velocity, forces
    return (
        sheet.bind("X_m", X + e.m * (v * r + e.x_G * r**2), "Abkowitz 1964, rigid body", "N"),
        sheet.bind("Y_m", Y - e.m * u * r, "Abkowitz 1964, rigid body", "N"),
        sheet.bind("N_m", N - e.m * e.x_G * u * r, "Abkowitz 1964, rigid body", "N m"),
    )


def abkowitz(terms: Sequence[str] = STANDARD) -> Model:
    """Return the expansion with exactly the named derivatives free (of `TERMS`), all others fixed at zero.

    States u, v, r, psi, x0, y0 at midship; input delta [rad]. Ship particulars L, m, x_G, I_z, rho and the nominal
    speed U_n are given by the ship or the trial. Every subset has the same equations and the same compiled code.

    Raises:
        InputError: a term is unknown; the nearest is named.
    """
    model = _full_model()
    return model.with_parameters(model.parameters.only_free(terms))


# With roll: terms of roll rate and heel in every force, and the roll moment, about an axis at the height of G.

HEEL_TERMS = ("p", *ROLL_TERMS)
K_TERMS = ("0", "v", "r", "d", "vvv", "vvr", "vrr", "rrr", "ddd", "vu", "ru", "du", *HEEL_TERMS)
ROLLING_TERMS = (
    *TERMS, "X_phiphi", *(f"{force}_{term}" for force in "YN" for term in HEEL_TERMS), *(f"K_{t}" for t in K_TERMS),
)  # fmt: skip
ROLLING_STANDARD = (*STANDARD, "Y_phi", "N_phi", "K_0", "K_v", "K_r", "K_d", "K_p", "GM")


@cache
def _full_rolling_model() -> Model:
    sheet = Sheet("abkowitz_roll", ABKOWITZ, "Taylor expansion to third order with roll")
    ship, _ = rolling_motion(sheet)
    e = _expansion(sheet, ship.u, ship.v, ship.r)
    variables = e.variables | {"p": sheet.bind("p_p", e.L * ship.p / e.U, f"p', {SNAME}"), "phi": ship.heel}
    terms = {"X": (*X_TERMS, "phiphi"), "Y": (*Y_TERMS, *HEEL_TERMS), "K": K_TERMS, "N": (*N_TERMS, *HEEL_TERMS)}
    unit = {"X": e.q, "Y": e.q, "K": e.q * e.L, "N": e.q * e.L}
    X, Y, K, N = (
        sheet.bind(f"{force}_sum", unit[force] * taylor_series(sheet, force, terms[force], variables), TERMS_SOURCE,
                   "N" if force in "XY" else "N m")
        for force in "XYKN"
    )  # fmt: skip
    I_x = sheet.parameter("I_x", unit="kg m^2", meaning="roll inertia about the centre of gravity")
    Y_pdot, K_vdot, K_pdot = (
        sheet.parameter(n, 0.0, latex=f"{n[0]}'_{{\\dot {n[2]}}}", meaning="added mass", scale=scale)
        # characteristic sizes, 1; chosen
        for n, scale in (("Y_pdot", 1e-3), ("K_vdot", 1e-3), ("K_pdot", 1e-5))
    )
    i = _inertia(sheet, e)
    arm = i.unit * e.L
    M_p = sheet.bind("M_p", I_x - K_pdot * arm * e.L, "Abkowitz 1964, inertia matrix", "kg m^2")
    M_vp = sheet.bind("M_vp", -Y_pdot * arm, "Abkowitz 1964, inertia matrix", "kg m")
    M_pv = sheet.bind("M_pv", -K_vdot * arm, "Abkowitz 1964, inertia matrix", "kg m")
    M_u = sheet.bind("M_u", i.M_u, "Abkowitz 1964, inertia matrix", "kg")
    static = roll_moment(sheet, ship, M_p, e.m, unit["K"])
    X_m, Y_m, N_m = _with_centripetal(sheet, e, (ship.u, ship.v, ship.r), (X, Y, N))
    inertia = ShipInertia(M_u, i.M_vv, M_p, i.M_rr, M_vp, M_pv, i.M_vr, i.M_rv)
    coupled_accelerations(sheet, ship, inertia, ShipForces(X_m, Y_m, K + static, N_m))
    return sheet.model()


def abkowitz_roll(terms: Sequence[str] = ROLLING_STANDARD) -> Model:
    """Return the expansion with roll and the named derivatives free (of `ROLLING_TERMS`, or GM), others as they are.

    States u, v, r at midship, psi, x0, y0, phi [rad], p [rad/s]; inputs delta, alpha_w, alpha_f [rad]. Particulars are
    those of `abkowitz`, GM and the roll inertia I_x; derivatives start at zero.

    Raises:
        InputError: a term is unknown; the nearest is named.
    """
    model = _full_rolling_model()
    return model.with_parameters(model.parameters.only_free(terms))
