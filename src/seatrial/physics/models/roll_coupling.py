"""Roll joined to a model of the horizontal plane: states, what heels and rights the ship, coupled accelerations.

Body axes x forward, y starboard, z down; phi and p positive to starboard. A family of models takes its states from
`rolling_motion`, adds its own roll moment to that of `roll_moment`, and its rates from `coupled_accelerations`.

Extensions, neutral at their default values: damping at rest b_1, b_2 (as in the model `roll`), angle of rest phi_0,
fins, wave slope, lever of the wind. The restoring moment is linear, m g GM phi, as Son & Nomoto 1981 have it.
"""

from dataclasses import dataclass

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.forces import EXTENSION, SERIES, Current, pose_rates, wind_force
from seatrial.physics.models.roll import FINS, ITTC, LIST, WAVES

SON_NOMOTO = "Son & Nomoto 1981, J. Soc. Nav. Archit. Japan 150, 232-244"
RIGID_BODY = "Fossen 2021, section 3.3, rigid body in surge, sway, roll and yaw, no product of inertia"
EULER = "Fossen 2021, section 2.2, Euler angles without pitch"
GRAVITY = 9.81  # m/s^2; of the published ship, Fossen 1994, appendix E

ROLL_TERMS = ("phi", "vvphi", "vphiphi", "rrphi", "rphiphi")
"""Terms of heel in sway force, roll and yaw moment (Son & Nomoto 1981)."""


@dataclass(frozen=True)
class ShipMotion:
    """Symbols of a rolling ship's motion: velocities [m/s, rad/s], angles [rad], heel from the angle of rest."""

    u: sp.Symbol
    v: sp.Symbol
    r: sp.Symbol
    p: sp.Symbol
    psi: sp.Symbol
    phi: sp.Symbol
    heel: sp.Symbol


@dataclass(frozen=True)
class ShipForces:
    """Surge and sway force [N], roll and yaw moment [N m]."""

    X: sp.Expr
    Y: sp.Expr
    K: sp.Expr
    N: sp.Expr


@dataclass(frozen=True)
class ShipInertia:
    """Masses [kg], moments of inertia [kg m^2] and couplings [kg m], added ones included.

    Y = M_v dv + M_vp dp + M_vr dr; K = M_pv dv + M_p dp; N = M_rv dv + M_r dr.
    """

    M_u: sp.Symbol
    M_v: sp.Symbol
    M_p: sp.Symbol
    M_r: sp.Symbol
    M_vp: sp.Symbol
    M_pv: sp.Symbol
    M_vr: sp.Symbol
    M_rv: sp.Symbol


def rolling_motion(sheet: Sheet) -> tuple[ShipMotion, Current]:
    """Declare the states u v r psi x0 y0 phi p and write the rates of the angles and the place."""
    u, v, r, psi, x0, y0, phi, p = sheet.states("u v r psi x0 y0 phi p")
    phi_0 = sheet.parameter("phi_0", 0.0, "rad", "angle of rest", LIST, scale=0.01)  # rad; chosen, as in the model roll
    cosine = sheet.bind("cos_phi", sp.cos(phi), EULER)
    current = pose_rates(sheet, u, v * cosine, r * cosine, psi, x0, y0)
    sheet.rate(phi, p, EULER)
    heel = sheet.bind("phi_r", phi - phi_0, "from the angle of rest", "rad")
    return ShipMotion(u, v, r, p, psi, phi, heel), current


def roll_moment(sheet: Sheet, motion: ShipMotion, M_p: sp.Symbol, m: sp.Symbol, unit: sp.Expr) -> sp.Symbol:
    """Return restoring, damping at rest, fins and waves [N m]; unit: what makes a moment dimensionless [N m]."""
    GM = sheet.parameter("GM", unit="m", meaning="metacentric height", free=True)
    b_1 = sheet.parameter("b_1", 0.0, "1/s", "linear damping at rest, per unit of inertia", ITTC, scale=0.01)
    b_2 = sheet.parameter("b_2", 0.0, "1/rad", "quadratic damping, per unit of inertia", ITTC, scale=0.1)
    r_w = sheet.parameter("r_w", 1.0, "1", "effective share of the wave slope", WAVES)
    K_a = sheet.parameter("K_alpha_f", 0.0, "1", "roll moment from alpha_f", EXTENSION, scale=1e-4, latex=r"K'_\alpha")
    alpha_w, alpha_f = sheet.input("alpha_w"), sheet.input("alpha_f")
    stiffness = sheet.bind("c_phi", m * sp.Float(GRAVITY) * GM, f"{SON_NOMOTO}, W GM", "N m/rad")
    righting = stiffness * (r_w * alpha_w - motion.heel)
    damping = M_p * (b_1 + b_2 * sp.Abs(motion.p)) * motion.p
    return sheet.bind("K_S", righting - damping + unit * K_a * alpha_f, f"{SON_NOMOTO}; {ITTC}; {FINS}", "N m")


def wind_on_rolling_ship(
    sheet: Sheet, motion: ShipMotion, current: Current, L: sp.Symbol, U_0: sp.Symbol
) -> ShipForces:
    """Return the force of the wind, whose side force heels the ship by its height above the origin."""
    h_W = sheet.parameter("h_W", 0.0, "m", "height of the wind's side force above the origin", EXTENSION, scale=1.0)
    wind = wind_force(sheet, (motion.u, motion.v, motion.psi), current, L, U_0, SERIES)
    return ShipForces(wind.X, wind.Y, h_W * wind.Y, wind.N)


def coupled_accelerations(sheet: Sheet, motion: ShipMotion, inertia: ShipInertia, forces: ShipForces) -> None:
    """Write the rates of u, v, p and r; forces include the centripetal terms. Roll and yaw are eliminated from sway."""
    i = inertia
    roll_share = sheet.bind("c_vp", i.M_vp / i.M_p, "sway inertia from roll, over that of roll", "1/m")
    yaw_share = sheet.bind("c_vr", i.M_vr / i.M_r, "sway inertia from yaw, over that of yaw", "1/m")
    reduced = i.M_v - roll_share * i.M_pv - yaw_share * i.M_rv
    M_e = sheet.bind("M_e", reduced, "sway mass with roll and yaw eliminated", "kg")
    side = (forces.Y - roll_share * forces.K - yaw_share * forces.N) / M_e
    a_v = sheet.bind("a_v", side, f"{RIGID_BODY}, inertia matrix inverted", "m/s^2")
    sheet.rate(motion.u, forces.X / i.M_u, RIGID_BODY)
    sheet.rate(motion.v, a_v, RIGID_BODY)
    sheet.rate(motion.p, (forces.K - i.M_pv * a_v) / i.M_p, RIGID_BODY)
    sheet.rate(motion.r, (forces.N - i.M_rv * a_v) / i.M_r, RIGID_BODY)
