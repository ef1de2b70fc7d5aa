"""Text as programs and people leave it: read rightly, or refused in one sentence of at most 400 characters."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tests.data.read.samples import SAMPLES

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, format_of, read_record
from seatrial.data.read.record_file import file_digest, require_file

TIME, SPEED = ColumnSpec("time", "t", "s"), ColumnSpec("u", "speed", "m/s")
LAYOUT = Layout("text", TIME, (SPEED,))
ROWS = "t,speed\n0,1.5\n1,-2.5\n2,3.5\n"
SENTENCE_LENGTH = 400


def read(path: Path, content: bytes, layout: Layout = LAYOUT) -> np.ndarray:
    path.write_bytes(content)
    return read_record(path, layout)["u"]


@pytest.mark.parametrize(
    "content",
    [
        ROWS.encode("utf-8-sig"),
        ROWS.encode("utf-16"),
        ROWS.encode("utf-32"),
        ROWS.replace("\n", "\r\n").encode(),
        ROWS.replace("-", "\u2212").encode(),
        ROWS.replace(",", " , ").encode(),
        ROWS.replace("\n", "\n\n").rstrip("\n").replace("\n\n", "\n").encode() + b"\n\n\n",
        b't,"speed"\n0,"1.5"\n1,"-2.5"\n2,"3.5"\n',
        ROWS.replace("\n", "\r").encode(),
        ROWS.replace("speed\n", "speed," + "x" * 70_000 + "\n").encode(),
        ROWS.replace("3.5", "3.5" + "0" * 70_000).encode(),
    ],
    ids=[
        "BOM",
        "UTF-16",
        "UTF-32",
        "CRLF",
        "minus sign",
        "spaces",
        "empty end",
        "quoted",
        "CR",
        "long header",
        "long cell",
    ],
)
def test_what_is_clear_is_read(content: bytes, tmp_path: Path) -> None:
    np.testing.assert_array_equal(read(tmp_path / "run.csv", content), [1.5, -2.5, 3.5])


def test_decimal_commas(tmp_path: Path) -> None:
    for content in (b"t;speed\n0;1\n1;-2,5\n", b"t speed\n0,0 1\n1,0 -2,5\n"):
        np.testing.assert_array_equal(read(tmp_path / "run.csv", content), [1.0, -2.5])


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b't,speed\n0,"1.5\n1,2\n2,3\n3,4\n', "row 2 has a quote that is opened and not closed"),
        (b"t,speed,speed\n0,1,2\n1,1,2\n", "the header has 'speed' 2 times; .*column = 2 or 3"),
        (b't,speed\n0,"1,234.5"\n1,"2,000.0"\n', "'1,234.5' has a thousands separator"),
        (b"t,speed\n0,1_0\n1,2\n", "row 2, column 'speed': '1_0' is not a number"),
        (b"t,speed\n0,0x10\n1,2\n", "'0x10' is not a number"),
        (b"t,speed\n0,1,5\n1,2,5\n2,3,5,9\n", "row 4 has 4 cells instead of 3"),
        (b"t,speed\n0,1\n1,1e400\n", "row 3, column 'speed': the number is infinite"),
        (b"t,speed\n0,1\n86400,1\n3,1\n2,1\n", "time runs backwards from 86400 s to 3 s, and 1 times more"),
        (b"t,speed\n0,nan\n1,nan\n", "holds no number at all"),
        (b"\xff\xfe\x00", "run.csv"),
        (b"t,speed\n" + b"x" * 5000 + b",1\n1,2\n", "is not a number"),
    ],
)
def test_what_is_not_is_refused_in_one_sentence(content: bytes, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence) as caught:
        read(tmp_path / "run.csv", content)
    assert "\n" not in str(caught.value) and len(str(caught.value)) <= SENTENCE_LENGTH


def test_a_gz_without_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv.gz"
    path.write_bytes(gzip.compress(bytes(80 * 2**20)))
    with pytest.raises(InputError, match="unpacks to more than 67 MB"):
        read_record(path, LAYOUT)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes as files")
def test_devices_pipes_and_folders_are_refused_without_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, sentence in (
        (Path("/dev/zero"), "is a device or a pipe"),
        (tmp_path / "pipe", "is a device or a pipe"),
        (tmp_path, "is a folder"),
        (tmp_path / "none.csv", "does not exist"),
    ):
        with pytest.raises(InputError, match=sentence):
            require_file(path)
        with pytest.raises(InputError, match=sentence):
            read_record(path, LAYOUT)


@pytest.mark.parametrize("file", ["run.bin", "run.ulg", "run.tdms", "run.mf4", "run.parquet", "run.nmea", "run.n2k"])
def test_a_format_is_known_by_its_first_bytes(file: str, tmp_path: Path) -> None:
    SAMPLES[file].write(tmp_path / file)
    for name in ("log.txt", "log"):
        (tmp_path / name).write_bytes((tmp_path / file).read_bytes())
        assert format_of(tmp_path / name) == SAMPLES[file].format
    assert len(file_digest(tmp_path / file)) == 64


def test_a_file_of_holes_is_refused_at_its_first_zero_byte(tmp_path: Path) -> None:
    path = tmp_path / "holes.csv"
    with path.open("wb") as file:
        file.write(b"t,speed\n0,1\n")
        file.truncate(32 * 2**20)
    with pytest.raises(InputError, match=r"holes\.csv is not a text file"):
        read_record(path, LAYOUT)
