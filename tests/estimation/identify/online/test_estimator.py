"""Fed sample by sample: the numbers of the batch fit on the same samples, and what is carried on beyond the window."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.online.streams import feed, samples, sea_stream

from seatrial.core.results.online import EstimatorPhase, Sample
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial, load_trial
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.onboard.sources import open_source
from seatrial_studies.seaway import SeawayScenario, ship, simulate_seaway_run

EXAMPLES = Path(__file__).parents[4] / "examples"


@pytest.mark.long(every=3)
@pytest.mark.parametrize("heading", [90, 135, 180])
def test_the_numbers_are_those_of_the_batch_fit_on_the_same_samples(heading):
    stream = sea_stream(heading, 120.0)
    trial, record = stream.trial, stream.record
    estimator = OnlineEstimator(trial)
    feed(estimator, record, trial)
    snapshot = estimator.relinearise()
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    batch = {c.name: c for c in fit.coefficients}
    off = [
        (v - batch[n].estimate) / batch[n].standard_error for n, v in zip(snapshot.names, snapshot.value, strict=True)
    ]
    assert np.max(np.abs(off)) < 0.01
    np.testing.assert_allclose(snapshot.standard_error, [batch[n].standard_error for n in snapshot.names], rtol=0.01)


def converged_batch(trial: Trial, records: Sequence[Record], start: Array) -> tuple[Array, Array]:
    """The coefficients of least cost over whole runs and their standard errors, (k,) each, searched to rounding."""
    runs = replace(Runs.one_session_each(list(records), trial.ship.length), noise=trial.noise)
    settings = trial.estimate.with_known_timing(trial.model.input_names)
    problem = output_error_problem(trial.model, runs, np.inf, settings)
    problem = replace(problem, noise=np.array([trial.noise[o] for o in problem.data.outputs]))
    found = levenberg_marquardt(problem, start, problem.measured_initial_states(), negligible=1e-12, evaluations=60)
    return found.solution.point, np.sqrt(np.diag(np.linalg.inv(found.normal.without_local()[1])))


@pytest.mark.long(every=3)
@pytest.mark.parametrize(("heading", "seed"), [(135, 1), (90, 2), (180, 3)])
def test_at_every_sample_the_numbers_are_those_of_the_converged_batch(heading, seed):
    """From the first sample at which every relative standard error is below 30 % on: 0.01 standard errors."""
    stream = sea_stream(heading, 24.0, seed)
    estimator, compared = OnlineEstimator(stream.trial), 0
    for sample in samples(stream.record, stream.trial):
        snapshot = estimator.update(sample)
        if not compared and not np.all(snapshot.standard_error < 0.3 * np.abs(snapshot.value)):
            continue
        value, error = converged_batch(stream.trial, estimator.records(), snapshot.value.copy())
        assert np.all(np.abs(snapshot.value - value) < 0.01 * error), sample.time
        compared += 1
    assert compared > 100


@pytest.mark.parametrize("follow", [{}, {"batch_window_s": 40.0}, {"batch_window_s": 40.0, "forgetting_time_s": 60.0}])
def test_blocks_of_samples_have_the_bits_of_samples_one_by_one(follow):
    """In a window and behind it, an outage and a changed scale of the motions in them; blocks of any size."""
    stream = sea_stream(135, 90.0, 5)
    trial = replace(stream.trial, stream=replace(stream.trial.stream, **follow))
    rows = samples(stream.record, trial)
    times, values = np.array([r.time for r in rows]), np.array([r.values for r in rows])
    values[300:320, -2:] = np.nan
    values[700:, 0] *= 1.1
    one_by_one, blocks, taken = OnlineEstimator(trial), OnlineEstimator(trial), 0
    shown = [one_by_one.update(Sample(t, v)) for t, v in zip(times.tolist(), values, strict=True)]
    for size in np.random.default_rng(1).integers(1, 120, 900):
        snapshot = blocks.update_block(times[taken : taken + size], values[taken : taken + size])
        taken = min(taken + int(size), len(times))
        same = shown[taken - 1]
        np.testing.assert_array_equal(snapshot.value, same.value)
        np.testing.assert_array_equal(snapshot.standard_error, same.standard_error)
        assert (snapshot.phase, snapshot.change, snapshot.noise) == (same.phase, same.change, same.noise)
        assert (snapshot.time, snapshot.samples, snapshot.unwatched) == (same.time, same.samples, same.unwatched)
        if taken == len(times):
            break
    assert shown[-1].change is not None


def test_one_per_cent_is_reached_within_the_first_minute():
    stream = sea_stream(135, 60.0)
    trial, record, truth = stream.trial, stream.record, stream.truth
    snapshot = feed(OnlineEstimator(trial), record, trial)
    assert snapshot.phase is EstimatorPhase.WINDOW
    assert np.mean(np.abs(snapshot.value / truth - 1.0)) < 0.01


def test_beyond_the_window_a_filter_carries_its_information_on():
    stream = sea_stream(135, 300.0)
    trial, record = stream.trial, stream.record
    whole = OnlineEstimator(trial)
    feed(whole, record, trial)
    best = whole.relinearise()
    short = OnlineEstimator(replace(trial, stream=replace(trial.stream, batch_window_s=120.0)))
    feed(short, record, trial)
    snapshot = short.relinearise()
    assert snapshot.phase is EstimatorPhase.RECURSIVE
    np.testing.assert_allclose(snapshot.standard_error, best.standard_error, rtol=0.02)
    assert np.all(np.abs(snapshot.value - best.value) < 0.1 * best.standard_error)


def test_a_gap_beyond_the_window_goes_on_with_what_the_filter_knew():
    stream = sea_stream(135, 400.0)
    trial, record, truth = stream.trial, stream.record, stream.truth
    estimator = OnlineEstimator(replace(trial, stream=replace(trial.stream, batch_window_s=120.0)))
    feed(estimator, record, trial, slice(0, 2000))
    known = estimator.relinearise()
    estimator.begin_run()
    feed(estimator, record, trial, slice(2200, None))
    snapshot = estimator.relinearise()
    assert snapshot.runs == 2
    assert np.all(snapshot.standard_error < known.standard_error)
    assert np.all(np.abs(snapshot.value - truth) < 5.0 * snapshot.standard_error)


@pytest.mark.long(every=2)
@pytest.mark.parametrize("forgetting", [None, 60.0])
def test_a_ship_that_becomes_another_is_stated_and_followed(forgetting):
    stream = sea_stream(90, 240.0)
    trial, record, truth = stream.trial, stream.record, stream.truth
    voyage = SeawayScenario(90, duration=240.0)
    heavy = ship(90).with_values({"a33": 1.5 * ship(90).parameters["a33"].value})
    loaded = simulate_seaway_run(voyage, np.random.default_rng(5), heavy).with_sensor_noise(
        np.random.default_rng(6), voyage
    )
    estimator = OnlineEstimator(
        replace(trial, stream=replace(trial.stream, batch_window_s=60.0, forgetting_time_s=forgetting))
    )
    feed(estimator, record, trial)
    assert estimator.relinearise().change is None
    estimator.begin_run()
    feed(estimator, loaded, trial)
    snapshot = estimator.relinearise()
    assert snapshot.change is not None
    place = list(trial.model.parameters.free_names).index("a33")
    assert abs(snapshot.value[place] / (1.5 * truth[place]) - 1.0) < 0.01


def test_behind_a_change_the_estimate_is_of_the_changed_ship_alone():
    """At 60 s in one window: the same sea, another ship."""
    stream, voyage = sea_stream(90, 120.0, seed=5), SeawayScenario(90, duration=120.0)
    heavy = ship(90).with_values({"a33": 1.3 * ship(90).parameters["a33"].value})
    loaded = simulate_seaway_run(voyage, np.random.default_rng(5), heavy).with_sensor_noise(
        np.random.default_rng(7), voyage
    )
    estimator = OnlineEstimator(stream.trial)
    feed(estimator, stream.record, stream.trial, slice(0, 600))
    feed(estimator, loaded, stream.trial, slice(600, None))
    snapshot = estimator.relinearise()
    assert snapshot.change is not None
    assert snapshot.change.between[0] - 2.0 < 60.0 < snapshot.change.between[1] + 2.0
    place = list(stream.trial.model.parameters.free_names).index("a33")
    error = snapshot.value[place] - 1.3 * stream.truth[place]
    assert abs(error) < 4.0 * snapshot.standard_error[place] < 0.05 * stream.truth[place]


def test_the_same_samples_give_the_same_bits():
    stream = sea_stream(90, 30.0)
    trial, record = stream.trial, stream.record
    first, again = (feed(OnlineEstimator(trial), record, trial) for _ in range(2))
    assert np.array_equal(first.value, again.value)
    assert np.array_equal(first.standard_error, again.standard_error)


def test_a_gap_begins_another_run_and_both_tell():
    stream = sea_stream(135, 80.0)
    trial, record = stream.trial, stream.record
    estimator = OnlineEstimator(trial)
    feed(estimator, record, trial, slice(0, 400))
    alone = estimator.relinearise().standard_error
    estimator.begin_run()
    feed(estimator, record, trial, slice(450, None))
    both = estimator.relinearise()
    assert both.runs == 2
    assert np.all(both.standard_error < alone)


def test_nothing_is_claimed_before_there_is_something_to_claim():
    stream = sea_stream(135, 20.0)
    trial, record = stream.trial, stream.record
    snapshot = feed(OnlineEstimator(trial), record, trial, slice(0, 20))
    assert snapshot.phase is EstimatorPhase.WAITING
    assert np.all(np.isinf(snapshot.standard_error))


def test_a_trial_that_follows_nothing_is_refused():
    trial = sea_stream(135, 20.0).trial
    with pytest.raises(InputError, match=r"there is no \[follow\]"):
        OnlineEstimator(replace(trial, stream=None))


def test_a_ship_that_stays_the_same_is_not_stated_to_change():
    # waves known by their elevation: their forces change a little as more of it is known
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    source = open_source(require_stream(trial), once=True)
    estimator, snapshot = OnlineEstimator(trial), None
    while not source.is_over:
        for sample in source.poll(0.1):
            snapshot = estimator.update(sample)
    source.close()
    assert snapshot is not None
    assert estimator.relinearise().change is None


def test_each_run_counts_once_after_a_filter_has_been_left():
    stream = sea_stream(135, 160.0)
    trial = replace(stream.trial, stream=replace(stream.trial.stream, batch_window_s=60.0))
    estimator = OnlineEstimator(trial)
    feed(estimator, stream.record, trial, slice(0, 1000))  # beyond the window: a filter
    for rows in (slice(1050, 1250), slice(1300, 1500)):
        estimator.begin_run()
        feed(estimator, stream.record, trial, rows)
    assert [(r.name, len(r)) for r in estimator.records()] == [("stream_2", 200), ("stream_3", 200)]


def test_a_run_that_ends_as_the_window_is_full_is_not_joined_to_the_next():
    stream = sea_stream(135, 80.0)
    trial = replace(stream.trial, stream=replace(stream.trial.stream, batch_window_s=30.0))
    estimator = OnlineEstimator(trial)
    feed(estimator, stream.record, trial, slice(0, 290))
    for sample in samples(stream.record, trial, slice(290, 420)):
        # no search between: the window is found full only as the run ends
        estimator._schedule.next_search = np.inf
        estimator.update(sample)
    estimator.begin_run()
    feed(estimator, stream.record, trial, slice(500, 520))
    assert [(r.name, len(r)) for r in estimator.records()] == [("stream_2", 20)]


def test_a_run_too_short_for_its_waves_is_dropped_and_the_next_one_begins():
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    source, estimator = open_source(require_stream(trial), once=True), OnlineEstimator(trial)
    rows = source.poll(1.0)
    while not source.is_over:
        rows += source.poll(1.0)
    source.close()
    for sample in rows[:200]:
        estimator.update(sample)
    with pytest.raises(InputError, match="too short for its longest waves"):
        estimator.begin_run()
    for sample in rows[300:1000]:
        snapshot = estimator.update(sample)
    assert snapshot.runs == 2
    (record,) = estimator.records()
    assert record.time[0] >= rows[300].time


def test_where_residuals_are_not_white_it_says_that_changes_are_not_watched() -> None:
    """The moment of the waves is recorded 5 % too high, and then as it is."""
    stream = sea_stream(135, 120.0)
    moment = stream.record.channel("M5")
    wrong = {**stream.record.channels, "M5": moment.with_values(1.05 * moment.values)}
    off = feed(OnlineEstimator(stream.trial), Record("sea", stream.record.time, wrong), stream.trial)
    assert off.change is None
    assert "not watched: the residuals are not white" in off.unwatched
    assert feed(OnlineEstimator(stream.trial), stream.record, stream.trial).unwatched == ""


def test_sensors_noisier_than_declared_are_no_change_of_the_ship() -> None:
    """Twice as noisy from the first sample on; by the declared noise every drift counts four times."""
    stream, rng = sea_stream(135, 150.0, 3000), np.random.default_rng(7)
    own = stream.record.channels
    more = {s: own[s].with_values(own[s].values + sd * np.sqrt(3.0) * rng.standard_normal(len(stream.record)))
            for s, sd in (stream.trial.noise or {}).items()}  # fmt: skip
    shown = feed(OnlineEstimator(stream.trial), Record("sea", stream.record.time, {**own, **more}), stream.trial)
    assert shown.change is None
    assert shown.unwatched == ""
