"""How many Runge-Kutta steps a sample takes: as many as the craft's own time scale needs, found by halving the step.

The solution of half the step errs by a sixteenth of the other's error where the motion is smooth, so that the
difference of the two is the error of the coarser one (step doubling; Hairer, Norsett & Wanner 1993, section II.4).
"""

from collections.abc import Callable

import numpy as np

from seatrial.core.values import Array

MOST_SUBSTEPS = 64
"""Runge-Kutta steps in a sample at most: a lag of 0.05 s, the least there is, logged once a second; chosen."""

SIMULATION_ERROR = 1e-4
"""Error of a simulation that no plot nor table shows, share of a channel's range in the run; chosen."""


def sufficient_substeps(
    simulate: Callable[[int], Array], is_close: Callable[[Array, Array], bool], first: int = 1
) -> int:
    """Return the least number of steps in a sample, doubled from `first` on, whose halves change nothing that matters.

    Where even `MOST_SUBSTEPS` end outside all bounds, the model itself diverges, and the first number remains.

    Args:
        simulate: outputs (rows, ny) with so many steps in a sample; NaN after a divergence.
        is_close: whether outputs, all finite, differ from those of half the step by no more than the purpose allows.
    """
    coarse, count = simulate(first), first
    while 2 * count <= MOST_SUBSTEPS:
        fine = simulate(2 * count)
        if np.array_equal(np.isfinite(coarse), np.isfinite(fine)):
            within = np.isfinite(fine).all(axis=1)
            if is_close(coarse[within], fine[within]):
                return count if within.all() else first
        count, coarse = 2 * count, fine
    return count if np.isfinite(coarse).all() else first


def is_within_range(coarse: Array, fine: Array) -> bool:
    """Return whether outputs (rows, ny) differ by less than `SIMULATION_ERROR` of each one's range."""
    if not len(fine):
        return True
    error = np.max(np.abs(fine - coarse), axis=0)
    return bool(np.all(error <= SIMULATION_ERROR * np.ptp(fine, axis=0)))
