"""Reports of a stream: the newest in words, one point of the plots each, in display units and in what JSON can hold."""

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.onboard.fabricated import faulty_counts, heave_pitch, mmg
from tests.reporting.fabricated import zigzag

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.onboard.stream_report import StreamReporter, recent_json


def reported(snapshot: Snapshot, counts: SampleCounts, reporter: StreamReporter | None = None) -> dict[str, Any]:
    """A report as the workspace reads it."""
    report = (reporter or StreamReporter()).report(snapshot, counts)
    assert report is not None
    return json.loads(json.dumps(report, allow_nan=False))


def test_a_report_has_the_newest_in_words_and_one_point() -> None:
    reporter, snapshots = StreamReporter("trial.toml"), list(heave_pitch(100.0))
    reports = [reported(snapshot, faulty_counts(), reporter) for snapshot in snapshots]
    assert [report["point"][0] for report in reports] == list(range(201))
    assert reports[0]["point"][2:4] == [[pytest.approx(v) for v in snapshots[0].value], [None] * 8]
    assert reports[149]["point"][3] == pytest.approx(1.96 * snapshots[149].standard_error)
    last = reports[-1]
    assert last["title"] == "trial.toml" and {report["epoch"] for report in reports} == {last["epoch"]}
    assert last["snapshot"]["phase"] == "recursive" and last["snapshot"]["rows"][0]["name"] == "a33"
    assert ["wrong checksum", 4] in last["snapshot"]["faults"]


def test_angles_are_degrees_in_plots_as_in_the_table() -> None:
    snapshot = list(mmg(100.0))[-1]
    report = reported(snapshot, SampleCounts())
    assert report["point"][2][-1] == pytest.approx(np.degrees(snapshot.value[-1]))
    assert report["point"][4][-1] == pytest.approx(np.degrees(snapshot.noise["psi"]))
    assert report["snapshot"]["rows"][-1]["unit"] == "deg" and report["snapshot"]["noise"][-1]["unit"] == "deg"


def test_other_coefficients_and_another_stream_are_another_epoch() -> None:
    reporter = StreamReporter()
    first = reported(next(iter(heave_pitch(0.0))), SampleCounts(), reporter)
    second = reported(next(iter(mmg(0.0))), SampleCounts(), reporter)
    third = reported(next(iter(mmg(0.0))), SampleCounts())
    assert len({report["epoch"] for report in (first, second, third)}) == 3 and second["point"][0] == 0


def test_the_same_again_is_no_news_and_other_counts_are_no_point() -> None:
    reporter, snapshot = StreamReporter(), next(iter(heave_pitch(0.0)))
    assert reporter.report(snapshot, SampleCounts()) is not None
    assert reporter.report(snapshot, SampleCounts()) is None
    assert reported(snapshot, SampleCounts(late=1), reporter)["point"][0] == 0


def test_control_characters_and_infinities_do_not_reach_the_page() -> None:
    snapshot = replace(list(heave_pitch(10.0))[-1], time=np.inf, noise={"z": np.nan}, unidentified=("a33",))
    shows = reported(snapshot, replace(faulty_counts(), last_problem="\x1b[2J\x00 sentence"))["snapshot"]
    assert shows["last"] == "·[2J· sentence" and shows["time"] == "–" and shows["noise"][0]["rms"] == "–"


def test_the_run_so_far_has_track_rudder_and_heading_in_degrees() -> None:
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
