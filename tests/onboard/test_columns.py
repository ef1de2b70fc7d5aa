"""A line read as it comes is what the same line is in a file at rest; whatever else comes is counted."""

import tracemalloc
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, read_record
from seatrial.data.trial import load_trial
from seatrial.onboard.columns import ColumnReader
from seatrial.onboard.lines import LineBatch, TailLines

NAMED = Layout(
    "text", ColumnSpec("time", "t", "ms"), (ColumnSpec("u", "speed", "kn"), ColumnSpec("psi", "head", "deg"))
)
NUMBERED = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 2, "kn"), ColumnSpec("psi", 3, "deg")))
CELL = st.one_of(st.floats(-1e6, 1e6).map(repr), st.sampled_from(["", "NA", " ", "null"]))


def samples(text: str | bytes, layout: Layout, *, begins: bool = True) -> tuple[list[Sample], ColumnReader]:
    reader = ColumnReader(layout)
    data = text.encode() if isinstance(text, str) else text
    return reader.samples(LineBatch(data.split(b"\n"), begins)), reader


def table(found: list[Sample]) -> np.ndarray:
    return np.array([[s.time, *s.values] for s in found])


@given(
    st.lists(st.tuples(CELL, CELL), min_size=2, max_size=12),
    st.sampled_from([",", ";", "\t"]),
    st.sampled_from([".", ","]),
    st.booleans(),
)
def test_lines_are_read_as_a_file_is(rows: list, mark: str, decimal: str, named: bool) -> None:
    if mark == "," and decimal == ",":
        return
    cells = [(repr(0.1 * k), *row) for k, row in enumerate(rows)] + [("99", "1.5", "2.5")]
    body = [mark.join(cells).replace(".", decimal) for cells in cells]
    layout = Layout("text", (NAMED if named else NUMBERED).time, NUMBERED.columns)
    lines = ([mark.join(("t", "speed", "head"))] if named else []) + body
    path = Path("run.csv")
    found, reader = samples("\n".join(lines), layout)
    record = _at_rest(path, "\n".join(lines), layout)
    np.testing.assert_array_equal(table(found), np.column_stack([record.time, record["u"], record["psi"]]))
    assert reader.counts.garbled == 0


def _at_rest(path: Path, text: str, layout: Layout):
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / path).write_text(text)
        return read_record(Path(folder) / path, layout)


def test_real_records_followed_are_the_records(repository: Path, data_folder: Path) -> None:
    trial = load_trial(repository / "examples" / "kvlcc2_hsva.toml")
    assert trial.runs and data_folder.is_dir()
    for run in trial.runs:
        (file,) = run.files
        reader, lines = ColumnReader(file.layout), TailLines(file.path, once=True)
        found: list[Sample] = []
        while not lines.is_over:
            found += reader.samples(lines.read(0.0))
        record = run.raw_record()
        expected = np.column_stack([record.time, *(record[c.symbol] for c in file.layout.columns)])
        np.testing.assert_array_equal(table(found), expected)


@given(st.lists(st.binary(max_size=60), max_size=30), st.booleans(), st.sampled_from([NAMED, NUMBERED]))
def test_no_bytes_raise_and_every_line_is_accounted_for(lines: list[bytes], begins: bool, layout: Layout) -> None:
    lines = [line.replace(b"\n", b"") for line in lines]
    reader = ColumnReader(layout)
    found = reader.samples(LineBatch(lines, begins))
    header = 1 if begins and layout is NAMED and lines else 0
    blank = sum(not line.removeprefix(b"\xef\xbb\xbf").strip() for line in lines[header:])
    assert len(found) + reader.counts.garbled == len(lines) - header - blank
    assert all(np.isfinite(s.time) and not np.isinf(s.values).any() for s in found)


@given(st.lists(st.integers(0, 400), max_size=6))
def test_batches_do_not_matter(cuts: list[int]) -> None:
    lines = [b"t,speed,head", *(b"%d,%d.5,%d" % (k, k, -k) for k in range(400))]
    whole = ColumnReader(NAMED).samples(LineBatch(lines, True))
    reader, edges = ColumnReader(NAMED), [0, *sorted(cuts), len(lines)]
    parts = [s for k, (a, b) in enumerate(pairwise(edges)) for s in reader.samples(LineBatch(lines[a:b], k == 0))]
    np.testing.assert_array_equal(table(parts), table(whole))


def test_units_names_and_quotes() -> None:
    found, _ = samples('"t";"other";"head";"speed"\n500;0;"90";10\n', NAMED)
    np.testing.assert_allclose(table(found), [[0.5, 10 * 1852 / 3600, np.pi / 2]], rtol=1e-15)


def test_twins_are_their_mean_and_their_difference() -> None:
    """As a file with these columns is read: the other side counts for both where one is empty."""
    rudder = ColumnSpec("delta", "port", "deg", twin="starboard", positive="port")
    layout = Layout("text", ColumnSpec("time", "t", "s"), (rudder, rudder.difference), header_lines=1)
    found, _ = samples("t,port,starboard\n0,10,4\n1,,4\n2,,\n", layout)
    np.testing.assert_allclose(np.degrees(table(found)[:, 1:]), [[7.0, -6.0], [4.0, 0.0], [np.nan, np.nan]])


