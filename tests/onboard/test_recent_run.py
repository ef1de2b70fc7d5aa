"""The run so far: thinned evenly, the newest sample always in it, forgotten when another begins."""

import json
import math

import numpy as np
from tests.onboard.streams import sample_range, stream_trial
from tests.reporting.fabricated import zigzag

from seatrial.data.trial.runs import require_stream
from seatrial.onboard.page import recent_json
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


def test_the_page_gets_track_rudder_and_heading_in_degrees() -> None:
    record = zigzag("z", 20.0)
    shown = recent_json((record,))
    assert [channel["label"] for channel in shown["channels"]] == ["δ [deg]", "ψ [deg]"]
    assert max(shown["channels"][0]["values"]) == round(math.degrees(record["delta"].max()), 4)
    assert shown["track"]["x0"][-1] == float(f"{record['x0'][-1]:.8g}")
    assert json.loads(json.dumps(shown, allow_nan=False)) == shown


def test_without_rudder_and_positions_the_first_channels_that_move_are_shown() -> None:
    record = zigzag("z", 20.0).without("delta", "psi", "x0", "y0")
    shown = recent_json((record,))
    assert shown["track"] is None and [c["label"] for c in shown["channels"]] == ["r [deg/s]", "u [m/s]"]
    assert recent_json(()) == {"track": None, "channels": []}
