"""Misprints that show when the equations are worked through: dimensions, equations (1), (14), (27), thrust."""

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.regress import RegressionMotion, features
from seatrial_studies.song2025.craft_models import TRUTH
from seatrial_studies.song2025.published import (
    APPROACH_SPEED,
    DRAUGHT,
    LENGTH,
    MotionEquation,
    Table2Column,
    printed_coefficients,
)

# powers of kg, m, s
Dimension = tuple[int, int, int]
FORCE_DIMENSION: Dimension = (1, 1, -2)
_Q_DIMENSION: Dimension = (1, -1, 0)
_SPEED_DIMENSION: Dimension = (0, 1, -1)
_FORCE_LETTERS = {MotionEquation.SURGE: "X", MotionEquation.SWAY: "Y", MotionEquation.YAW: "N"}


@dataclass(frozen=True)
class ForceDimensions:
    """Powers of kg, m, s: a force, Y_vv |v| of eq. (2) as printed, Y_vv v|v| (coefficients times rho L d / 2)."""

    force: Dimension
    printed: Dimension
    corrected: Dimension


def force_dimensions() -> ForceDimensions:
    """Y_rr |r| and N_rr |r| go the same way, with L r for v."""
    return ForceDimensions(
        FORCE_DIMENSION,
        _product(_Q_DIMENSION, _SPEED_DIMENSION),
        _product(_product(_Q_DIMENSION, _SPEED_DIMENSION), _SPEED_DIMENSION),
    )


def _product(a: Dimension, b: Dimension) -> Dimension:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def parenthesis_factors() -> dict[MotionEquation, float]:
    """How often the rate of each equation comes out too large if 1/m + m_x is read as eq. (1) prints it, in SI units.

    For the reciprocal of the sum, (1/m + m_x)(m + m_x) is 1; so for m_y and for I_zz, J_zz.
    """
    p = TRUTH.craft().parameters
    pairs = {MotionEquation.SURGE: ("m", "m_x"), MotionEquation.SWAY: ("m", "m_y"), MotionEquation.YAW: ("I_z", "J_z")}
    return {
        equation: (1.0 / p[own].value + p[added].value) * (p[own].value + p[added].value)
        for equation, (own, added) in pairs.items()
    }


@dataclass(frozen=True, eq=False)
class Equation14System:
    """One equation of (14) along a record: features (n, k) times coefficients (k,) = target (n,), all in m^2/s^2."""

    names: tuple[str, ...]
    matrix: Array
    target: Array

    def solve(self) -> dict[str, float]:
        """Return the least-squares solution by coefficient."""
        scale = np.sqrt(np.mean(self.matrix**2, axis=0))
        found = np.linalg.lstsq(self.matrix / scale, self.target)[0] / scale
        return dict(zip(self.names, map(float, found), strict=True))


def equation_14_systems(record: Record) -> dict[MotionEquation, Equation14System]:
    """Eq. (14) corrected, from the model, with exact accelerations in place of differences.

    Rates times total inertia over rho L d / 2 (yaw: over rho L^2 d / 2).
    """
    craft = TRUTH.craft()
    at = features(craft, RegressionMotion.from_record(craft, record))
    p = craft.parameters
    theta = np.array([item.value for item in p.free])
    q = 0.5 * p["rho"].value * LENGTH * DRAUGHT
    inertias = {
        MotionEquation.SURGE: (p["m"].value + p["m_x"].value) / q,
        MotionEquation.SWAY: (p["m"].value + p["m_y"].value) / q,
        MotionEquation.YAW: (p["I_z"].value + p["J_z"].value) / (q * LENGTH),
    }
    made = {}
    for equation, inertia in inertias.items():
        state = craft.states.index(equation)
        columns = [j for j, n in enumerate(p.free_names) if n[0] == _FORCE_LETTERS[equation]]
        matrix = inertia * at.slope[:, state][:, columns]
        made[equation] = Equation14System(tuple(p.free_names[j] for j in columns), matrix, matrix @ theta[columns])
    return made


