"""Quadrature: trapezoids with corrected ends, and many nodes condensed on few."""

from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.special import bernoulli

from seatrial.core.values import Array, frozen

_ORDER = 8  # of the end correction of the trapezoidal rule (Gregory, Euler-Maclaurin); chosen
_END_WEIGHTS = 1.0 + np.linalg.solve(
    np.vander(np.arange(float(_ORDER)), increasing=True).T, bernoulli(_ORDER)[1:] / np.arange(1.0, _ORDER + 1.0)
)
# rad/s: below, gathered nodes are even in frequency, above in its logarithm
_LINEAR_BELOW = 0.05
_KEPT = 64  # grids kept in memory: all directions of a sea share theirs; chosen


def weights(count: int) -> Array:
    """Of trapezoids (count,), 16 or more, in steps: of order 8 at both ends (Gregory 1670; Euler-Maclaurin)."""
    made = np.ones(count)
    made[:_ORDER] *= _END_WEIGHTS
    made[: -_ORDER - 1 : -1] *= _END_WEIGHTS
    return made


@lru_cache(maxsize=_KEPT)
def nodes(edges: tuple[float, ...], count: int) -> tuple[Array, Array]:
    """Return `count` nodes, as many between all edges, even in their logarithm, and the width that each stands for."""
    made: list[Array] = []
    width: list[Array] = []
    own = count // (len(edges) - 1)
    for low, high in pairwise(np.log(edges)):
        u, step = np.linspace(low, high, own, retstep=True)
        made.append(np.exp(u))
        width.append(made[-1] * weights(own) * step)
    return frozen(np.concatenate(made)), frozen(np.concatenate(width))


def gather_nodes(omega: Array, rows: Array, count: int) -> tuple[Array, Array]:
    """Return the same sums over energies (r, n) on `count` nodes: each goes to its eight neighbours by Lagrange.

    What is summed must be smooth over arsinh(20 omega), as the response of a loop is. Single energies may come out
    negative.
    """
    x = np.arcsinh(omega / _LINEAR_BELOW)
    step = float(x.max()) / (count - 0.5)
    # the first one stands half a step from zero, where plants may integrate
    at = x / step - 0.5
    first = np.clip(np.floor(at).astype(int) - _ORDER // 2 + 1, 0, count - _ORDER)
    u, place = at - first, np.arange(_ORDER)
    made = np.zeros((len(rows), count))
    for j in place:
        others = place[place != j]
        share = np.prod((u[:, None] - others) / (j - others), axis=1)
        made += [np.bincount(first + j, share * energy, count) for energy in rows]
    return _LINEAR_BELOW * np.sinh((np.arange(count) + 0.5) * step), made
