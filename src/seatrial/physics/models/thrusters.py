"""Craft with thrusters in three degrees of freedom: any number of them, fixed or azimuth (Fossen 2021, ch. 6 and 9).

    M dnu/dt + C(M) nu + D(nu) nu = sum of B_i T_i + rudders + wind,   nu = (u, v, r) through the water

Origin where the layout puts it, x forward, y to starboard, psi clockwise; coefficients carry the signs of Fossen: drag
is negative. Of mass and added mass, motions show sums only: M_u = m + m_x, M_v = m + m_y, M_r = I_z + J_z and
M_c = m x_G - Y_rdot. They also show only ratios to M_u, unless the thrust at some command is known in newtons: M_u is 1
until it is given, and forces are then those on each kg of it.
"""

import math
from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.forces import Current, PlanarForce, pose_rates, wind_force
from seatrial.physics.models.published import SYMMETRIC
from seatrial.physics.models.thruster_forces import ThrusterSheet, Water, craft_flow
from seatrial.physics.models.thruster_layout import CATAMARAN, Damping, ThrusterLayout

FOSSEN = "Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed."
HULL = f"{FOSSEN}, section 6.5, damping"
STRIPS = f"{FOSSEN}, section 6.4.3, cross-flow drag by strips (Faltinsen 1990)"
MASSES = f"{FOSSEN}, eqs. (6.14) and (6.40), M and C(M) in surge, sway and yaw"


@dataclass(frozen=True)
class _HullTerm:
    """A coefficient of the hull: its start on each kg of M_u for a hull of 1 m, and the power of the length with it.

    is_free: unless the trial says otherwise. Starts: a craft that loses its speed within some lengths; chosen.
    """

    start: float
    unit: str
    power: int
    meaning: str
    is_free: bool = True


_DIAGONAL = {
    "X_u": _HullTerm(0.0, "kg/s", -1, "surge damping, linear"),
    "X_uu": _HullTerm(-0.3, "kg/m", -1, "surge damping, quadratic"),
    "Y_v": _HullTerm(-1.0, "kg/s", -1, "sway damping, linear"),
    "Y_vv": _HullTerm(-1.0, "kg/m", -1, "sway damping, quadratic"),
    "N_r": _HullTerm(-0.2, "kg m^2/s", 1, "yaw damping, linear"),
    "N_rr": _HullTerm(-0.2, "kg m^2", 2, "yaw damping, quadratic"),
}
_COUPLED = {
    "N_ur": _HullTerm(0.0, "kg m", 1, "yaw damping that grows with speed, |u| r"),
    "N_uv": _HullTerm(0.0, "kg", 0, "yaw moment of u v"),
    "Y_ur": _HullTerm(0.0, "kg", 0, "side force of u r", is_free=False),
    "Y_uv": _HullTerm(0.0, "kg/m", -1, "sway damping that grows with speed, |u| v"),
    # lift -K |u| (v + x r) of a fin at x: Y_uv = -K, N_ur = -K x^2, and -K x for both of the couplings that are N_fin
    "N_fin": _HullTerm(0.0, "kg", 0, "yaw moment of |u| v and side force of |u| r: fins, skegs"),
    "N_v": _HullTerm(0.0, "kg m/s", 0, "yaw moment of v", is_free=False),
    "Y_r": _HullTerm(0.0, "kg m/s", 0, "side force of r", is_free=False),
    "N_u": _HullTerm(0.0, "kg m/s", 0, "yaw moment of u: a craft that pulls to one side", is_free=False),
    "N_uu": _HullTerm(0.0, "kg", 0, "yaw moment of |u| u", is_free=False),
    "Y_T": _HullTerm(0.0, "1", 0, "side force over the sum of thrusts", is_free=False),
    "Y_NT": _HullTerm(0.0, "1/m", -1, "side force over the thrusters' moment"),
}
_LIFT = frozenset({"N_ur", "Y_uv"})
"""Coefficients of lift against its own motion. As those of a hull at rest they take energy out of it: -U m_a and
-U x^2 m_a of a slender body with added mass m_a at its end x (Newman 1977, Marine Hydrodynamics, section 7.7)."""
COUPLINGS = tuple(_COUPLED)
"""Coefficients by which one motion acts on another, and thrusts on sway."""
# nodes of the Gauss-Legendre rule of eight points, its negative half (Abramowitz & Stegun 1964, table 25.4)
_STATIONS = (-0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498)
# weights of these nodes (the same table)
_WEIGHTS = (0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620)
_GYRATION = 0.1  # I_z + J_z over M_u L^2, start: a radius of gyration of about 0.3 L, water included; chosen
_BOUNDS = (0.05, 30.0)  # of masses and inertia over where they start: beyond, no craft; chosen
_LEAST_SWAY = 0.7
"""M_v over m, or over M_u where that is 1: m + m_y is no less than m, and no hull drags 0.43 of its mass along in
surge; chosen. Below, sway follows its force within a sample, and sensitivities at 10 Hz are rounding."""
_EMPTY = sp.Float(0.01)  # share of the nominal voltage below which a power of it is held; chosen
_SCALE = 0.05  # size of a coefficient that counts, on each kg of M_u for a hull of 1 m; chosen


