"""The run so far: thinned evenly, the newest sample always in it, forgotten when another begins."""

import numpy as np
from tests.onboard.streams import sample_range, stream_trial

from seatrial.data.trial.runs import require_stream
from seatrial.onboard.stream_session import RecentRun


def test_a_long_run_is_thinned_and_ends_with_the_newest() -> None:
    run = RecentRun(require_stream(stream_trial()).layout, limit=50)
    assert run.records() == ()
    for sample in sample_range(0, 1203):
        run.add(sample)
    (record,) = run.records()
    assert len(record) <= 52 and record.time[-1] == 120.2 and record.time[0] == 0.0
    assert len(set(np.round(np.diff(record.time)[:-1], 6))) == 1
    run.start_run()
    assert run.records() == ()
