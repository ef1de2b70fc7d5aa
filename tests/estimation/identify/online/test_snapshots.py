"""What is shown before there is an estimate, and the count of what was received."""

import numpy as np
from tests.estimation.identify.online.streams import sea_stream

from seatrial.core.results.online import EstimatorPhase
from seatrial.estimation.identify.online.phases import StreamProgress, at_progress, first_snapshot


def test_breaks_between_runs_do_not_count_as_time():
    progress = StreamProgress().with_run().with_sample(10.0).with_sample(10.5).with_run().with_sample(100.0)
    progress = progress.with_sample(100.25)
    assert (progress.samples, progress.runs) == (4, 2)
    assert progress.elapsed == 0.75
    assert progress.last_time == 100.25


def test_before_the_first_sample_start_values_are_shown_without_confidence():
    trial = sea_stream(135, 10.0).trial
    snapshot = first_snapshot(trial.model)
    assert snapshot.phase is EstimatorPhase.WAITING
    np.testing.assert_array_equal(snapshot.value, [p.value for p in trial.model.parameters.free])
    assert np.all(np.isinf(snapshot.standard_error))
    later = at_progress(snapshot, StreamProgress().with_run().with_sample(3.0))
    assert (later.time, later.samples, later.runs) == (3.0, 1, 1)
