"""Readers of others are checked as the built-in ones; each violation has its sentence."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.read import ColumnSpec, Layout, Log, RawTable, write_record_csv
from seatrial.data.read.formats.text import read_text
from seatrial.testing import ConformanceError, check_reader

LAYOUT = Layout("text", ColumnSpec("time", "time [s]", "s"), (ColumnSpec("u", "u [m/s]", "m/s"),))


@pytest.fixture
def sample(tmp_path: Path) -> Path:
    """A record file of 50 rows."""
    time = np.arange(50) * 0.1
    write_record_csv(Record.from_arrays("sample", time, {"u": 1.0 + np.sin(time)}), tmp_path / "sample.csv")
    return tmp_path / "sample.csv"


def test_the_text_reader_conforms(sample: Path) -> None:
    check_reader(read_text, sample, LAYOUT)


def careless(path: Path, _: Layout) -> Log:
    """A reader that lets exceptions of the format through."""
    names, *rows = [line.split(",") for line in path.read_text().splitlines() if not line.startswith("#")]
    cells = tuple(zip(*[map(float, row) for row in rows], strict=True))
    return Log.of_table(RawTable(path.name, tuple(names), cells))


def altered(path: Path, layout: Layout, **changes: object) -> Log:
    return Log.of_table(replace(read_text(path, layout).tables[0], **changes))


def forgetful(path: Path, layout: Layout) -> Log:
    return altered(path, layout, file="file")


def ragged(path: Path, layout: Layout) -> Log:
    cells = read_text(path, layout).tables[0].cells
    return altered(path, layout, cells=(cells[0], cells[1][:-1]))


def noisy(path: Path, layout: Layout) -> Log:
    cells = read_text(path, layout).tables[0].cells
    return altered(path, layout, cells=(cells[0], np.random.default_rng().normal(size=len(cells[1]))))


def repeated(path: Path, layout: Layout) -> Log:
    table = read_text(path, layout).tables[0]
    return Log(path.name, (table, table))


def timeless(path: Path, layout: Layout) -> Log:
    return altered(path, layout, time_name="clock")


def destructive(path: Path, layout: Layout) -> Log:
    log = read_text(path, layout)
    path.write_text(path.read_text() + "\n")
    return log


@pytest.mark.parametrize(
    ("reader", "sentence"),
    [
        (careless, "an empty file raises ValueError"),
        (forgetful, "names the file 'file'"),
        (ragged, "columns differ in length"),
        (noisy, "reading twice gives other numbers in channel 'u'"),
        (destructive, "changes the file that it reads"),
        (lambda *_: None, "returns a NoneType, not a Log"),
        (repeated, "the topic '' stands twice"),
        (timeless, "time column 'clock' is none of its columns"),
    ],
)
def test_violations_are_named(reader, sentence: str, sample: Path) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check_reader(reader, sample, LAYOUT)
