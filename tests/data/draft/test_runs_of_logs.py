"""Logs of several runs with several files each: grouped by clock or by name, and read as one where one run shows it."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from tests.data.draft.test_draft import BASE, TRUTH, write

from seatrial.api import draft_trial, survey_log
from seatrial.core.values import Array, InputError
from seatrial.data.draft import ColumnGuess, runs_of_logs
from seatrial.data.draft.column_guess import agreed_guesses
from seatrial.data.trial import load_runs

DEGREE = np.pi / 180.0
COURSE = np.mod(np.degrees(np.arctan2(TRUTH["east"], TRUTH["north"])), 360.0)
KNOTS = np.hypot(TRUTH["north"], TRUTH["east"]) * 3600.0 / 1852.0


def write_dated(path: Path, start: datetime, columns: dict[str, Array], rows: slice = slice(None)) -> None:
    stamps = [(start + timedelta(seconds=float(t))).isoformat(timespec="milliseconds") for t in TRUTH["t"][rows]]
    table = np.column_stack([values[rows] for values in columns.values()]).tolist()
    lines = [f"Time,{','.join(columns)}"]
    lines += [f"{t},{','.join(f'{x:.7f}' for x in row)}" for t, row in zip(stamps, table, strict=True)]
    path.write_text("\n".join(lines), encoding="utf-8")


def ship_log(folder: Path, *, local_time: timedelta = timedelta(0)) -> None:
    """Two runs, each in two files with clocks of their own: latitude, speed, course and heading; rudder."""
    lat, lon = 58.0 + TRUTH["x0"] / 111_340.0, 10.0 + TRUTH["y0"] / (111_340.0 * np.cos(58.0 * DEGREE))
    navigation = {"Lat": lat, "Lon": lon, "SOG": KNOTS, "COG": COURSE, "HDG": BASE["heading"]}
    for name, hour, rows in (("zigzag", 9, slice(0, 900)), ("circle", 11, slice(1300, 2300))):
        start = datetime(2026, 5, 14, hour, tzinfo=UTC)
        write_dated(folder / f"{name}_nav.csv", start, navigation, rows)
        rudder = {"Rudder": TRUTH["delta"] / DEGREE}
        write_dated(folder / f"{name}_gear.csv", start + local_time + timedelta(seconds=0.1), rudder, rows)


@pytest.mark.parametrize("local_time", [timedelta(0), timedelta(hours=12)])
def test_files_that_overlap_in_time_are_one_run(local_time: timedelta, tmp_path: Path) -> None:
    ship_log(tmp_path, local_time=local_time)
    draft = draft_trial(tmp_path, folder=tmp_path)
    assert [(run.name, len(run.sources)) for run in draft.runs] == [("zigzag", 2), ("circle", 2)]
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    runs = load_runs(tmp_path / "trial.toml")
    assert [run.name for run in runs] == ["zigzag", "circle"]
    assert set(runs[1].raw_record().channels) == {"x0", "y0", "u", "v", "psi", "delta"}


def test_what_one_run_shows_holds_for_all(tmp_path: Path) -> None:
    ship_log(tmp_path)
    used = {g.symbol: g for part in draft_trial(tmp_path).guesses for g in part if g.is_used}
    assert (used["sog"].unit, used["sog"].is_open) == ("kn", False)
    assert (used["delta"].positive, used["delta"].is_open) == ("", False)
    assert "[sensors]" not in draft_trial(tmp_path).text  # the first model has no velocities
    assert '\nvelocity = "ground"' in draft_trial(tmp_path, length=100.0).text


def test_a_circle_alone_does_not_turn_a_rudder_round(tmp_path: Path) -> None:
    rows = slice(1300, 2300)
    columns = {name: values[rows] for name, values in BASE.items()}
    write(tmp_path / "circle.csv", columns | {"rudder": TRUTH["delta"][rows] / DEGREE})
    (part,) = draft_trial(tmp_path / "circle.csv").guesses
    rudder = next(g for g in part if g.symbol == "delta")
    assert rudder.is_open or rudder.positive == ""


def test_names_group_files_whose_clocks_start_anew(tmp_path: Path) -> None:
    for name in ("run_a", "run_b"):
        write(tmp_path / f"{name}_nav.csv", BASE)
        write(tmp_path / f"{name}_gear.csv", {"time": TRUTH["t"], "rudder": TRUTH["delta"] / DEGREE})
    surveys = [survey_log(path) for path in sorted(tmp_path.glob("*.csv"))]
    assert [run.name for run in runs_of_logs(surveys)] == ["run_a", "run_b"]
    assert [run.name for run in runs_of_logs(surveys[:1])] == [""]
    assert [run.sources[0].path.stem for run in runs_of_logs(surveys[:3])] == ["run_a_gear", "run_b_gear"]
    assert [len(run.sources) for run in runs_of_logs(surveys[:2])] == [2]


def test_runs_that_contradict_each_other_leave_it_open() -> None:
    guess = ColumnGuess("rudder", "delta", "deg", other_reading='positive = "port"')
    starboard, port = (ColumnGuess("rudder", "delta", "deg", positive=side) for side in ("", "port"))
    ((one,),) = agreed_guesses([[guess]], [[[starboard]], [[port]]])
    assert one.is_open and 'positive = "port": the runs contradict each other' in one.other_reading
    ((one,),) = agreed_guesses([[guess]], [[[guess]], [[port]]])
    assert not one.is_open and one.positive == "port"
    assert agreed_guesses([[guess]], []) == ((guess,),)


def test_what_is_no_log_in_a_folder_is_left_out_and_named(tmp_path: Path) -> None:
    for name in ("zigzag_1", "zigzag_2"):
        write(tmp_path / f"{name}.csv", BASE)
    (tmp_path / "curve.csv").write_text("KT,J\n0.3,0.0\n0.2,0.4\n0.1,0.1\n", encoding="utf-8")
    (tmp_path / "units.csv").write_text("column,unit\nx,m\n", encoding="utf-8")
    write(tmp_path / "wind.csv", {"time": TRUTH["t"], "wind": TRUTH["u"]})
    draft = draft_trial(tmp_path, folder=tmp_path)
    assert [run.sources[0].path.stem for run in draft.runs] == ["zigzag_1", "zigzag_2"]
    for text in (
        "curve.csv: no column is a time",
        "units.csv: units.csv has no rows",
        "wind.csv: it is of another kind",
    ):
        assert f"# left out: {text}" in draft.text
    with pytest.raises(InputError, match="has no rows of numbers"):
        draft_trial(tmp_path / "zigzag_1.csv", tmp_path / "units.csv")
    (tmp_path / "none").mkdir()
    (tmp_path / "units.csv").rename(tmp_path / "none" / "units.csv")
    with pytest.raises(InputError, match=r"there is no log to draft a trial of: .*units\.csv"):
        draft_trial(tmp_path / "none")


def test_files_that_each_hold_heading_and_rudder_are_runs(tmp_path: Path) -> None:
    columns = BASE | {"rudder": TRUTH["delta"] / DEGREE}
    write(tmp_path / "zigzag.csv", {key: values[:900] for key, values in columns.items()})
    write(tmp_path / "circle.csv", {key: v[1300:2300] for key, v in columns.items()} | {"rpm": np.full(1000, 90.0)})
    assert [(run.name, len(run.sources)) for run in draft_trial(tmp_path).runs] == [("circle", 1), ("zigzag", 1)]
