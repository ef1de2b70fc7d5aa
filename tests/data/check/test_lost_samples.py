"""What is missing stays missing: channels run on, long holes begin a new part, slower channels count once."""

from dataclasses import replace

import numpy as np
import pytest
from tests.data.check.ship import with_values, zigzag

from seatrial.core.values import Record, Severity
from seatrial.core.values.arrays import Mask
from seatrial.data.check.examine import examined_record, without_repeats
from seatrial.data.check.repair import repaired_parts, repaired_whole
from seatrial.data.check.time_base import bridged, bridged_rows, read_stretch, rebuild_time_base, usual_rows


def turns(step: float = 1.0, seconds: float = 600.0) -> Record:
    """A heading that swings by 30 deg in 60 s, in tenths of a degree, beside the rudder."""
    time = step * np.arange(round(seconds / step) + 1)
    psi = np.round(np.degrees(0.5 * np.sin(2.0 * np.pi * time / 60.0)), 1)
    return Record.from_arrays("run", time, {"psi": np.radians(psi), "delta": 0.3 * np.cos(2.0 * np.pi * time / 60.0)})


def without_rows(record: Record, is_lost: Mask) -> Record:
    kept = {s: c.with_values(c.values[~is_lost]) for s, c in record.channels.items()}
    return Record(record.name, record.time[~is_lost], kept)


def test_a_fifth_of_the_rows_lost_is_one_line_and_drops_nothing(rng: np.random.Generator) -> None:
    run = turns()
    is_lost = rng.uniform(size=len(run)) < 0.2
    is_lost[[0, -1]] = False
    examined = examined_record(without_rows(run, is_lost))
    assert len(examined.parts) == 1 and len(examined.record) == len(run)
    assert np.isnan(examined.record.measured("psi")).sum() == is_lost.sum()
    np.testing.assert_allclose(examined.record["delta"], run["delta"], atol=0.03)
    (finding,) = [f for f in examined.findings if f.code == "time-gap"]
    assert f"{is_lost.sum()} of {len(run)} rows are missing" in finding.message
    assert not {"time-base", "rows-dropped", "empty-cells"} & {f.code for f in examined.findings}


def test_few_lost_rows_are_a_note() -> None:
    is_lost = np.isin(np.arange(601), [50, 200, 201])
    (finding,) = rebuild_time_base(without_rows(turns(), is_lost))[1]
    assert (finding.code, finding.severity) == ("time-gap", Severity.INFO)


def test_a_hole_longer_than_the_memory_of_the_motion_begins_a_new_part() -> None:
    run = turns()
    assert 5 < bridged_rows(run) < 20  # a quarter of the swing is 15 s
    long = np.isin(np.arange(601), np.arange(200, 260))
    parts = examined_record(without_rows(run, long)).parts
    assert [len(part) for part in parts] == [200, 341] and parts[1].time[0] == pytest.approx(260.0)
    short = np.isin(np.arange(601), np.arange(200, 206))
    assert [len(part) for part in examined_record(without_rows(run, short)).parts] == [601]


def test_commands_stay_as_they_were_and_outputs_are_not_measured() -> None:
    values = np.array([1.0, np.nan, np.nan, 2.0, 2.0, 2.0])
    record = Record.from_arrays("run", np.arange(6.0), {"command_1": values, "u": values})
    held = replace(record.channel("command_1"), kind="command")
    bridge = bridged(record.with_channel("command_1", held))
    np.testing.assert_array_equal(bridge.record["command_1"], [1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    np.testing.assert_allclose(bridge.record["u"], [1.0, 4.0 / 3.0, 5.0 / 3.0, 2.0, 2.0, 2.0])
    np.testing.assert_array_equal(bridge.record.measured("u"), values)
    assert bridge.record.channel("command_1").is_measured is None


def test_a_slower_channel_is_one_note_and_counts_where_it_is_new() -> None:
    run = turns(0.2)
    held = with_values(run, psi=run["psi"][np.arange(len(run)) // 5 * 5])
    examined = examined_record(held)
    (note,) = [f for f in examined.findings if f.severity is Severity.INFO]
    assert note.code == "slower-channel" and "psi every 1 s, a row every 0.2 s" in note.evidence
    assert np.flatnonzero(np.isfinite(examined.record.measured("psi")))[:3].tolist() == [0, 5, 10]
    np.testing.assert_allclose(examined.record["psi"], run["psi"], atol=0.01)
    assert usual_rows(np.array([0, 5, 10, 15])) == 5.0


def test_a_rudder_order_that_stays_is_left_alone() -> None:
    run = turns(0.2)
    steps = with_values(run, delta=0.3 * np.sign(run["delta"]))
    np.testing.assert_array_equal(without_repeats(steps)["delta"], steps["delta"])


def test_checks_compare_where_every_channel_was_read() -> None:
    values = np.array(zigzag(noise=1.0)["u"])
    values[500:1500] = np.nan
    (part,) = repaired_parts(with_values(zigzag(noise=1.0), u=values))[0]
    assert len(part) == 3000 and len(read_stretch(part)) == 1500


def test_a_draft_looks_at_the_whole_of_a_log_with_a_hole() -> None:
    holed = np.isin(np.arange(601), np.arange(200, 260))
    even, _ = rebuild_time_base(without_rows(turns(), holed))
    assert len(repaired_whole(even)) == 601
