"""A report of progress: its phase, and how many of how many parts are done where it counts them."""

import pytest

from seatrial.core.text.progress import ProgressReport, read_report


@pytest.mark.parametrize(
    ("text", "report"),
    [
        ("report", ProgressReport("report", "", 0, 0)),
        ("prediction: 3 of 12, zigzag_20", ProgressReport("prediction", "3 of 12, zigzag_20", 3, 12)),
        ("search: evaluation 5, cost 1.5", ProgressReport("search", "evaluation 5, cost 1.5", 0, 0)),
        ("own estimate: search: 2 of 4", ProgressReport("own estimate", "search: 2 of 4", 2, 4)),
    ],
)
def test_phase_and_count_are_read(text: str, report: ProgressReport) -> None:
    assert read_report(text) == report
