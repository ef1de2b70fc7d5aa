"""Tables as loggers write them: settings above, names in comments or in two rows, any line end, dates of any order."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.draft import survey_log
from seatrial.data.read import ColumnSpec
from seatrial.data.read.clock import stamps
from seatrial.data.read.log import RawTable

ROWS = [
    (f"{0.5 * k:.2f}", f"{20.0 * np.sin(k / 20.0) + 100.0:.2f}", "10.0" if k // 40 % 2 else "-10.0") for k in range(90)
]
NAMES = ("time", "heading", "rudder")


def _text(header: str, separator: str, end: str = "\n", trail: str = "") -> str:
    return header + "".join(separator.join(row) + trail + end for row in ROWS)


@pytest.mark.parametrize(
    "text",
    [
        _text("LOGGER 2\nSERIAL:,12\nGAIN:,1.2\ntime,heading,rudder\n", ","),
        _text("".join(f"KEY{k}:\t{k}\n" for k in range(45)) + "\n--- LOG ---\ntime\theading\trudder\n", "\t"),
        _text("# time heading rudder\n", " "),
        _text("#time,heading,rudder\n", ","),
        _text("% time;heading;rudder\n", ";"),
        _text("time,heading,rudder\n", ",", trail=","),
        _text("time;heading;rudder;\n", ";", trail=";"),
        _text("time,heading,rudder\r\r\n", ",", "\r\r\n"),
        _text("time,heading,rudder\r", ",", "\r"),
        _text("Logger 12\rtime,heading,rudder\r\n", ",", "\r\n"),
    ],
    ids=[
        "settings", "many settings", "comment", "comment with commas", "percent", "empty last cell",
        "empty last cell with a name", "two returns", "returns", "a return in the header",
    ],
)  # fmt: skip
def test_the_table_is_what_most_lines_share(text: str, tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(text.encode())
    topic = survey_log(path).topics[0]
    assert topic.time is not None and topic.time.source == "time"
    assert (topic.rows, [column.name for column in topic.columns][:2]) == (len(ROWS), ["heading", "rudder"])


def test_names_of_groups_stand_before_those_of_their_columns(tmp_path: Path) -> None:
    rows = "".join(f"{a},{c},{c},{b}\n" for a, b, c in ROWS)
    path = tmp_path / "run.csv"
    path.write_text(f"Ship:,Anna,,\nTime,Rudder,,Heading\n,port,starboard,\ns,deg,deg,deg\n{rows}")
    assert survey_log(path).log.tables[0].names == ("Time", "Rudder port", "Rudder starboard", "Heading")
    path.write_text(f"Ship:,Anna,,\ntime,port,starboard,heading\n{rows}")
    assert survey_log(path).log.tables[0].names == ("time", "port", "starboard", "heading")


def test_a_table_without_names_is_read_by_numbers(tmp_path: Path) -> None:
    path = tmp_path / "run.dat"
    path.write_text(_text("two lines of prose\nabove a table\n", "\t"))
    survey = survey_log(path, {"1": "time", "2": "psi"})
    assert survey.topics[0].rows == len(ROWS)
    assert [column.name for column in survey.topics[0].columns] == ["2", "3"]
    assert survey.log.tables[0].column_index(ColumnSpec("psi", "2", "deg")) == 1


def _seconds(*cells: str) -> np.ndarray:
    table = RawTable("log.csv", ("clock",), (list(cells),))
    return stamps(table, ColumnSpec("time", "clock", "utc")).seconds


NOON = 1758459300.0  # s since 1970 of 2025-09-21 12:55:00


@pytest.mark.parametrize(
    "cells",
    [
        ("09/21/2025 12:55:00 PM", "09/21/2025 01:00:00 PM"),
        ("2025-09-21 12:55:00 pm", "2025-09-21 1:00:00 pm"),
        ("09/21/2025 12:55:00", "09/21/2025 13:00:00"),
        ("21/09/2025 12:55:00", "21/09/2025 13:00:00"),
        ("21-9-2025 12:55:00.0", "21-9-2025 13:00:00.0"),
        ("21.9.2025 12:55:00", "21.9.2025 13:00:00"),
    ],
)
def test_dates_are_read_where_they_are_of_one_day(cells: tuple[str, str]) -> None:
    np.testing.assert_array_equal(_seconds(*cells), [NOON, NOON + 300.0])


def test_a_date_of_two_days_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"'03/04/2025' may be either of two days; write it as 2025-04-03 or 2025-03-04"
    ):
        _seconds("03/04/2025 12:55:00", "03/04/2025 12:55:01")


def test_a_date_that_is_not_advanced_counts_on() -> None:
    dated = _seconds("2025-06-10 23:59:59.0", "2025-06-10 23:59:59.5", "2025-06-10 00:00:00.0", "2025-06-10 00:00:00.5")
    np.testing.assert_allclose(np.diff(dated), 0.5)
    caught_up = _seconds("2025-06-10 23:59:59", "2025-06-10 00:00:00", "2025-06-10 00:00:01", "2025-06-11 00:00:02")
    np.testing.assert_allclose(np.diff(caught_up), 1.0)
    turned_back = _seconds("2025-06-10 23:59:59", "2025-06-10 12:00:00", "2025-06-10 12:00:01")
    assert np.diff(turned_back)[0] < 0.0


def test_a_clock_that_stands_still_is_named(tmp_path: Path) -> None:
    from seatrial.data.read import Layout, read_record

    path = tmp_path / "run.csv"
    path.write_text("time,psi\n12.5,1\n12.5,2\n12.5,3\n")
    layout = Layout("text", ColumnSpec("time", "time", "s"), (ColumnSpec("psi", "psi", "deg"),), 1)
    with pytest.raises(InputError, match=r"the clock stands still: all 3 stamps are 12.5 s"):
        read_record(path, layout)


def test_a_table_with_a_reading_in_each_row_has_a_topic_for_each_quantity(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    names = ("navigation.headingTrue", "steering.rudderAngle", "navigation.state")
    cells = [(time, name, cell) for time, *values in ROWS for name, cell in zip(names, (*values, "ok"), strict=True)]
    path.write_text("timestamp,path,value\n" + "".join(f"{time},{name},{cell}\n" for time, name, cell in cells))
    survey = survey_log(path)
    assert survey.log.topics == names
    assert [topic.rows for topic in survey.topics] == [len(ROWS)] * 3
    assert survey.topics[0].columns[0].name == "headingTrue"
    path.write_text("time,name,value\n" + "".join(f"{time},row {time},{value}\n" for time, value, _ in ROWS))
    assert survey_log(path).log.topics == ("",)


def test_empty_columns_of_a_sheet_take_no_memory(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (("Time", None, "Rudder", None), (None, None, "port", "starboard"), ("s", None, "deg", "deg")):
        book.active.append(row)
    for time, _, rudder in ROWS:
        book.active.append((float(time), None, float(rudder), float(rudder)))
    book.active.cell(row=50, column=16384, value="x")  # the last column that a sheet has
    book.save(tmp_path / "run.xlsx")
    table = survey_log(tmp_path / "run.xlsx").log.tables[0]
    assert table.names[:5] == ("Time", "", "Rudder port", "Rudder starboard", "")
    assert sum(isinstance(cells, list) for cells in table.cells) == 4


def test_a_cell_beyond_all_size_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text(f"time,u\n0,{'9' * 140_000}\n1,2\n2,3\n")
    with pytest.raises(InputError, match=r"run.csv: a cell of the line '0,9+\.\.\.' has over 131,072 characters"):
        survey_log(path)
