"""Text files in every dialect the field uses, read to the last digit."""

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError, si_unit
from seatrial.data.read import ColumnSpec, Layout, read_log, read_record
from seatrial.data.read.formats import text

TIME = ColumnSpec("time", "t", "s")
NAMED = Layout("text", TIME, (ColumnSpec("u", "speed", "kn"), ColumnSpec("psi", "head", "deg")))
NUMBERED = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 2, "kn"), ColumnSpec("psi", 3, "deg")))
ROWS = [(0.0, 10.5, 90.0), (0.5, 10.25, 91.5), (1.0, 10.0, -180.0)]


def expect(record) -> None:
    np.testing.assert_array_equal(record.time, [0.0, 0.5, 1.0])
    np.testing.assert_allclose(record["u"], np.array([10.5, 10.25, 10.0]) * 1852 / 3600, rtol=1e-15)
    np.testing.assert_allclose(record["psi"], np.radians([90.0, 91.5, -180.0]), rtol=1e-15)


@pytest.mark.parametrize("mark", [",", ";", "\t", " ", "   "])
def test_separators_are_recognised(tmp_path: Path, mark: str) -> None:
    lines = [mark.join(["t", "speed", "head"])] + [mark.join(map(repr, row)) for row in ROWS]
    path = tmp_path / "run.txt"
    path.write_text("\n".join(lines) + "\n")
    record = read_record(path, NAMED)
    expect(record)
    assert record.name == "run"
    assert record.channel("u").label == "speed"
    assert record.provenance.source == "run.txt" and len(record.provenance.sha256) == 64


@pytest.mark.parametrize(("lines", "below"), [(1, "\n\n"), (2, "s,kn,deg\n"), (2, "s,kn,deg\n\n"), (3, "s,kn,deg\n\n")])
def test_units_and_empty_lines_below_the_names(tmp_path: Path, lines: int, below: str) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,speed,head\n" + below + "\n".join(",".join(map(repr, row)) for row in ROWS))
    expect(read_record(path, Layout("text", TIME, NAMED.columns, header_lines=lines)))


@pytest.mark.parametrize("mark", [";", "\t", " "])
def test_decimal_comma(tmp_path: Path, mark: str) -> None:
    text = "\n".join(mark.join(repr(x).replace(".", ",") for x in row) for row in ROWS)
    path = tmp_path / "run.dat"
    path.write_text(text)
    expect(read_record(path, Layout("text", NUMBERED.time, NUMBERED.columns)))


def test_packed_with_a_header_in_a_windows_encoding(tmp_path: Path) -> None:
    path = tmp_path / "run.dat.gz"
    body = "".join("  {:f}   {:f}  {:f}\n".format(*row) for row in ROWS)
    path.write_bytes(gzip.compress(f"Größe\nNeigung °\n{body}".encode("cp1252")))
    layout = Layout("text", NUMBERED.time, NUMBERED.columns, header_lines=2, encoding="cp1252")
    record = read_record(path, layout)
    expect(record)
    assert record.name == "run" and record.channel("u").label == "column 2"


def test_empty_cells_and_rows_stay_as_nan(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,speed,head\n0,1,2\n0.1,,3\n0.2,1,nan\n,,\n,,\n")
    record = read_record(path, NAMED)
    assert len(record) == 5
    assert np.isnan(record["u"]).tolist() == [False, True, False, True, True]
    assert np.isnan(record["psi"]).tolist() == [False, False, True, True, True]
    assert np.isnan(record.time).tolist() == [False, False, False, True, True]


def test_columns_that_are_not_wanted_may_hold_anything(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,remark,speed,head\n0,start,1,2\n0.1,go,1,3\n")
    assert len(read_record(path, NAMED)) == 2


def test_declared_conventions_are_kept_not_applied(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,a,b,c\n0,1,2,3\n1,1,2,3\n")
    columns = (
        ColumnSpec("u", "a", "m/s", frame="earth"),
        ColumnSpec("v", "b", "m/s", frame="earth", reference_point=1.5),
        ColumnSpec("delta", "c", "deg", positive="port"),
    )
    record = read_record(path, Layout("text", TIME, columns))
    assert (record.channel("u").frame, record.channel("u").positive) == ("earth", "north")
    assert (record.channel("v").positive, record.channel("v").reference_point) == ("east", 1.5)
    assert record.channel("delta").positive == "port" and record["delta"][0] > 0


def test_model_scale_becomes_full_scale(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,speed,head\n0,1,2\n1,1,3\n")
    record = read_record(path, Layout("text", TIME, (ColumnSpec("u", "speed", "m/s"),), scale=100.0))
    np.testing.assert_allclose(record.time, [0.0, 10.0])
    np.testing.assert_allclose(record["u"], 10.0)


@given(st.floats(-1e6, 1e6), st.sampled_from(["kn", "km/h", "mm", "deg", "deg/min", "rpm", "kN", "min"]))
def test_conversion_to_si_and_back(value: float, unit: str) -> None:
    factor, base = si_unit(unit)
    assert si_unit(base) == (1.0, base)
    assert value * factor / factor == pytest.approx(value, rel=1e-14, abs=1e-300)


def test_a_comma_beside_decimal_points_is_no_decimal_sign(tmp_path: Path) -> None:
    """Of thousands, most often: such a number is refused when it is used, not taken a thousand times too small."""
    (tmp_path / "log.csv").write_text("Time;Heading;Depth\n0;12.5;1,234\n1;12.7;1,235\n")
    layout = Layout("text", ColumnSpec("time", "Time", "s"), (ColumnSpec("psi", "Heading", "deg"),))
    heading, depth = read_log(tmp_path / "log.csv", layout).table_of(layout.time).cells[1:]
    assert list(heading) == [12.5, 12.7]
    assert list(depth) == ["1,234", "1,235"]


@pytest.mark.parametrize(
    "cells",
    ["0,-0.5", "7,1e3", "-0,1.0", "007,.5", "9007199254740993,1", "1e400,1", "1,", "1,2,3", "nan,1", "x,1", "1 ,2", ""],
)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_plain_numbers_are_read_as_pandas_reads_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cells: str, end: str
) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(end.join(["a,b", "3,0.25", cells, "-12,4.5", ""]).encode())
    layout = Layout("text", ColumnSpec("time", 1, "s"), (), 1)

    def columns() -> list[tuple[str, str]] | str:
        try:
            cells_read = text.read_text(path, layout).tables[0].cells
        except InputError as error:
            return str(error)
        return [(str(np.asarray(c).dtype), repr([str(cell) for cell in c])) for c in cells_read]

    by_numpy = columns()
    monkeypatch.setattr(text, "_SMALL_BYTES", -1)
    assert columns() == by_numpy
