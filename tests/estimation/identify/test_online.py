"""Fed sample by sample: the numbers of the batch fit on the same samples, and what is carried on beyond the window."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.results.online import EstimatorPhase, Sample, Snapshot
from seatrial.core.values import NOTATION, InputError, Record
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial import load_trial
from seatrial.data.trial.follow_table import require_stream
from seatrial.data.trial.trial import Stream, StreamSource, Trial
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.onboard.sources import open_source
from seatrial.physics.models.qi2025 import SHIP
from seatrial_studies.output_error_fit import with_physics_start
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, SeawayScenario, ship, simulate_seaway_run

EXAMPLES = Path(__file__).parents[3] / "examples"
CHANNELS = ("F3", "M5", "delta_f1", "z", "theta")
LAYOUT = Layout(
    "text", ColumnSpec("time", 1, "s"), tuple(ColumnSpec(c, k + 2, NOTATION[c].unit) for k, c in enumerate(CHANNELS))
)


def _voyage(heading: int, duration: float) -> tuple[Trial, Record, np.ndarray]:
    voyage = SeawayScenario(heading, duration=duration)
    made = simulate_seaway_run(voyage, np.random.default_rng(1))
    model = with_physics_start(made.truth)
    truth = np.array([made.truth.parameters[n].value for n in model.parameters.free_names])
    noise = {"z": HEAVE_NOISE, "theta": PITCH_NOISE}
    trial = Trial(ship=SHIP, runs=(), model=model, noise=noise, stream=Stream(StreamSource.STDIN, LAYOUT, 10.0))
    return trial, made.with_sensor_noise(np.random.default_rng(2), voyage), truth


def _fed(estimator: OnlineEstimator, record: Record, rows: slice = slice(None)) -> Snapshot:
    values = np.stack([record[c] for c in CHANNELS], axis=1)[rows]
    shown = None
    for time, row in zip(record.time[rows], values, strict=True):
        shown = estimator.update(Sample(float(time), row))
    assert shown is not None
    return shown


@pytest.mark.parametrize("heading", [90, 135, 180])
def test_the_numbers_are_those_of_the_batch_fit_on_the_same_samples(heading):
    trial, record, _ = _voyage(heading, 120.0)
    estimator = OnlineEstimator(trial)
    _fed(estimator, record)
    shown = estimator.relinearise()
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    batch = {c.name: c for c in fit.coefficients}
    off = [(v - batch[n].estimate) / batch[n].standard_error for n, v in zip(shown.names, shown.value, strict=True)]
    assert np.max(np.abs(off)) < 0.01
    np.testing.assert_allclose(shown.standard_error, [batch[n].standard_error for n in shown.names], rtol=0.01)


def test_one_per_cent_is_reached_within_the_first_minute():
    trial, record, truth = _voyage(135, 60.0)
    shown = _fed(OnlineEstimator(trial), record)
    assert shown.phase is EstimatorPhase.WINDOW
    assert np.mean(np.abs(shown.value / truth - 1.0)) < 0.01


def test_beyond_the_window_a_filter_carries_its_information_on():
    trial, record, _ = _voyage(135, 300.0)
    whole = OnlineEstimator(trial)
    _fed(whole, record)
    best = whole.relinearise()
    short = OnlineEstimator(replace(trial, stream=replace(trial.stream, batch_window=120.0)))
    _fed(short, record)
    shown = short.relinearise()
    assert shown.phase is EstimatorPhase.RECURSIVE
    np.testing.assert_allclose(shown.standard_error, best.standard_error, rtol=0.02)
    assert np.all(np.abs(shown.value - best.value) < 0.1 * best.standard_error)


def test_a_gap_beyond_the_window_goes_on_with_what_the_filter_knew():
    trial, record, truth = _voyage(135, 400.0)
    estimator = OnlineEstimator(replace(trial, stream=replace(trial.stream, batch_window=120.0)))
    _fed(estimator, record, slice(0, 2000))
    known = estimator.relinearise()
    estimator.begin_run()
    _fed(estimator, record, slice(2200, None))
    shown = estimator.relinearise()
    assert shown.runs == 2
    assert np.all(shown.standard_error < known.standard_error)
    assert np.all(np.abs(shown.value - truth) < 5.0 * shown.standard_error)


@pytest.mark.parametrize("forgetting", [None, 60.0])
def test_a_ship_that_becomes_another_is_told_and_followed(forgetting):
    trial, record, truth = _voyage(90, 240.0)
    voyage = SeawayScenario(90, duration=240.0)
    heavy = ship(90).with_values({"a33": 1.5 * ship(90).parameters["a33"].value})
    loaded = simulate_seaway_run(voyage, np.random.default_rng(5), heavy).with_sensor_noise(
        np.random.default_rng(6), voyage
    )
    estimator = OnlineEstimator(
        replace(trial, stream=replace(trial.stream, batch_window=60.0, forgetting_time=forgetting))
    )
    _fed(estimator, record)
    before = estimator.relinearise().change
    assert before is None or not before.is_significant
    estimator.begin_run()
    _fed(estimator, loaded)
    shown = estimator.relinearise()
    assert shown.change is not None
    assert shown.change.is_significant
    place = list(trial.model.parameters.free_names).index("a33")
    assert abs(shown.value[place] / (1.5 * truth[place]) - 1.0) < 0.01


def test_the_same_samples_give_the_same_bits():
    trial, record, _ = _voyage(90, 30.0)
    first, again = (_fed(OnlineEstimator(trial), record) for _ in range(2))
    assert np.array_equal(first.value, again.value)
    assert np.array_equal(first.standard_error, again.standard_error)


def test_a_gap_begins_another_run_and_both_tell():
    trial, record, _ = _voyage(135, 80.0)
    estimator = OnlineEstimator(trial)
    _fed(estimator, record, slice(0, 400))
    alone = estimator.relinearise().standard_error
    estimator.begin_run()
    _fed(estimator, record, slice(450, None))
    both = estimator.relinearise()
    assert both.runs == 2
    assert np.all(both.standard_error < alone)


def test_nothing_is_claimed_before_there_is_something_to_claim():
    trial, record, _ = _voyage(135, 20.0)
    shown = _fed(OnlineEstimator(trial), record, slice(0, 20))
    assert shown.phase is EstimatorPhase.WAITING
    assert np.all(np.isinf(shown.standard_error))


def test_a_trial_that_follows_nothing_is_refused():
    trial, _, _ = _voyage(135, 20.0)
    with pytest.raises(InputError, match=r"there is no \[follow\]"):
        OnlineEstimator(replace(trial, stream=None))


def test_a_ship_that_stays_the_same_is_not_told_to_change():
    # waves known by their elevation: their forces change a little as more of it is known
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    source = open_source(require_stream(trial), once=True)
    estimator, shown = OnlineEstimator(trial), None
    while not source.is_over:
        for sample in source.poll(0.1):
            shown = estimator.update(sample)
    source.close()
    assert shown is not None
    last = estimator.relinearise()
    assert last.change is None or not last.change.is_significant
