"""Bad files: one clear sentence each, naming file, row and column."""

import sys
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, format_of, read_record

TIME = ColumnSpec("time", "t", "s")
LAYOUT = Layout("text", TIME, (ColumnSpec("u", "speed", "m/s"),))
NUMBERED = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 2, "m/s"),))


def message(tmp_path: Path, content: str | bytes, layout: Layout = LAYOUT, name: str = "run.csv") -> str:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError) as caught:
        read_record(path, layout)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.csv does not exist"):
        read_record(tmp_path / "none.csv", LAYOUT)


@pytest.mark.parametrize("content", ["", "  \n \n"])
def test_empty_file(tmp_path: Path, content: str) -> None:
    assert "run.csv is empty" in message(tmp_path, content)


def test_header_without_data(tmp_path: Path) -> None:
    assert "run.csv has no data lines" in message(tmp_path, "t,speed\n")


def test_binary_rubbish(tmp_path: Path) -> None:
    assert "not a text file" in message(tmp_path, bytes(range(256)) * 10)


@pytest.mark.parametrize(("format", "name"), [("mat", "run.mat"), ("parquet", "run.parquet"), ("netcdf", "run.nc")])
def test_binary_rubbish_in_other_formats(tmp_path: Path, format: str, name: str) -> None:
    pytest.importorskip({"parquet": "pyarrow", "netcdf": "xarray"}.get(format, "scipy"))
    layout = Layout(format, TIME, LAYOUT.columns)  # type: ignore[arg-type]
    assert f"{name} is not a readable" in message(tmp_path, bytes(range(1, 256)) * 10, layout, name)


def test_not_really_packed(tmp_path: Path) -> None:
    assert "not a gzip file" in message(tmp_path, "t,speed\n0,1\n1,1\n", name="run.csv.gz")


@pytest.mark.skipif(sys.platform == "win32", reason="holes are not counted there")
@pytest.mark.parametrize(
    "name", ["run.csv", "run.csv.gz", "run.mat", "run.bin", "run.tlog", "run.bag", "run.n2k", "run.ulg"]
)
def test_a_large_file_of_holes_is_refused_before_it_is_read(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with path.open("wb") as file:
        file.write(b"ULog" + bytes(100))
        file.truncate(5 * 10**9)
    if path.stat().st_blocks * 512 > 2**20:
        pytest.skip("this file system has no holes")
    with pytest.raises(InputError, match=rf"^{name} is damaged: of its 5,000 MB only 0\.0 MB were ever written"):
        read_record(path, Layout(format_of(path), TIME, LAYOUT.columns))


def test_wrong_encoding(tmp_path: Path) -> None:
    text = message(tmp_path, "t,speed\n0,1\n1,1\n°,2\n".encode("cp1252"))
    assert "not utf-8 text (byte 0xb0 in line 4)" in text and "cp1252" in text


@pytest.mark.parametrize("encoding", ["latin-99", "undefined", "hex", "a\0b"])
def test_unknown_encoding(tmp_path: Path, encoding: str) -> None:
    layout = Layout("text", TIME, LAYOUT.columns, encoding=encoding)
    assert f"unknown encoding {encoding!r}" in message(tmp_path, "t,speed\n0,\u00e5..1\n", layout)


def test_wrong_column_names_the_nearest(tmp_path: Path) -> None:
    assert "no column 'speed' for channel 'u'; did you mean 'speeds'?" in message(tmp_path, "t,speeds\n0,1\n1,1\n")


def test_wrong_column_number(tmp_path: Path) -> None:
    layout = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 7, "m/s"),))
    assert "wants column 7, but the file has 2 columns" in message(tmp_path, "0,1\n1,1\n", layout)


def test_unknown_unit(tmp_path: Path) -> None:
    layout = Layout("text", TIME, (ColumnSpec("u", "speed", "knots"),))
    assert "channel 'u': unknown unit 'knots'" in message(tmp_path, "t,speed\n0,1\n1,1\n", layout)


def test_unit_of_another_quantity(tmp_path: Path) -> None:
    layout = Layout("text", TIME, (ColumnSpec("u", "speed", "deg"),))
    assert "'u' is measured in m/s; unit 'deg' does not fit" in message(tmp_path, "t,speed\n0,1\n1,1\n", layout)


def test_unknown_channel(tmp_path: Path) -> None:
    layout = Layout("text", TIME, (ColumnSpec("delt", "speed", "rad"),))
    assert "unknown channel 'delt'; did you mean 'delta'?" in message(tmp_path, "t,speed\n0,1\n1,1\n", layout)


def test_time_that_runs_backwards(tmp_path: Path) -> None:
    text = message(tmp_path, "t,speed\n0,1\n0.2,1\n0.1,1\n")
    assert "row 4: time runs backwards from 0.2 s to 0.1 s" in text


def test_channel_without_numbers(tmp_path: Path) -> None:
    assert "column 'speed' (channel 'u') holds no number at all" in message(tmp_path, "t,speed\n0,\n1,\n")


@pytest.mark.parametrize("content", ["t,speed\n0,1\n", "t,speed\n0,1\n,2\n"])
def test_one_sample(tmp_path: Path, content: str) -> None:
    assert "one sample" in message(tmp_path, content)


def test_cell_that_is_not_a_number(tmp_path: Path) -> None:
    text = message(tmp_path, "t,speed\n0,1\n1,fast\n2,1\n")
    assert "row 3, column 'speed': 'fast' is not a number" in text
    assert "row 2, column 2: 'x1' is not a number" in message(tmp_path, "0 1\n1 x1\n", NUMBERED)


def test_infinite_cell(tmp_path: Path) -> None:
    assert "row 3, column 'speed': the number is infinite" in message(tmp_path, "t,speed\n0,1\n1,inf\n")


def test_row_with_too_many_cells(tmp_path: Path) -> None:
    assert "row 3 has 3 cells instead of 2" in message(tmp_path, "t,speed\n0,1\n1,1,1\n")


def test_channel_given_twice() -> None:
    with pytest.raises(InputError, match="channel 'u' is given twice"):
        Layout("text", TIME, (ColumnSpec("u", 2, "m/s"), ColumnSpec("u", 3, "m/s")))


def test_frame_that_does_not_exist(tmp_path: Path) -> None:
    layout = Layout("text", TIME, (ColumnSpec("u", "speed", "m/s", frame="ship"),))
    assert "frame must be body, earth, none or enu, not 'ship'" in message(tmp_path, "t,speed\n0,1\n1,1\n", layout)


def test_format_by_suffix() -> None:
    assert [format_of(Path(f"a.{s}")) for s in ("csv.gz", "MAT", "parquet", "nc")] == [
        "text",
        "mat",
        "parquet",
        "netcdf",
    ]
    with pytest.raises(InputError, match=r"suffix '\.doc' stands for no format"):
        format_of(Path("a.doc"))
