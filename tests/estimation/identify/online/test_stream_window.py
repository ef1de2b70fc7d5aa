"""The samples kept, run by run."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.identify.online.streams import samples, sea_stream, window_of

from seatrial.core.values import InputError
from seatrial.estimation.identify.online.estimator import StreamWindow


@pytest.fixture(scope="module")
def stream():
    return sea_stream(135, 30.0)


def test_durations_and_samples_add_up_over_runs(stream):
    window = window_of(stream, slice(0, 101))
    window.begin_run(2)
    for sample in samples(stream.record, stream.trial, slice(150, 201)):
        window.add(np.array([sample.time]), sample.values[None])
    assert window.samples == 152
    assert window.open_samples == 51
    assert window.seconds == pytest.approx(15.0)
    assert [r.name for r in window.records()] == ["stream", "stream_2"]


def test_a_run_of_two_samples_is_left_out_and_keeps_its_number(stream):
    window = window_of(stream, slice(0, 50))
    window.begin_run(2)
    for sample in samples(stream.record, stream.trial, slice(60, 62)):
        window.add(np.array([sample.time]), sample.values[None])
    window.begin_run(3)
    for sample in samples(stream.record, stream.trial, slice(70, 100)):
        window.add(np.array([sample.time]), sample.values[None])
    assert [r.name for r in window.training_runs()] == ["stream", "stream_3"]
    assert window.samples == 80


def test_records_are_at_the_rate_of_the_trial(stream):
    slow = replace(stream.trial, estimate=replace(stream.trial.estimate, rate=5.0))
    window = StreamWindow(slow)
    window.begin_run(1)
    for sample in samples(stream.record, slow, slice(0, 101)):
        window.add(np.array([sample.time]), sample.values[None])
    assert window.records()[0].dt == pytest.approx(0.2)


def test_a_cleared_window_goes_on_with_the_same_run(stream):
    window = window_of(stream, slice(0, 50))
    window.clear()
    assert window.samples == 0
    assert window.seconds == 0.0
    assert window.records() == []
    for sample in samples(stream.record, stream.trial, slice(50, 60)):
        window.add(np.array([sample.time]), sample.values[None])
    np.testing.assert_array_equal(window.training_runs()[0].raw_record().time, stream.record.time[50:60])


def test_a_sample_needs_a_run(stream):
    window = StreamWindow(stream.trial)
    assert not window.has_run
    with pytest.raises(RuntimeError, match="begin_run"):
        (sample,) = samples(stream.record, stream.trial, slice(0, 1))
        window.add(np.array([sample.time]), sample.values[None])


def test_a_trial_that_follows_nothing_is_refused(stream):
    with pytest.raises(InputError, match=r"\[follow\]"):
        StreamWindow(replace(stream.trial, stream=None))