@dataclass(frozen=True)
class Equation14Fit:
    """What least squares on noise-free data and exact accelerations makes of one reading of eq. (14).

    Attributes:
        errors: coefficient -> error in per cent of the truth.
        residual: rms of what is left over rms of the target.
    """

    variant: str
    errors: dict[str, float]
    residual: float


def equation_14_fits(record: Record) -> tuple[Equation14Fit, ...]:
    """Eq. (14) corrected, then each misprint alone: [u^2, v^2, r^2] L^2, the sign of u r, L^3 in yaw."""
    corrected = equation_14_systems(record)
    surge, sway, yaw = (corrected[e] for e in MotionEquation)
    L, p = LENGTH, TRUTH.craft().parameters
    q = 0.5 * p["rho"].value * L * DRAUGHT
    ur = (p["m"].value + p["m_x"].value) / q * record["u"] * record["r"]
    r_dot = (p["I_z"].value + p["J_z"].value) / (q * L) * _yaw_acceleration(record)
    return (
        *(_equation_14_fit(f"{_FORCE_LETTERS[e]}, corrected", corrected[e]) for e in MotionEquation),
        _equation_14_fit("X, [u^2, v^2, r^2] L^2", replace(surge, matrix=surge.matrix * np.array([L**2, L**2, 1.0]))),
        _equation_14_fit("Y, - (m' + m_x') L u r", replace(sway, target=sway.target - 2.0 * ur)),
        _equation_14_fit("N, (I' + J') L^3 dr/dt", replace(yaw, target=yaw.target + (L - 1.0) * r_dot)),
    )


def _yaw_acceleration(record: Record) -> Array:
    craft = TRUTH.craft()
    at = features(craft, RegressionMotion.from_record(craft, record))
    theta = np.array([item.value for item in craft.parameters.free])
    return (at.known_rates + at.slope @ theta)[:, craft.states.index(MotionEquation.YAW)]


def _equation_14_fit(variant: str, system: Equation14System) -> Equation14Fit:
    found = system.solve()
    p = TRUTH.craft().parameters
    errors = {name: 100.0 * (value / p[name].value - 1.0) for name, value in found.items()}
    left = system.target - system.matrix @ np.array(list(found.values()))
    return Equation14Fit(variant, errors, float(np.linalg.norm(left) / np.linalg.norm(system.target)))


@dataclass(frozen=True)
class Equation27Readings:
    """Readings of eq. (27) for a correlation matrix A, 2-norms.

    Attributes:
        with_inverse: |A| |A^-1|.
        by_singular_values: largest over smallest singular value, eq. (28): the same.
        without_inverse: |A| |A|, if the inverse is left out.
    """

    with_inverse: float
    by_singular_values: float
    without_inverse: float


def equation_27_readings(correlation: Array) -> Equation27Readings:
    """Return the readings of eq. (27) for a correlation matrix (k, k)."""
    size = float(np.linalg.norm(correlation, 2))
    values = np.linalg.svd(correlation, compute_uv=False)
    return Equation27Readings(
        size * float(np.linalg.norm(np.linalg.inv(correlation), 2)), float(values[0] / values[-1]), size**2
    )


@dataclass(frozen=True)
class Thrust:
    """Jet velocity [m/s] that balances resistance at the stated speed, eq. (2), (3), and the thrust [N]."""

    jet_velocity: float
    thrust: float


def balancing_thrust() -> Thrust:
    """Root of rho A_j v_j (v_j - alpha u) = rho L d / 2 |X_uu| u^2 at 0.8 m/s; the density cancels in the velocity."""
    p = TRUTH.craft().parameters
    half = 0.5 * p["alpha"].value * APPROACH_SPEED
    per_density = 0.5 * LENGTH * DRAUGHT * -printed_coefficients(Table2Column.CFD)["X_uu"] * APPROACH_SPEED**2
    return Thrust(half + math.sqrt(half**2 + per_density / p["A_j"].value), p["rho"].value * per_density)
