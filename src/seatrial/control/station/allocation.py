"""Forces shared out over thrusters: by a weighted generalised inverse in the loop; what is possible by programming.

A force tau is B T with least sum (T_i / T_max,i)^2 for T = W^-1 B' (B W^-1 B')^-1 tau, W = diag(1 / T_max,i^2) (Fossen
2021, section 11.2.2, generalised inverse).
"""

from dataclasses import dataclass

import numpy as np

from seatrial.control.station.craft import StationCraft
from seatrial.core.values import Array

_SIDES = 32  # of the polygon inside the circle of an azimuth thruster's thrust: 0.5 % short of it; chosen
_AT_LIMIT = 1e-6  # share of a thruster's range within which it counts as at its limit: of the linear programme


def weights(craft: StationCraft) -> Array:
    """Return the largest thrust of each column of B, (m,): ahead or astern, whichever is larger."""
    return np.array([max(t.most, -t.least) for t in craft.tables])[list(craft.owner)]


def generalised_inverse(craft: StationCraft) -> Array:
    """Return the matrix (m, 3) that shares out a force with the least sum of (T_i / T_max,i)^2."""
    B, spread = craft.configuration, weights(craft) ** 2
    return spread[:, None] * B.T @ np.linalg.inv(B @ (spread[:, None] * B.T))


def inverse_rows(craft: StationCraft, inverse: Array) -> Array:
    """Return an inverse (m, 3) with two rows for each thruster, (n, 6): zeros in the second of a fixed one."""
    rows = np.zeros((len(craft.thrusters), 2, 3))
    for i in range(len(craft.thrusters)):
        own = [k for k, owner in enumerate(craft.owner) if owner == i]
        rows[i, : len(own)] = inverse[own]
    return rows.reshape(len(craft.thrusters), -1)


def share_given(craft: StationCraft, inverse: Array, forces: Array) -> Array:
    """Return the share of each force (n, 3) that the generalised inverse gives within the limits, (n,)."""
    T = forces @ inverse.T
    share = np.full(len(forces), np.inf)
    for i, table in enumerate(craft.tables):
        own = [k for k, owner in enumerate(craft.owner) if owner == i]
        with np.errstate(divide="ignore"):
            if craft.is_azimuth[i]:
                given = table.most / np.linalg.norm(T[:, own], axis=1)
            else:
                given = np.where(T[:, own[0]] > 0.0, table.most, -table.least) / np.abs(T[:, own[0]])
        share = np.minimum(share, given)
    return share


@dataclass(frozen=True)
class LargestForce:
    """The largest force of a direction: a factor of the force given, and the thrusters that are at their limits."""

    factor: float
    at_limit: tuple[str, ...]


def largest_force(craft: StationCraft, force: Array) -> LargestForce:
    """Return how many times a force (3,) the thrusters give at most, by linear programming; exact for fixed thrusters.

    The circle of an azimuth thruster's thrust is a polygon inside it.
    """
    from scipy.optimize import linprog

    m, owner = len(craft.owner), craft.owner
    limits, bounds = [], []
    for i, table in enumerate(craft.tables):
        own = [k for k, one in enumerate(owner) if one == i]
        if not craft.is_azimuth[i]:
            bounds.append((table.least, table.most))
            continue
        bounds += [(None, None)] * 2
        for angle in 2.0 * np.pi * (np.arange(_SIDES) + 0.5) / _SIDES:
            row = np.zeros(m + 1)
            row[own] = np.cos(angle), np.sin(angle)
            limits.append((row, table.most * np.cos(np.pi / _SIDES)))
    cost = np.zeros(m + 1)
    cost[m] = -1.0
    scale = np.array([1.0, 1.0, 1.0 / craft.lever])
    equal = scale[:, None] * np.column_stack([craft.configuration, -force])
    found = linprog(
        cost, A_ub=np.array([row for row, _ in limits]) if limits else None,
        b_ub=np.array([most for _, most in limits]) if limits else None,
        A_eq=equal, b_eq=np.zeros(3), bounds=[*bounds, (0.0, None)], method="highs",
    )  # fmt: skip
    if found.x is None:
        return LargestForce(0.0, ())
    return LargestForce(float(found.x[m]), _at_limit(craft, found.x[:m]))


def _at_limit(craft: StationCraft, T: Array) -> tuple[str, ...]:
    names = []
    for i, (thruster, table) in enumerate(zip(craft.thrusters, craft.tables, strict=True)):
        own = T[[k for k, owner in enumerate(craft.owner) if owner == i]]
        slack = _AT_LIMIT * (table.most - table.least)
        size = float(np.linalg.norm(own)) if craft.is_azimuth[i] else float(own[0])
        most = table.most * np.cos(np.pi / _SIDES) if craft.is_azimuth[i] else table.most
        if size >= most - slack or (not craft.is_azimuth[i] and size <= table.least + slack):
            names.append(thruster.name)
    return tuple(names)