def thrusters(layout: ThrusterLayout = CATAMARAN) -> Model:
    """Return the model of a craft with these thrusters; hull and thrust coefficients are free.

    States u, v, r [m/s, m/s, rad/s] through the water, psi, x0, y0, then the share of full command of each thruster
    with a lag and the direction of each that turns with one. Inputs: the channels the layout names, and voltage where
    it has it. Outputs T_name: thrust of each; every other binding is found by `Model.forces`.
    """
    sheet = Sheet("thrusters", FOSSEN, "craft with thrusters", layout.text())
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    voltage = _voltage_factor(sheet) if layout.has_voltage else sp.Integer(1)
    writer, water = ThrusterSheet(sheet, layout), Water(u, v, r, voltage)
    forces = [writer.force(thruster, water) for thruster in layout.thrusters]
    current = pose_rates(sheet, u, v, r, psi, x0, y0)
    X_T, Y_T, N_T = (
        sheet.bind(f"{axis}_T_sum", sp.Add(*(getattr(f, axis) for f in forces)), "all thrusters", unit)
        for axis, unit in (("X", "N"), ("Y", "N"), ("N", "N m"))
    )
    hull = _hull(sheet, layout, water, PlanarForce(X_T, Y_T, N_T))
    added_forces = _rudders_and_wind(writer, water, psi, current)
    X = sheet.bind("X_sum", sp.Add(hull.X, X_T, *(f.X for f in added_forces)), MASSES, "N")
    Y = sheet.bind("Y_sum", sp.Add(hull.Y, Y_T, *(f.Y for f in added_forces)), MASSES, "N")
    N = sheet.bind("N_sum", sp.Add(hull.N, N_T, *(f.N for f in added_forces)), MASSES, "N m")
    _accelerations(sheet, layout, water, PlanarForce(X, Y, N))
    return sheet.model()


def _rudders_and_wind(writer: ThrusterSheet, water: Water, psi: sp.Symbol, current: Current) -> list[PlanarForce]:
    """Forces of the rudders behind screws, and of the wind where the layout has it."""
    sheet, layout = writer.sheet, writer.layout
    if not layout.has_wind and not layout.has_rudders:
        return []
    L = sheet.parameter("L", layout.length, "m", "length", "layout")
    U_0 = sheet.parameter("U_0", 1e-3, "m/s", "speed below which denominators are rounded off", "chosen")
    forces: list[PlanarForce] = []
    if layout.has_rudders:
        forces += writer.rudder_forces(craft_flow(sheet, water.u, water.v, water.r, L, U_0))
    if layout.has_wind:
        forces.append(wind_force(sheet, (water.u, water.v, psi), current, L, U_0, SYMMETRIC, free=True))
    return forces


def _voltage_factor(sheet: Sheet) -> sp.Symbol:
    """Thrust over that at the nominal voltage, (V / V_0)^k_V."""
    V = sheet.input("voltage")
    V_0 = sheet.parameter("V_0", 12.0, "V", "nominal voltage", "chosen", lower=0.1)
    k_V = sheet.parameter("k_V", 0.0, "1", "power of the voltage", "none assumed", free=True, scale=0.5)
    share = sheet.bind("V_share", sp.Piecewise((V / V_0, V > _EMPTY * V_0), (_EMPTY, True)), "voltage over the nominal")
    return sheet.bind("V_factor", share**k_V, "thrust changes with a power of the voltage")


def _coefficient(sheet: Sheet, layout: ThrusterLayout, name: str, term: _HullTerm) -> sp.Symbol:
    free = term.is_free and (name in _DIAGONAL or layout.damping is Damping.FULL)
    size = layout.length**term.power * (layout.mass if "kg" in term.unit else 1.0)
    upper = 0.0 if name in _DIAGONAL or name in _LIFT else math.inf
    return sheet.parameter(
        name, term.start * size, term.unit, term.meaning, HULL, free=free, upper=upper, scale=_SCALE * size
    )


