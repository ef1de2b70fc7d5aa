"""Text files as programs and people leave them: surveyed and drafted, or the cell that is wrong is named."""

from pathlib import Path

import openpyxl
import pytest

from seatrial.api import check, draft_trial, survey_log
from seatrial.core.values import Severity

ROWS = [f"{0.5 * k:.1f},{30.0 + k:.1f},{(-1) ** k * 10.0:.1f}" for k in range(60)]
HEADER = "time,heading,rudder"


def write(path: Path, rows: list[str], header: str = HEADER) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("separator", [";", "\t", "  "])
def test_decimal_commas_with_any_separator(separator: str, tmp_path: Path) -> None:
    rows = [row.replace(",", separator).replace(".", ",") for row in ROWS]
    survey = survey_log(write(tmp_path / "run.csv", rows, HEADER.replace(",", separator)))
    (topic,) = survey.topics
    assert [(one.name, one.low, one.high) for one in topic.columns] == [("heading", 30, 89), ("rudder", -10, 10)]


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
def test_utf_16_that_lost_its_mark(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes("\n".join([HEADER, *ROWS]).encode(encoding))
    assert survey_log(path).layout.encoding == encoding
    assert f'encoding = "{encoding}"' in draft_trial(path).text


@pytest.mark.parametrize("below", ["", "\n", "s,deg,deg\n", "[s],[deg],[deg]\n\n"])
def test_units_and_empty_lines_below_the_names(below: str, tmp_path: Path) -> None:
    path = write(tmp_path / "run.csv", ROWS, f"{HEADER}\n{below}".rstrip("\n") + "\n" * below.endswith("\n\n"))
    (topic,) = survey_log(path).topics
    assert [one.name for one in topic.columns] == ["heading", "rudder"]
    assert [one.unit for one in topic.columns] == (["deg", "deg"] if "deg" in below else ["", ""])
    assert 'channels.psi = { column = "heading", unit = "deg" }' in draft_trial(path).text


def test_a_folder_with_brackets(tmp_path: Path) -> None:
    path = write(tmp_path / "[2024] trials (a)" / "run[1].csv", ROWS)
    assert [one.path for one in draft_trial(path.parent).surveys] == [path]


def test_of_two_columns_with_one_name_neither_is_chosen_silently(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", ROWS, "time,heading,heading"))
    (guess,) = draft.open_questions
    assert (guess.symbol, guess.source) == ("psi", 2) and "another column that is called 'heading'" in draft.text


def test_a_cell_that_is_no_number_is_named(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", [*ROWS[:40], "20.0,1_0,5.0", *ROWS[41:]]))
    assert "# left out: column 'heading': row 42 holds '1_0', no number" in draft.text


def test_a_clock_that_runs_backwards_is_named(tmp_path: Path) -> None:
    path = write(tmp_path / "run.csv", [*ROWS, *ROWS[50:]])
    assert "no column is recognised as the time ('time' runs backwards from 29.5 to 25 in row 62)" in (
        draft_trial(path).text
    )


def test_a_table_exported_from_an_autopilot_keeps_the_names_of_its_messages(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},{k % 360},{0.01 * k:.2f},{1400 + k}" for k in range(60)]
    draft = draft_trial(write(tmp_path / "boat.csv", rows, "timestamp,ATT.Yaw,/XKF1[0]/VN,RCOU.C1"))
    (part,) = draft.guesses
    assert [(g.symbol, g.unit, g.frame) for g in part if g.is_used] == [
        ("psi", "deg", ""), ("u", "m/s", "earth"), ("command_1", "us", ""),
    ]  # fmt: skip
    assert "by ArduPilot ATT" in draft.text


def test_a_name_with_a_stroke_is_found_in_its_sheet(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for title, name in (("Navigation", "ROT [°/min]"), ("Engine", "Shaft speed [1/min]")):
        sheet = book.create_sheet(title)
        sheet.append(["Time", name])
        for k in range(60):
            sheet.append([0.5 * k, 30.0 + k % 7])
    book.save(tmp_path / "two sheets.xlsx")
    draft = draft_trial(tmp_path / "two sheets.xlsx", folder=tmp_path)
    (record,) = draft.records
    assert record is not None and {"r", "n"} == set(record.channels)
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    assert not [one for one in check(tmp_path / "trial.toml") if one.severity is Severity.ERROR]
