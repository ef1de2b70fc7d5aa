"""Fed sample by sample: the numbers of the batch fit on the same samples, and what is carried on beyond the window."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.results.online import Phase, Sample, Snapshot
from seatrial.core.values import NOTATION, InputError, Record
from seatrial.data.read import Column, Layout
from seatrial.data.trial import load_trial
from seatrial.data.trial.follow_table import followed
from seatrial.data.trial.trial import Feed, Stream, Trial
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.identify.online import Online
from seatrial.onboard.opened import source_of
from seatrial.physics.models.qi2025 import SHIP
from seatrial_studies.own_fit import started
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, Voyage, sailed, ship

EXAMPLES = Path(__file__).parents[3] / "examples"
CHANNELS = ("F3", "M5", "delta_f1", "z", "theta")
LAYOUT = Layout(
    "text", Column("time", 1, "s"), tuple(Column(c, k + 2, NOTATION[c].unit) for k, c in enumerate(CHANNELS))
)


def _voyage(heading: int, duration: float) -> tuple[Trial, Record, np.ndarray]:
    voyage = Voyage(heading, duration=duration)
    made = sailed(voyage, np.random.default_rng(1))
    model = started(made.truth)
    truth = np.array([made.truth.parameters[n].value for n in model.parameters.free_names])
    noise = {"z": HEAVE_NOISE, "theta": PITCH_NOISE}
    trial = Trial(ship=SHIP, runs=(), model=model, noise=noise, follow=Stream(Feed.STDIN, LAYOUT, 10.0))
    return trial, made.noisy(np.random.default_rng(2), voyage), truth


def _fed(estimator: Online, record: Record, rows: slice = slice(None)) -> Snapshot:
    values = np.stack([record[c] for c in CHANNELS], axis=1)[rows]
    shown = None
    for time, row in zip(record.time[rows], values, strict=True):
        shown = estimator.update(Sample(float(time), row))
    assert shown is not None
    return shown


@pytest.mark.parametrize("heading", [90, 135, 180])
def test_the_numbers_are_those_of_the_batch_fit_on_the_same_samples(heading):
    trial, record, _ = _voyage(heading, 120.0)
    estimator = Online(trial)
    _fed(estimator, record)
    shown = estimator.relinearise()
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    batch = {c.name: c for c in fit.coefficients}
    off = [(v - batch[n].estimate) / batch[n].standard_error for n, v in zip(shown.names, shown.value, strict=True)]
    assert np.max(np.abs(off)) < 0.01
    np.testing.assert_allclose(shown.standard_error, [batch[n].standard_error for n in shown.names], rtol=0.01)


def test_one_per_cent_is_reached_within_the_first_minute():
    trial, record, truth = _voyage(135, 60.0)
    shown = _fed(Online(trial), record)
    assert shown.phase is Phase.WINDOW
    assert np.mean(np.abs(shown.value / truth - 1.0)) < 0.01


def test_beyond_the_window_a_filter_carries_its_information_on():
    trial, record, _ = _voyage(135, 300.0)
    whole = Online(trial)
    _fed(whole, record)
    best = whole.relinearise()
    short = Online(replace(trial, follow=replace(trial.follow, whole=120.0)))
    _fed(short, record)
    shown = short.relinearise()
    assert shown.phase is Phase.RECURSIVE
    np.testing.assert_allclose(shown.standard_error, best.standard_error, rtol=0.02)
    assert np.all(np.abs(shown.value - best.value) < 0.1 * best.standard_error)


def test_a_gap_beyond_the_window_goes_on_with_what_the_filter_knew():
    trial, record, truth = _voyage(135, 400.0)
    estimator = Online(replace(trial, follow=replace(trial.follow, whole=120.0)))
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
    voyage = Voyage(90, duration=240.0)
    heavy = ship(90).with_values({"a33": 1.5 * ship(90).parameters["a33"].value})
    loaded = sailed(voyage, np.random.default_rng(5), heavy).noisy(np.random.default_rng(6), voyage)
    estimator = Online(replace(trial, follow=replace(trial.follow, whole=60.0, forgetting=forgetting)))
    _fed(estimator, record)
    before = estimator.relinearise().change
    assert before is None or not before.is_told
    estimator.begin_run()
    _fed(estimator, loaded)
    shown = estimator.relinearise()
    assert shown.change is not None
    assert shown.change.is_told
    place = list(trial.model.parameters.free_names).index("a33")
    assert abs(shown.value[place] / (1.5 * truth[place]) - 1.0) < 0.01


def test_the_same_samples_give_the_same_bits():
    trial, record, _ = _voyage(90, 30.0)
    first, again = (_fed(Online(trial), record) for _ in range(2))
    assert np.array_equal(first.value, again.value)
    assert np.array_equal(first.standard_error, again.standard_error)


def test_a_gap_begins_another_run_and_both_tell():
    trial, record, _ = _voyage(135, 80.0)
    estimator = Online(trial)
    _fed(estimator, record, slice(0, 400))
    alone = estimator.relinearise().standard_error
    estimator.begin_run()
    _fed(estimator, record, slice(450, None))
    both = estimator.relinearise()
    assert both.runs == 2
    assert np.all(both.standard_error < alone)


def test_nothing_is_claimed_before_there_is_something_to_claim():
    trial, record, _ = _voyage(135, 20.0)
    shown = _fed(Online(trial), record, slice(0, 20))
    assert shown.phase is Phase.WAITING
    assert np.all(np.isinf(shown.standard_error))


def test_a_trial_that_follows_nothing_is_refused():
    trial, _, _ = _voyage(135, 20.0)
    with pytest.raises(InputError, match=r"there is no \[follow\]"):
        Online(replace(trial, follow=None))


def test_a_ship_that_stays_the_same_is_not_told_to_change():
    # waves known by their elevation: their forces change a little as more of it is known
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    source = source_of(followed(trial), once=True)
    estimator, shown = Online(trial), None
    while not source.is_over:
        for sample in source.poll(0.1):
            shown = estimator.update(sample)
    source.close()
    assert shown is not None
    last = estimator.relinearise()
    assert last.change is None or not last.change.is_told
