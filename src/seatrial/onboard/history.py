"""The estimates since the stream began, thinned so that a week of them fits in memory."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from seatrial.core.results.online import Snapshot
from seatrial.core.values import Array


@dataclass(frozen=True, eq=False)
class HistoryPoint:
    """One earlier snapshot.

    Attributes:
        sequence: its number, from 0; elapsed: s of samples until then, breaks of the clock left out.
        value, standard_error: (k,), SI; noise: channel -> residual rms, SI.
    """

    sequence: int
    elapsed: float
    names: tuple[str, ...]
    value: Array
    standard_error: Array
    noise: dict[str, float]


class History:
    """At most `limit` points: every `stride`-th snapshot from the first on, and the newest.

    The stride doubles when there are more, so that the points stay evenly spaced over the whole time.
    """

    def __init__(self, limit: int = 2000) -> None:  # points, chosen: more than a screen has columns
        self.limit = max(4, limit)
        self.stride = 1
        self.generation = 0
        self.names: tuple[str, ...] = ()
        self._count = 0
        self._points: list[HistoryPoint] = []
        self._elapsed = 0.0
        self._last: Snapshot | None = None

    def add(self, snapshot: Snapshot) -> HistoryPoint:
        """Append a snapshot; one of other coefficients begins a new history, of the next generation."""
        if self._last is not None and snapshot.names != self.names:
            self._restart()
        self.names = snapshot.names
        self._elapsed += _time_step(self._last, snapshot)
        self._last = snapshot
        value, error = snapshot.value.copy(), snapshot.standard_error.copy()
        point = HistoryPoint(self._count, self._elapsed, snapshot.names, value, error, dict(snapshot.noise))
        self._count += 1
        if self._points and self._points[-1].sequence % self.stride:
            self._points.pop()
        self._points.append(point)
        while len(self._points) > self.limit:
            self.stride *= 2
            self._points = [p for p in self._points if p is point or p.sequence % self.stride == 0]
        return point

    def since(self, sequence: int) -> list[HistoryPoint]:
        """Return the points after that number, oldest first; all of them for -1."""
        return [p for p in self._points if p.sequence > sequence]

    @property
    def newest(self) -> HistoryPoint | None:
        """The last point; None before the first."""
        return self._points[-1] if self._points else None

    def __len__(self) -> int:
        return len(self._points)

    def _restart(self) -> None:
        self.generation += 1
        self.stride, self._count, self._points, self._elapsed, self._last = 1, 0, [], 0.0, None


class RecentHistory:
    """The last minutes: points of the last `seconds` s, at most `limit` of them."""

    def __init__(self, seconds: float = 180.0, limit: int = 180) -> None:
        self.seconds = seconds
        self._spacing = seconds / limit
        self._points: deque[HistoryPoint] = deque()

    def add(self, point: HistoryPoint) -> None:
        """Append a point; it replaces the newest where that one is closer to its predecessor than the spacing."""
        points = self._points
        if points and points[-1].names != point.names:
            points.clear()
        if len(points) > 1 and points[-1].elapsed - points[-2].elapsed < self._spacing:
            points.pop()
        points.append(point)
        while points[0].elapsed < point.elapsed - self.seconds:
            points.popleft()

    @property
    def value(self) -> Array:
        """(n, k), oldest first."""
        return np.array([p.value for p in self._points])

    @property
    def standard_error(self) -> Array:
        """(n, k), oldest first."""
        return np.array([p.standard_error for p in self._points])


def _time_step(previous: Snapshot | None, current: Snapshot) -> float:
    """s from one snapshot to the next; none where a new run began in between or a clock went back."""
    if previous is None or current.runs != previous.runs:
        return 0.0
    step = current.time - previous.time
    return step if 0.0 < step < float("inf") else 0.0
