"""Times of searches over a growing window."""

import pytest

from seatrial.estimation.identify.online.phases import CONTINUED_INTERVALS, REPEATED_INTERVALS, SearchSchedule


@pytest.mark.parametrize(
    ("intervals", "seconds", "is_carried", "expected"),
    [
        (CONTINUED_INTERVALS, 0.0, False, 2.5),
        (CONTINUED_INTERVALS, 76.0, False, 2.5),
        (CONTINUED_INTERVALS, 160.0, False, 15.0),
        (CONTINUED_INTERVALS, 160.0, True, 60.0),
        (REPEATED_INTERVALS, 20.0, False, 10.0),
        (REPEATED_INTERVALS, 80.0, False, 20.0),
        (REPEATED_INTERVALS, 80.0, True, 20.0),
    ],
)
def test_searches_become_rarer_as_the_window_grows(intervals, seconds, is_carried, expected):
    assert intervals.interval(seconds, is_carried=is_carried) == pytest.approx(expected)


def test_carried_information_is_renewed_every_minute_or_quarter_of_a_window():
    assert CONTINUED_INTERVALS.stretch(3600.0) == 60.0
    assert REPEATED_INTERVALS.stretch(100.0) == 60.0
    assert REPEATED_INTERVALS.stretch(3600.0) == 900.0


def test_the_next_search_counts_from_the_last():
    schedule = SearchSchedule(CONTINUED_INTERVALS)
    schedule.note_search(40.0, is_carried=False)
    assert (schedule.last_search, schedule.next_search) == (40.0, 42.5)
    schedule.note_cold_start()
    assert schedule.next_cold_start == 60.0


@pytest.mark.parametrize(("seconds", "is_due"), [(49.0, False), (50.0, True)])
def test_ten_new_seconds_are_searched_as_a_short_run_ends(seconds, is_due):
    schedule = SearchSchedule(CONTINUED_INTERVALS, last_search=40.0)
    assert schedule.is_due_at_run_end(seconds) is is_due


def test_a_long_window_needs_a_tenth_that_is_new():
    assert not SearchSchedule(CONTINUED_INTERVALS, last_search=500.0).is_due_at_run_end(550.0)
    assert SearchSchedule(CONTINUED_INTERVALS, last_search=500.0).is_due_at_run_end(556.0)


def test_an_empty_window_is_searched_at_once():
    schedule = SearchSchedule(CONTINUED_INTERVALS, 10.0, 20.0, 30.0)
    schedule.restart()
    assert schedule == SearchSchedule(CONTINUED_INTERVALS)
