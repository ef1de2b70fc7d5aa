"""When a search begins, which one suits a trial, and what leads from phase to phase."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.identify.online.streams import samples, sea_stream, window_of

from seatrial.core.results.online import EstimatorPhase
from seatrial.estimation.identify.online import phases as search
from seatrial.estimation.identify.online.phases import (
    BLOCK_SAMPLES,
    CONTINUED_INTERVALS,
    REPEATED_INTERVALS,
    Carried,
    ContinuedSearch,
    RecursivePhase,
    RepeatedSearch,
    SampleMap,
    SearchSchedule,
    StreamProgress,
    WarmUp,
    Window,
    at_progress,
    carried_phase,
    filter_phase,
    first_snapshot,
    is_window_full,
    suits_whole_runs,
)
from seatrial.physics.sea.spectrum import WaveEncounter
from seatrial_studies.seaway import box_hull


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


def test_breaks_between_runs_do_not_count_as_time():
    progress = (
        StreamProgress().with_run().with_samples(np.array([10.0, 10.5])).with_run().with_samples(np.array([100.0]))
    )
    progress = progress.with_samples(np.array([100.25]))
    assert (progress.samples, progress.runs) == (4, 2)
    assert progress.elapsed == 0.75
    assert progress.last_time == 100.25


def test_before_the_first_sample_start_values_are_shown_without_confidence():
    trial = sea_stream(135, 10.0).trial
    snapshot = first_snapshot(trial.model)
    assert snapshot.phase is EstimatorPhase.WAITING
    np.testing.assert_array_equal(snapshot.value, [p.value for p in trial.model.parameters.free])
    assert np.all(np.isinf(snapshot.standard_error))
    later = at_progress(snapshot, StreamProgress().with_run().with_samples(np.array([3.0])))
    assert (later.time, later.samples, later.runs) == (3.0, 1, 1)


@pytest.fixture(scope="module")
def window_phase(stream):
    """The first estimate, from 50 s: warm-up becomes window."""
    search = ContinuedSearch(stream.trial, SearchSchedule(CONTINUED_INTERVALS))
    return WarmUp().with_estimate(search.estimate(WarmUp(), window_of(stream, slice(0, 500)).records()))


def _filter(stream, window_phase, **changes):
    return filter_phase(window_phase.estimate, replace(stream.trial.stream, **changes), 0.0)


def test_warm_up_becomes_a_window_with_the_first_estimate(stream, window_phase):
    assert isinstance(window_phase, Window)
    assert np.mean(np.abs(window_phase.estimate.value / stream.truth - 1.0)) < 0.02


def test_a_window_is_full_after_its_time_and_never_before_an_estimate(stream, window_phase):
    hour = replace(stream.trial.stream, batch_window_s=3600.0)
    assert not is_window_full(WarmUp(), 1e6, hour, CONTINUED_INTERVALS)
    assert not is_window_full(window_phase, 3599.0, hour, CONTINUED_INTERVALS)
    assert is_window_full(window_phase, 3600.0, hour, CONTINUED_INTERVALS)
    assert is_window_full(window_phase, 100.0, replace(hour, forgetting_time_s=100.0), CONTINUED_INTERVALS)


@pytest.mark.parametrize(("intervals", "stretch"), [(CONTINUED_INTERVALS, 60.0), (REPEATED_INTERVALS, 900.0)])
def test_carried_information_is_renewed_after_a_stretch(stream, window_phase, intervals, stretch):
    hour = replace(stream.trial.stream, batch_window_s=3600.0)
    assert not is_window_full(window_phase.carried(), stretch - 1.0, hour, intervals)
    assert is_window_full(window_phase.carried(), stretch, hour, intervals)


def test_a_window_becomes_a_filter_with_the_same_estimate(stream, window_phase):
    recursive = _filter(stream, window_phase)
    assert isinstance(recursive, RecursivePhase)
    np.testing.assert_allclose(recursive.value, window_phase.estimate.value)
    np.testing.assert_allclose(recursive.covariance, window_phase.estimate.covariance, rtol=1e-6)


def test_waves_from_an_elevation_need_a_window(stream, window_phase):
    assert _filter(stream, window_phase, waves=WaveEncounter(box_hull(), 0.0, np.pi)) is None


def test_a_window_becomes_carried_information_of_the_same_weight(stream, window_phase):
    carried = carried_phase(window_phase, 50.0, stream.trial.stream, is_efficient=False)
    assert isinstance(carried, Carried)
    np.testing.assert_allclose(carried.prior.point, window_phase.estimate.value)
    weight, errors = carried.prior.information, np.sqrt(np.diag(window_phase.estimate.covariance))
    deviation = np.sqrt(np.diag(np.linalg.inv(weight)))
    np.testing.assert_allclose(deviation, errors / np.sqrt(carried.inflation), rtol=0.05)


def test_forgetting_discounts_what_is_carried(stream, window_phase):
    full = carried_phase(window_phase, 50.0, stream.trial.stream, is_efficient=False)
    half = replace(stream.trial.stream, forgetting_time_s=50.0 / np.log(2.0))
    halved = carried_phase(window_phase, 50.0, half, is_efficient=False)
    np.testing.assert_allclose(halved.prior.information, 0.5 * full.prior.information)


def test_correlated_residuals_discount_what_an_efficient_search_carries(stream, window_phase):
    coloured = Window(replace(window_phase.estimate, inflation=np.array([1.0, 4.0])))
    plain = carried_phase(coloured, 50.0, stream.trial.stream, is_efficient=False)
    discounted = carried_phase(coloured, 50.0, stream.trial.stream, is_efficient=True)
    np.testing.assert_allclose(discounted.prior.information, 0.25 * plain.prior.information)


def test_a_filter_that_is_left_hands_its_information_to_a_window(stream, window_phase):
    recursive = _filter(stream, window_phase)
    moved = []
    for sample in samples(stream.record, stream.trial, slice(500, 595)):
        recursive.take(np.array([sample.time]), sample.values[None])
        moved.append(recursive.room == BLOCK_SAMPLES)
    assert sum(moved) == 95 // BLOCK_SAMPLES
    carried = recursive.to_window()
    assert isinstance(carried, Carried)
    np.testing.assert_allclose(carried.prior.point, recursive.value)
    covariance = carried.inflated_covariance(carried.prior.information, np.zeros(len(stream.truth)))
    np.testing.assert_allclose(covariance, recursive.covariance, rtol=1e-4)
    assert np.all(np.diag(recursive.covariance) < np.diag(window_phase.estimate.covariance))


def test_a_filter_that_has_diverged_leads_back_to_warm_up(stream, window_phase):
    recursive = _filter(stream, window_phase)
    scale = np.array([1.0, 1.0, 1.0, 1e3, 1e3])
    for sample in samples(stream.record, stream.trial, slice(500, 600)):
        recursive.take(np.array([sample.time]), sample.values[None] * scale)
    for sample in samples(stream.record, stream.trial, slice(0, 200)):
        recursive.take(np.array([60.0 + sample.time]), sample.values[None] * scale)
    assert not recursive.is_sound
    assert recursive.to_window() == WarmUp()


def test_inflation_widens_what_data_give_and_leaves_priors(window_phase):
    carried = replace(window_phase.carried(), inflation=4.0)
    weight = np.array([3.0, 0.0])
    hessian = np.diag([4.0 + 3.0, 8.0])
    np.testing.assert_allclose(carried.inflated_covariance(hessian, weight), np.diag([1 / 4.0, 1 / 2.0]))


def test_rows_that_convert_linearly_are_mapped_and_others_not() -> None:
    matrix = np.array([[0.0, -1.0, 0.0], [2.0, 0.0, 0.5]])
    mapped = SampleMap.of_stream(lambda rows: rows @ matrix.T + [0.0, 3.0], 3)
    assert mapped is not None
    np.testing.assert_allclose(mapped.apply(np.array([[1.0, 2.0, 4.0]])), [[-2.0, 7.0]])
    (missing,) = mapped.apply(np.array([[1.0, np.nan, 4.0]]))
    assert np.isnan(missing[0]) and missing[1] == 7.0
    assert SampleMap.of_stream(lambda rows: rows @ matrix.T + rows[:, :1] ** 2, 3) is None
    assert SampleMap.of_stream(lambda rows: np.cumsum(rows, axis=0) @ matrix.T, 3) is None
