"""The package's own record file: what goes in comes out, bit for bit."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from seatrial.core.values import Channel, InputError, Provenance, Record, RecordKind
from seatrial.data.read import ColumnSpec, Layout, read_record, read_record_csv, write_record_csv

# beyond 1e15 SI a reading is refused
NUMBER = st.floats(-1e14, 1e14) | st.just(float("nan"))


@st.composite
def records(draw: st.DrawFn) -> Record:
    count = draw(st.integers(1, 8))
    values = arrays(np.float64, count, elements=NUMBER)
    channels = {
        symbol: Channel(
            draw(values),
            unit,
            draw(st.sampled_from(["body", "earth"])),
            draw(st.sampled_from(["port", "starboard"])),
            draw(st.floats(-5, 5)),
            draw(st.text(max_size=5)),
        )
        for symbol, unit in draw(st.permutations([("u", "m/s"), ("delta", "rad"), ("torque", "N m")]))
    }
    time = np.cumsum(draw(arrays(np.float64, count, elements=st.floats(1e-3, 10.0))))
    provenance = Provenance("a.csv", "00ff", ("read", "one, two"))
    return Record("run, ä", time, channels, draw(st.sampled_from(RecordKind)), provenance)


@given(records())
def test_record_to_file_to_record(record: Record) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        write_record_csv(record, path)
        back = read_record_csv(path)
        assert [file.name for file in Path(folder).iterdir()] == ["run.csv"]
    assert (back.name, back.kind, back.provenance) == (record.name, record.kind, record.provenance)
    np.testing.assert_array_equal(back.time, record.time)
    assert list(back.channels) == list(record.channels)
    for symbol, channel in record.channels.items():
        np.testing.assert_array_equal(back[symbol], channel.values)
        for key in ("unit", "frame", "positive", "reference_point", "label"):
            assert getattr(back.channel(symbol), key) == getattr(channel, key)


def example() -> Record:
    return Record.from_arrays(
        "run", np.array([0.0, 0.1]), {"u": np.array([1.0, np.nan]), "delta": np.array([0.1, 0.2])}
    )


def test_header_says_the_units(tmp_path: Path) -> None:
    write_record_csv(example(), tmp_path / "run.csv")
    lines = (tmp_path / "run.csv").read_text().splitlines()
    assert lines[1:] == ["time [s],u [m/s],delta [rad]", "0.0,1.0,0.1", "0.1,,0.2"]


def test_a_plain_table_without_the_comment_line(tmp_path: Path) -> None:
    path = tmp_path / "plain.csv"
    path.write_text("time [s],u [kn],delta [deg]\n0,10,5\n1,10,6\n")
    record = read_record_csv(path)
    assert record.name == "plain" and record.channel("u").unit == "m/s"
    np.testing.assert_allclose(record["u"], 10 * 1852 / 3600)


def test_the_general_reader_takes_it_too(tmp_path: Path) -> None:
    write_record_csv(example(), tmp_path / "run.csv")
    layout = Layout("text", ColumnSpec("time", "time [s]", "s"), (ColumnSpec("delta", "delta [rad]", "rad"),))
    np.testing.assert_array_equal(read_record(tmp_path / "run.csv", layout)["delta"], example()["delta"])


def test_refusals(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot be written"):
        write_record_csv(example(), tmp_path / "file" / "run.csv")
    with pytest.raises(InputError, match="does not exist"):
        read_record_csv(tmp_path / "none.csv")
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match=r"column 'a' should read 'symbol \[unit\]'"):
        read_record_csv(tmp_path / "other.csv")


@pytest.mark.parametrize("metadata", ["{nonsense", "[]", '{"channels": {}}', "[" * 5000, '{"channels": {"u": 1}}'])
def test_a_damaged_first_line_is_refused(tmp_path: Path, metadata: str) -> None:
    (tmp_path / "other.csv").write_text(f"# seatrial record {metadata}\ntime [s],u [m/s]\n1,2\n")
    with pytest.raises(InputError, match="first line is damaged"):
        read_record_csv(tmp_path / "other.csv")


@pytest.mark.parametrize(
    "text", ["", "time [s]\n", '# seatrial record {"name": "x"}\n', "# seatrial record {}\ntime [s]\n"]
)
def test_a_file_without_samples_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "other.csv").write_text(text)
    with pytest.raises(InputError, match=r"holds no samples|is empty"):
        read_record_csv(tmp_path / "other.csv")
