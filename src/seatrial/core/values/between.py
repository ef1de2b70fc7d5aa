"""How a channel runs between its samples: held until the next one, or straight to it."""

from dataclasses import dataclass
from itertools import accumulate
from typing import Literal

import numpy as np

from seatrial.core.values.arrays import Array

Kind = Literal["", "command", "measured"]
"""Who set a channel: nobody says, an order, or a sensor."""
Between = Literal["", "held", "straight"]
"""How it runs between samples; empty: a command is held, of another one its steps decide."""
KINDS: tuple[Kind, ...] = ("command", "measured")
BETWEEN: tuple[Between, ...] = ("held", "straight")

_QUIET = 0.2  # of a move, what the samples before and after it may move at most where it is a step; chosen
_NOISE = 0.05  # of the range of the values, within which they move without being followed; chosen
_LEAST_SHARE = 0.5  # of the travel that lies within single samples where an input is held; chosen, between 0 and 1


@dataclass(frozen=True)
class Travel:
    """How far values move in all, and how far of it in steps within a single sample, in their unit."""

    total: float = 0.0
    steps: float = 0.0

    def __add__(self, more: "Travel") -> "Travel":
        """Return the travel of two records together."""
        return Travel(self.total + more.total, self.steps + more.steps)

    @property
    def is_stepped(self) -> bool:
        """Whether most of it lies within single samples: of orders all, of a slewing rudder hardly any."""
        return self.total > 0.0 and self.steps >= _LEAST_SHARE * self.total


def travel(values: Array) -> Travel:
    """Return how far the values move, (n,); moves to and fro within a twentieth of their range are noise.

    A step has hardly any move in the samples before and after it; a slewing rudder takes several samples.
    """
    finite = values[np.isfinite(values)]
    if finite.size < 2:
        return Travel()
    play = _NOISE * float(np.ptp(finite))
    followed = np.fromiter(accumulate(finite.tolist(), lambda y, v: min(max(y, v - play), v + play)), np.float64)
    moves = np.abs(np.diff(followed))
    beside = np.concatenate([[0.0], moves, [0.0]])
    is_step = (moves > play) & (np.maximum(beside[:-2], beside[2:]) <= _QUIET * moves)
    return Travel(float(moves.sum()), float(moves[is_step].sum()))


def held_rows(values: Array, ratio: int) -> Array:
    """Return every `ratio`-th sample of a held channel as the mean of what was held until the next one."""
    starts = np.arange(0, len(values), ratio)
    counts = np.minimum(starts + ratio, len(values)) - starts
    return np.add.reduceat(values, starts) / counts
