"""Rows of a run that grows."""

import numpy as np

from seatrial.core.values import Array

_INITIAL_CAPACITY = 256  # rows; chosen


class SampleRows:
    """Times and values of one run, (n,) and (n, k), with room that doubles."""

    def __init__(self, width: int) -> None:
        self._time, self._values, self._count = np.empty(_INITIAL_CAPACITY), np.empty((_INITIAL_CAPACITY, width)), 0

    def __len__(self) -> int:
        return self._count

    def add(self, time: float, values: Array) -> None:
        """One row more."""
        if self._count == len(self._time):
            self._time = np.concatenate([self._time, np.empty(self._count)])
            self._values = np.concatenate([self._values, np.empty_like(self._values)])
        self._time[self._count], self._values[self._count] = time, values
        self._count += 1

    @property
    def time(self) -> Array:
        """s, a copy."""
        return self._time[: self._count].copy()

    @property
    def values(self) -> Array:
        """A copy."""
        return self._values[: self._count].copy()

    @property
    def duration(self) -> float:
        """From the first row to the last."""
        return float(self._time[self._count - 1] - self._time[0]) if self._count else 0.0
