"""Times in findings count from the start of the run; the logger's own stand in brackets."""

from dataclasses import replace

import pytest
from tests.data.check.ship import zigzag

from seatrial.core.values import Finding, Severity
from seatrial.data.check import examine
from seatrial.data.check.consequences import moment, on_run_clock


def finding(text: str) -> Finding:
    return Finding(Severity.INFO, "code", "message", text)


@pytest.mark.parametrize(
    ("start", "text"),
    [(0.0, "at t = 1012.3 s"), (1000.0, "at t = 12.3 s [clock 1012.3 s]"), (-7.7, "at t = 1020 s [clock 1012.3 s]")],
)
def test_a_time_counts_from_the_start(start: float, text: str) -> None:
    assert on_run_clock(finding(f"at {moment(1012.3)}"), start).evidence == text


def test_both_ends_of_a_stretch_and_stamps_since_1970_keep_their_digits() -> None:
    text = f"from {moment(1778750400.25, 1778750401.5)}"
    expected = "from t = 0.25 to 1.5 s [clock 1778750400.25 to 1778750401.5 s]"
    assert on_run_clock(finding(text), 1778750400.0).evidence == expected


def test_findings_of_a_check_count_from_the_first_stamp() -> None:
    record = zigzag(noise=1.0)
    u = record["u"].copy()
    u[500:700] = u[500]
    late = replace(record, time=record.time + 900.0).with_channel("u", record.channel("u").with_values(u))
    (stuck,) = (one for one in examine(late) if one.code == "stuck")
    assert stuck.evidence.endswith("from t = 50 to 69.9 s [clock 950 to 969.9 s]")
