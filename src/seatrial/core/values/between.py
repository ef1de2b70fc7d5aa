"""How a channel runs between its samples: held until the next one, or straight to it."""

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
_NOISE = 0.05  # of the range of the values, below which a move from sample to sample counts for nothing; chosen


def travel(values: Array) -> tuple[float, float]:
    """Return how far the values move in all, and how far of it in steps within a single sample, in their unit.

    A step has hardly any move in the samples before and after it; a slewing rudder takes several samples. Moves below
    a twentieth of the range are noise and counted in neither.
    """
    finite = values[np.isfinite(values)]
    moves = np.abs(np.diff(finite))
    if moves.size == 0:
        return 0.0, 0.0
    beside = np.concatenate([[0.0], moves, [0.0]])
    is_move = moves > _NOISE * np.ptp(finite)
    is_step = is_move & (np.maximum(beside[:-2], beside[2:]) <= _QUIET * moves)
    return float(moves[is_move].sum()), float(moves[is_step].sum())


def held_rows(values: Array, ratio: int) -> Array:
    """Return every `ratio`-th sample of a held channel as the mean of what was held until the next one."""
    starts = np.arange(0, len(values), ratio)
    counts = np.minimum(starts + ratio, len(values)) - starts
    return np.add.reduceat(values, starts) / counts