@pytest.mark.parametrize(
    ("line", "cells"),
    [
        ("1,,3", (np.nan, 3.0)),
        ("1,2", (2.0, np.nan)),
        ("1,inf,3", (np.nan, 3.0)),
        ("1,1e999,3", (np.nan, 3.0)),
        ("1,1_0,3", (np.nan, 3.0)),
        ("1,two,3", (np.nan, 3.0)),
    ],
)
def test_a_cell_without_a_finite_number_is_nan(line: str, cells: tuple[float, float]) -> None:
    plain = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 2, "m/s"), ColumnSpec("v", 3, "m/s")))
    found, reader = samples(f"0,0,0\n{line}", plain)
    np.testing.assert_array_equal(found[1].values, cells)
    assert reader.counts.garbled == 0


@pytest.mark.parametrize("line", ["2,3,42,3,4", "x,1,2", ",1,2", "nan,1,2", "inf,1,2", "\x00\x01", "1e308e,2"])
def test_a_line_that_cannot_be_read_is_counted_and_shown_in_ascii(line: str) -> None:
    found, reader = samples(f"0,1,2\n{line}\n3,1,2", NUMBERED)
    assert [s.time for s in found] == [0.0, 3.0]
    assert reader.counts.garbled == 1 and reader.counts.last_problem.isascii() and "line" in reader.counts.last_problem


def test_a_width_that_lasts_becomes_the_width() -> None:
    found, reader = samples("0,1\n" + "\n".join(f"{k},1,2" for k in range(1, 9)), NUMBERED)
    assert [s.time for s in found] == [0, 3, 4, 5, 6, 7, 8] and reader.counts.garbled == 2


def test_a_header_is_known_again_after_a_truncation_and_anywhere() -> None:
    reader = ColumnReader(NAMED)
    assert len(reader.samples(LineBatch([b"t,speed,head", b"0,1,2"], True))) == 1
    assert len(reader.samples(LineBatch([b"5,1,2"], True))) == 1
    assert len(reader.samples(LineBatch([b"t,speed,head", b"6,1,2"], True))) == 1
    swapped = reader.samples(LineBatch([b"head,t,speed", b"90,7000,1"]))
    np.testing.assert_allclose(table(swapped), [[7.0, 1852 / 3600, np.pi / 2]])
    assert reader.counts.garbled == 0


def test_a_column_that_is_not_there_is_said_and_stays_nan() -> None:
    found, reader = samples("t,sped,head\n0,1,2\n1,1,2", NAMED)
    assert all(np.isnan(s.values[0]) and np.isfinite(s.values[1]) for s in found) and len(found) == 2
    assert reader.column_warning == "no column 'speed' for channel 'u'; did you mean 'sped'?"
    assert reader.counts.last_problem == reader.column_warning


def test_names_without_any_header_are_said() -> None:
    found, reader = samples("0,1,2\n1,1,2", NAMED, begins=False)
    assert not found and reader.counts.garbled == 2 and "no header line has arrived" in reader.counts.last_problem


@pytest.mark.parametrize(
    ("layout", "text"),
    [
        (Layout("mat", NAMED.time, NAMED.columns), "format 'mat' cannot be followed"),
        (Layout("text", NAMED.time, ()), "no channels"),
        (Layout("text", NAMED.time, NAMED.columns, scale=45.7), "Froude-scaled by 45.7"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="utf-16"), "utf-16"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="klingon"), "unknown encoding"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="undefined"), "unknown encoding"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="punycode"), "unknown encoding"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="hex"), "unknown encoding"),
        (Layout("text", NAMED.time, NAMED.columns, encoding="idna"), "unknown encoding"),
        (Layout("text", NAMED.time, (ColumnSpec("u", 2, "deg"),)), "does not fit"),
    ],
)
def test_a_layout_that_cannot_be_followed_is_refused(layout: Layout, text: str) -> None:
    with pytest.raises(InputError, match=text):
        ColumnReader(layout)


def test_names_in_another_encoding() -> None:
    layout = Layout(
        "text", ColumnSpec("time", "t", "s"), (ColumnSpec("u", "Geschw. [m/s] ü", "m/s"),), encoding="cp1252"
    )
    found, _ = samples("Geschw. [m/s] ü;t\n1;2\n".encode("cp1252"), layout)
    np.testing.assert_array_equal(table(found), [[2.0, 1.0]])


def test_memory_does_not_grow_with_garbage() -> None:
    reader, lines = ColumnReader(NUMBERED), [b"\xff" * 200, b"1,2,3,4,5,6", b"x,y,z"] * 200
    reader.samples(LineBatch(lines))
    tracemalloc.start()
    try:
        for _ in range(10):
            reader.samples(LineBatch(lines))
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(30):
            reader.samples(LineBatch(lines))
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 2000
