"""Wave number and group velocity of linear waves at a finite depth."""

import numpy as np
from numpy.typing import ArrayLike

from seatrial.core.values import Array, InputError

G = 9.81  # m/s^2, acceleration of gravity, rounded
SEA_WATER = 1025.0
"""Density where none is stated [kg/m^3] (ITTC 7.5-02-01-03, sea water at 15 degC: 1026)."""
_ITERATIONS = 60  # Newton steps at most; chosen


def wavenumber(omega: ArrayLike, depth: float) -> Array:
    """Return the positive root k [rad/m] of omega^2 = g k tanh(k depth) (Newman 1977, Marine Hydrodynamics, chap. 6).

    Args:
        omega: rad/s, any shape, positive.
        depth: m; infinite for deep water.

    Raises:
        InputError: a frequency or the depth is not positive.
    """
    w = np.asarray(omega, dtype=np.float64)
    if not (np.all(w > 0.0) and depth > 0.0):
        raise InputError("a wave number needs positive frequencies [rad/s] and a positive depth [m]")
    nu = w**2 / G
    if np.isinf(depth):
        return nu
    k = np.maximum(nu, w / np.sqrt(G * depth))
    for _ in range(_ITERATIONS):
        t = np.tanh(k * depth)
        k = k - (k * t - nu) / (t + k * depth * (1.0 - t**2))
    return np.asarray(k, dtype=np.float64)


def group_velocity(omega: ArrayLike, depth: float) -> Array:
    """Return c_g [m/s] = omega / (2 k) (1 + 2 k h / sinh(2 k h)) (Newman 1977, chap. 6)."""
    w, k = np.asarray(omega, dtype=np.float64), wavenumber(omega, depth)
    twice = np.minimum(2.0 * k * depth, 700.0)  # beyond, sinh overflows, and its share is zero
    return 0.5 * w / k * (1.0 + twice / np.sinh(twice))