def _hull(sheet: Sheet, layout: ThrusterLayout, water: Water, thrust: PlanarForce) -> PlanarForce:
    """Damping and fins; terms even in u act astern as ahead. What the layout leaves out stays fixed at zero."""
    is_strips = layout.damping is Damping.CROSS_FLOW
    names = [n for n in (*_DIAGONAL, *_COUPLED) if not (is_strips and n in ("Y_vv", "N_rr"))]
    c = {name: _coefficient(sheet, layout, name, {**_DIAGONAL, **_COUPLED}[name]) for name in names}
    u, v, r = water.u, water.v, water.r
    fast = sheet.bind("u_abs", sp.Abs(u), HULL, "m/s")
    Y_flow, N_flow = _strips(sheet, layout, water) if is_strips else (
        c["Y_vv"] * sp.Abs(v) * v, c["N_rr"] * sp.Abs(r) * r
    )  # fmt: skip
    X = sheet.bind("X_H", c["X_u"] * u + c["X_uu"] * fast * u, HULL, "N")
    Y = sheet.bind(
        "Y_H",
        c["Y_v"] * v + c["Y_r"] * r + Y_flow + c["Y_uv"] * fast * v + c["Y_ur"] * u * r
        + c["N_fin"] * fast * r + c["Y_T"] * thrust.X + c["Y_NT"] * thrust.N,
        f"{HULL}; side force of the wash", "N",
    )  # fmt: skip
    N = sheet.bind(
        "N_H",
        c["N_r"] * r + c["N_v"] * v + N_flow + c["N_ur"] * fast * r + c["N_uv"] * u * v
        + c["N_fin"] * fast * v + c["N_u"] * u + c["N_uu"] * fast * u,
        HULL, "N m",
    )  # fmt: skip
    return PlanarForce(X, Y, N)


def _strips(sheet: Sheet, layout: ThrusterLayout, water: Water) -> tuple[sp.Symbol, sp.Symbol]:
    """Drag of the flow across the hull, -D_c |v + x r| (v + x r) on each metre, D_c = rho/2 d C_D."""
    half = 0.5 * layout.length
    D_c = sheet.parameter(
        "D_c", layout.mass / layout.length**2, "kg/m^2", "rho/2 d C_D, cross-flow drag on a metre", STRIPS, free=True,
        lower=0.0, scale=_SCALE * layout.mass,
    )  # fmt: skip
    Y: list[sp.Expr] = []
    N: list[sp.Expr] = []
    for i, (station, weight) in enumerate(
        zip((*_STATIONS, *(-s for s in _STATIONS)), (*_WEIGHTS, *_WEIGHTS), strict=True)
    ):
        x = sp.Float(half * station)
        flow = sheet.bind(f"flow_{i}", water.v + x * water.r, STRIPS, "m/s")
        drag = sheet.bind(f"strip_{i}", -sp.Float(half * weight) * D_c * sp.Abs(flow) * flow, STRIPS, "N")
        Y.append(drag)
        N.append(x * drag)
    return sheet.bind("Y_flow", sp.Add(*Y), STRIPS, "N"), sheet.bind("N_flow", sp.Add(*N), STRIPS, "N m")


def _accelerations(sheet: Sheet, layout: ThrusterLayout, water: Water, force: PlanarForce) -> None:
    """Accelerations; X_m, Y_m, N_m are forces with the Coriolis terms moved to their side."""
    u, v, r, m, (low, high) = water.u, water.v, water.r, layout.mass, _BOUNDS
    inertia = _GYRATION * m * layout.length**2
    M_u = sheet.parameter(
        "M_u", m, "kg", "m + m_x; 1: forces are those on each kg of it", MASSES, free=layout.has_bollard, lower=low * m,
        upper=high * m,
    )  # fmt: skip
    # where the search of M_v starts: half of m is added mass; chosen
    M_v = sheet.parameter("M_v", 1.5 * m, "kg", "m + m_y", MASSES, free=True, lower=_LEAST_SWAY * m, upper=high * m)
    M_c = sheet.parameter("M_c", 0.0, "kg m", "m x_G - Y_rdot", MASSES, scale=_SCALE * m * layout.length)
    M_r = sheet.parameter(
        "M_r", inertia, "kg m^2", "I_z + J_z", MASSES, free=True, lower=low * inertia, upper=high * inertia
    )
    D = sheet.bind("D_M", M_v * M_r - M_c**2, "determinant of the inertia matrix in sway and yaw", "kg^2 m^2")
    across = sheet.bind("P_v", M_v * v + M_c * r, MASSES, "kg m/s")
    u_r = sheet.bind("M_u_u", M_u * u, MASSES, "kg m/s")
    X_m = sheet.bind("X_m", force.X + across * r, MASSES, "N")
    Y_m = sheet.bind("Y_m", force.Y - u_r * r, MASSES, "N")
    N_m = sheet.bind("N_m", force.N - across * u + u_r * v, MASSES, "N m")
    sheet.rate(u, X_m / M_u, MASSES)
    sheet.rate(v, (Y_m * M_r - N_m * M_c) / D, f"{MASSES}, inverted")
    sheet.rate(r, (N_m * M_v - Y_m * M_c) / D, f"{MASSES}, inverted")
