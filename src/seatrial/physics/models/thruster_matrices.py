"""Matrices of M dnu/dt + C(M) nu + D(nu) nu = B T of a craft with thrusters, nu = (u, v, r), from its coefficients."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models.thruster_layout import Thruster


def coefficient_or_zero(model: Model, name: str) -> float:
    """Return the value of a coefficient, zero where the model has none of that name."""
    return model.parameters[name].value if name in model.parameters else 0.0


def inertia_matrix(model: Model) -> Array:
    """Return mass and added mass (3, 3) (Fossen 2021, eqs. (6.14) and (6.40), surge, sway and yaw)."""
    M_u, M_v, M_r, M_c = (coefficient_or_zero(model, f"M_{x}") for x in "uvrc")
    return np.array([[M_u, 0.0, 0.0], [0.0, M_v, M_c], [0.0, M_c, M_r]])


def thrust_configuration(model: Model, thrusters: Sequence[Thruster], angles: Sequence[float]) -> Array:
    """Return B (3, n): rows of (cos a, sin a, x sin a - y cos a), the side force of the wash with them.

    angles: direction of each thrust clockwise from ahead [rad] (Fossen 2021, section 9.2).
    """
    X, Y = np.cos(angles), np.sin(angles)
    N = np.array([t.x for t in thrusters]) * Y - np.array([t.y for t in thrusters]) * X
    Y = Y + coefficient_or_zero(model, "Y_T") * X + coefficient_or_zero(model, "Y_NT") * N
    return np.stack([X, Y, N])
