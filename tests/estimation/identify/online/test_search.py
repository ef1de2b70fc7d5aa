"""Which search suits a trial, and when one from the last optimum is checked from nowhere."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.identify.online.streams import sea_stream, window_of

from seatrial.estimation.identify.online import phases as search
from seatrial.estimation.identify.online.phases import (
    CONTINUED_INTERVALS,
    ContinuedSearch,
    RepeatedSearch,
    SearchSchedule,
    WarmUp,
    suits_whole_runs,
)


@pytest.fixture(scope="module")
def stream():
    return sea_stream(135, 60.0)


def test_linear_models_under_output_error_continue_their_search(stream):
    assert suits_whole_runs(stream.trial)
    assert not suits_whole_runs(replace(stream.trial, estimate=replace(stream.trial.estimate, segment_s=20.0)))
    prediction = replace(stream.trial.estimate, method="prediction-error")
    assert not suits_whole_runs(replace(stream.trial, estimate=prediction))


@pytest.mark.parametrize(("seconds", "next_check", "checks"), [(50.0, 0.0, 1), (50.0, 55.0, 0), (70.0, 0.0, 0)])
def test_a_local_optimum_is_guarded_against_in_the_first_minute(stream, monkeypatch, seconds, next_check, checks):
    records = window_of(stream, slice(0, 500)).records()
    schedule = SearchSchedule(CONTINUED_INTERVALS, last_search=seconds)
    continued = ContinuedSearch(stream.trial, schedule)
    phase = WarmUp().with_estimate(continued.estimate(WarmUp(), records))
    schedule.next_cold_start = next_check
    calls = []
    original = search.cold_start
    monkeypatch.setattr(search, "cold_start", lambda *arguments: calls.append(1) or original(*arguments))
    continued.estimate(phase, records)
    assert len(calls) == checks


def test_a_repeated_search_uses_what_is_carried(stream):
    trial = replace(stream.trial, estimate=replace(stream.trial.estimate, segment_s=20.0))
    repeated = RepeatedSearch(trial)
    first = repeated.estimate(WarmUp(), window_of(stream, slice(0, 400)).records())
    carried = WarmUp().with_estimate(first).carried()
    both = repeated.estimate(carried, window_of(stream, slice(400, 600)).records())
    assert np.all(np.diag(both.covariance) < np.diag(first.covariance))
