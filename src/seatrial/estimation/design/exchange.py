"""Exchange of single orders: one after another takes the value that lowers the cost most (Meyer & Nachtsheim 1995)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.workers import map_in_threads

# as shares of the range; what lies beyond an end means that end
MOVES = np.array([-1.0, -0.5, -0.2, 0.2, 0.5, 1.0])
# decrease of the cost in a whole round below which the exchange ends, ours
NO_GAIN = 1e-3


@dataclass(frozen=True, eq=False)
class ExchangedOrders:
    """A point of the unit box, its cost, and the evaluations that the exchange spent on it so far."""

    point: Array
    cost: float
    evaluations: int = 0


def coordinate_exchange(
    cost: Callable[[Array], float], start: ExchangedOrders, generator: np.random.Generator, evaluations: int
) -> Iterator[ExchangedOrders]:
    """Return the best point after each coordinate.

    Coordinates come in random order, all of them before any comes again; it ends when a whole round lowers the cost by
    less than `NO_GAIN`, or when the evaluations are spent.
    """
    point, value, spent, before = start.point, start.cost, 0, np.inf
    while before - value > NO_GAIN:
        before = value
        for place in generator.permutation(len(point)):
            candidates = _exchange_candidates(point, int(place))
            costs = map_in_threads(cost, candidates)
            spent += len(costs)
            least = int(np.argmin(costs))
            if costs[least] < value:
                point, value = candidates[least], costs[least]
            yield ExchangedOrders(point, value, spent)
            if spent >= evaluations:
                return


def _exchange_candidates(point: Array, coordinate: int) -> list[Array]:
    candidates = []
    for to in np.unique(np.clip(point[coordinate] + MOVES, 0.0, 1.0)):
        if to != point[coordinate]:
            candidates.append(point.copy())
            candidates[-1][coordinate] = to
    return candidates
