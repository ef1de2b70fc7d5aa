"""Runs of one day share a session in a draft, by their names or time stamps."""

from pathlib import Path

import pytest

from seatrial.data.draft.guess import guess_columns
from seatrial.data.draft.runs_of_logs import LogRun, is_one_place, session_line
from seatrial.data.draft.survey import survey_log


def _run(folder: Path, name: str, first: str) -> LogRun:
    rows = "".join(f"{first}{k:02d},{k}\n" for k in range(20))
    (folder / f"{name}.csv").write_text(f"utc,rudder\n{rows}")
    return LogRun("", (survey_log(folder / f"{name}.csv"),))


@pytest.mark.parametrize(
    ("days", "line"),
    [
        (("2026-08-14", "2026-08-14"), 'session = "all"    # every run is of 2026-08-14'),
        (("2026-08-14", "2026-08-14", "2026-08-15"), 'session = "day"    # runs of 2 days'),
        (("2026-08-14", "2026-08-15"), ""),
        (("2026-08-14",), ""),
    ],
)
def test_the_line_follows_from_the_days_of_the_stamps(tmp_path: Path, days: tuple[str, ...], line: str) -> None:
    runs = [_run(tmp_path, f"run{k}", f"{day}T07:30:") for k, day in enumerate(days)]
    assert session_line(runs)[: len(line)] == line and bool(session_line(runs)) == bool(line)


def test_a_day_in_the_name_counts_and_a_time_of_day_is_none(tmp_path: Path) -> None:
    named = [_run(tmp_path, f"2026-08-14_{k}", "07:30:") for k in "ab"]
    assert session_line(named).startswith('session = "all"')
    assert session_line([_run(tmp_path, k, "07:30:") for k in "ab"]) == ""


def test_runs_of_one_model_in_a_basin_share_its_rudder(tmp_path: Path) -> None:
    runs = [_run(tmp_path, k, "07:30:") for k in "ab"]
    assert session_line(runs, is_in_basin=True).startswith('session = "all"    # of one model in a basin')
    assert session_line(runs[:1], is_in_basin=True) == ""


def test_clocks_without_a_date_that_go_on_are_of_one_day(tmp_path: Path) -> None:
    later = [_run(tmp_path, name, first) for name, first in (("a", "07:30:"), ("b", "08:10:"))]
    assert session_line(later).startswith('session = "all"    # clocks without a date go on')


def test_runs_of_one_place_without_dates_are_of_one_outing(tmp_path: Path) -> None:
    runs = [_run(tmp_path, k, "07:30:") for k in "ab"]
    assert session_line(runs, is_one_place=True).startswith('session = "all"    # of one place by their fixes')
    assert session_line([_run(tmp_path, k, f"2026-08-1{k}T07:30:") for k in "45"], is_one_place=True) == ""


@pytest.mark.parametrize(("third", "is_one"), [(54.12, True), (54.40, False)])
def test_a_place_is_one_by_the_gaps_between_runs_however_far_they_reach(
    tmp_path: Path, third: float, *, is_one: bool
) -> None:
    """Each run covers 9 km of latitude, as a ship does in twenty minutes."""
    runs = list[LogRun]()
    for k, south in enumerate((54.0, 54.05, third)):
        rows = "".join(f"{t},{south + 0.004 * t:.4f},10.5\n" for t in range(20))
        (tmp_path / f"{k}.csv").write_text(f"time [s],lat [deg],lon [deg]\n{rows}")
        runs.append(LogRun("", (survey_log(tmp_path / f"{k}.csv"),)))
    assert is_one_place(runs, [[guess_columns(run.sources[0])] for run in runs]) is is_one
