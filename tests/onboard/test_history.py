"""A week of snapshots fits in memory, evenly, with its first and its last."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.results.online import EstimatorPhase, Snapshot
from seatrial.onboard.table import History, RecentHistory


def snapshot(time: float, *, runs: int = 1, names: Sequence[str] = ("a", "b")) -> Snapshot:
    value = np.full(len(names), time)
    return Snapshot(time, 1, runs, EstimatorPhase.WINDOW, tuple(names), ("1",) * len(names), value, 0.1 + 0.0 * value)


def filled(count: int, limit: int) -> History:
    history = History(limit)
    for k in range(count):
        history.add(snapshot(0.5 * k))
    return history


def test_a_week_at_two_hertz_keeps_its_ends_and_its_evenness() -> None:
    count = 7 * 86400 * 2 // 20
    history = filled(count, 100)
    kept = [p.sequence for p in history.since(-1)]
    assert 50 <= len(kept) <= 100
    assert kept[0] == 0 and kept[-1] == count - 1
    assert {b - a for a, b in pairwise(kept[:-1])} == {history.stride}


@given(count=st.integers(1, 300), limit=st.integers(4, 40))
def test_never_more_than_the_limit_and_always_both_ends(count: int, limit: int) -> None:
    history = filled(count, limit)
    kept = [p.sequence for p in history.since(-1)]
    assert len(kept) <= limit and kept[0] == 0 and kept[-1] == count - 1
    assert count <= limit or len(kept) >= limit // 2


@given(asked=st.lists(st.integers(1, 30), min_size=1, max_size=20))
def test_a_reader_that_asks_for_what_is_new_has_what_the_history_has(asked: list[int]) -> None:
    history, mine = History(16), []
    for count in asked:
        for _ in range(count):
            history.add(snapshot(float(history.newest.sequence + 1 if history.newest else 0)))
        mine += history.since(mine[-1].sequence if mine else -1)
        mine = [p for p in mine if p.sequence % history.stride == 0 or p is mine[-1]]
    assert [p.sequence for p in mine] == [p.sequence for p in history.since(-1)]


def test_breaks_of_the_clock_are_left_out_of_the_time_followed() -> None:
    history = History()
    for time, runs in ((10.0, 1), (12.0, 1), (5.0, 2), (6.0, 2), (900.0, 3), (901.0, 3), (math.nan, 3), (902.0, 3)):
        history.add(snapshot(time, runs=runs))
    assert [p.elapsed for p in history.since(-1)] == [0.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0]


def test_other_coefficients_begin_anew() -> None:
    history = filled(30, 8)
    history.add(snapshot(3.0, names=("a", "c")))
    assert (history.generation, len(history), history.stride) == (1, 1, 1)
    assert history.names == ("a", "c")


def test_what_was_kept_does_not_move_with_the_estimator() -> None:
    history, given = History(), snapshot(1.0)
    history.add(given)
    given.value[:] = 99.0
    assert history.since(-1)[0].value.tolist() == [1.0, 1.0]


def test_recent_keeps_the_last_minutes_only() -> None:
    history, recent = History(4), RecentHistory(seconds=60.0, limit=30)
    for k in range(4000):
        recent.add(history.add(snapshot(0.1 * k)))
    times = recent.value[:, 0]
    assert 28 <= len(times) <= 32
    assert times[-1] == 0.1 * 3999 and times[0] >= times[-1] - 60.0
    recent.add(history.add(snapshot(400.0, names=("a",))))
    assert recent.value.shape == (1, 1)
