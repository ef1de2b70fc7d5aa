"""What a screen shows of a stream: history, trend, numbers and words of a snapshot."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, Snapshot
from seatrial.onboard.table import (
    History,
    RecentHistory,
    change_sentence,
    estimate_rows,
    phase_meaning,
    residual_rms,
    sparkline,
    time_text,
    trend_arrow,
)


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


def one(value: float, error: float, unit: str = "1") -> Snapshot:
    return Snapshot(
        0.0, 1, 1, EstimatorPhase.WINDOW, ("c",), (unit,), np.array([value]), np.array([error]), {"theta": 0.01}
    )


@given(value=st.floats(-1e12, 1e12), error=st.floats(1e-9, 1e12))
def test_text_of_value_and_interval_is_right_within_its_own_digits(value: float, error: float) -> None:
    row = estimate_rows(one(value, error))[0]
    scale = 10.0**row.power
    texts = {
        k: float(getattr(row, k).replace("−", "-").replace("\u202f", "")) * scale
        for k in ("value", "half_width", "lower", "upper")
    }
    last = scale * 10.0 ** -len(row.half_width.partition(".")[2]) if "." in row.half_width else scale
    allowed = max(last, 0.051 * 1.96 * error, 1e-6 * abs(value))
    assert abs(texts["value"] - value) <= allowed
    assert abs(texts["half_width"] - 1.96 * error) <= allowed
    assert abs(texts["lower"] - (value - 1.96 * error)) <= allowed
    assert abs(texts["upper"] - (value + 1.96 * error)) <= allowed
    assert max(len(text) for text in (row.value, row.half_width, row.lower, row.upper)) <= 12


@pytest.mark.parametrize("error", [np.inf, np.nan, 0.0])
def test_without_a_standard_error_there_is_no_interval(error: float) -> None:
    row = estimate_rows(one(2.5, error))[0]
    assert (row.value, row.half_width, row.lower) == ("2.500", "–", "–")


def test_angles_are_degrees_and_squares_are_squares() -> None:
    assert residual_rms(one(1.0, 0.1)) == [("theta", "0.573", "deg")]
    assert estimate_rows(one(2e6, 1e5, "kg m^2"))[0].unit == "10⁶ kg m²"


def test_times() -> None:
    assert time_text(61.04) == "61.0 s" and time_text(1.7e9) == "2023-11-14 22:13:20 UTC" and time_text(np.nan) == "–"


def test_a_change_is_stated_with_its_instant() -> None:
    change = CoefficientChange(300.0, (300.0, 300.0), 303.0, 31.2, "b33", {"b33": 2.0}, {"b33": 0.1})
    assert (
        change_sentence(change) == "The coefficients changed at 300.0 s, b33 most clearly. "
        "What is shown comes from later samples alone."
    )
    assert "not watched any longer" in change_sentence(replace(change, is_believed=False))
    placed = replace(change, between=(298.0, 301.0))
    assert change_sentence(placed).startswith("The coefficients changed between 298.0 s and 301.0 s, b33 most clearly.")
    assert change_sentence(None) == ""


def test_a_model_without_free_coefficients_does_not_wait_for_samples() -> None:
    waiting = Snapshot(0.0, 9, 1, EstimatorPhase.WAITING, ("c",), ("1",), np.ones(1), np.array([np.inf]))
    assert "too few samples" in phase_meaning(waiting)
    fixed = Snapshot(0.0, 9, 1, EstimatorPhase.WAITING, (), (), np.ones(0), np.ones(0))
    assert phase_meaning(fixed) == "every coefficient is fixed: nothing to estimate"


@given(st.lists(st.floats(-1e9, 1e9) | st.just(float("nan")), max_size=50), st.floats(0, 1e9) | st.just(float("inf")))
def test_a_sparkline_never_fails_and_never_grows(values: list[float], half: float) -> None:
    assert len(sparkline(np.array(values), half)) <= 12


def test_a_sparkline_is_flat_where_the_move_is_small_beside_the_interval() -> None:
    rising = np.linspace(1.0, 2.0, 40)
    assert sparkline(rising, 0.1)[0] == "▁" and sparkline(rising, 0.1)[-1] == "█"
    assert len(set(sparkline(rising, 100.0))) <= 2


def test_arrows() -> None:
    assert [trend_arrow(np.array(e)) for e in ([np.inf, 2.0, 1.0], [1.0, 1.02], [1.0, 2.0], [1.0])] == [
        "↘",
        "→",
        "↗",
        "",
    ]
