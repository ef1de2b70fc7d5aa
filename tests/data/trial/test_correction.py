"""A spoilt trial file is corrected by the checks' own edits, and by nothing that leaves as many errors."""

from pathlib import Path

import numpy as np
import pytest
from tests.data.check.ship import in_earth_axes, zigzag

from seatrial.core.values import Record, Severity
from seatrial.data.trial import corrected_trial
from seatrial.data.trial.load import change_lines

UNITS = {"x0": "m", "y0": "m", "psi": "rad", "u": "m/s", "v": "m/s", "r": "rad/s", "delta": "rad"}


def write_trial(folder: Path, record: Record, **declared: str) -> Path:
    """The record as CSV and a trial file that declares it, keys of channels in `declared` appended."""
    columns = np.column_stack([record.time, *(record[symbol] for symbol in UNITS)])
    np.savetxt(folder / "run.csv", columns, delimiter=",", header="t," + ",".join(UNITS), comments="", fmt="%.9g")
    lines = ["# of a day in May", "[[records]]", 'files = "run.csv"', 'time = { column = "t" }']
    for symbol, unit in UNITS.items():
        lines.append(
            f'channels.{symbol} = {{ column = "{symbol}", unit = "{unit}"{declared.get(symbol, "")} }}  # {symbol}'
        )
    path = folder / "trial.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def errors(path: Path) -> list[str]:
    return [f.code for f in corrected_trial(path).findings if f.severity is Severity.ERROR]


def with_swapped_positions(record: Record) -> Record:
    channels = {"x0": record.channel("y0"), "y0": record.channel("x0")}
    return Record(record.name, record.time, {**record.channels, **channels})


@pytest.mark.long(every=2)
@pytest.mark.parametrize(
    ("record", "declared", "expected"),
    [
        (zigzag(noise=1.0), {"delta": ', positive = "port"'}, 'positive = "starboard"'),
        (zigzag(noise=1.0), {"r": ', positive = "port"'}, 'positive = "starboard"'),
        (in_earth_axes(zigzag(noise=1.0)), {}, 'frame = "earth"'),
        (with_swapped_positions(zigzag(noise=1.0)), {}, 'channels.x0 = { column = "y0"'),
        (zigzag(noise=1.0), {"psi": ", offset = 0.5"}, "offset = "),
        (zigzag(noise=1.0), {"psi": ', positive = "port"'}, 'positive = "starboard"'),
    ],
)
def test_a_wrong_declaration_is_corrected(
    record: Record, declared: dict[str, str], expected: str, tmp_path: Path
) -> None:
    path = write_trial(tmp_path, record, **declared)
    correction = corrected_trial(path)
    assert expected in correction.text and "# of a day in May" in correction.text and "# psi" in correction.text
    assert [f.code for f in correction.findings if f.severity is Severity.ERROR] == []
    assert len(correction.applied) >= 1 and all(line.startswith("changed") for line in change_lines(correction))
    (tmp_path / "fixed.toml").write_text(correction.text, encoding="utf-8")
    assert corrected_trial(tmp_path / "fixed.toml").changes == ()


def test_a_right_file_is_left_as_it_is(tmp_path: Path) -> None:
    path = write_trial(tmp_path, zigzag(noise=1.0))
    correction = corrected_trial(path)
    assert correction.text == path.read_text(encoding="utf-8") and correction.changes == ()


def test_degrees_called_radians_are_corrected(tmp_path: Path) -> None:
    record = zigzag(noise=1.0)
    degrees = record.with_channel("r", record.channel("r").with_values(np.degrees(record["r"])))
    correction = corrected_trial(write_trial(tmp_path, degrees))
    assert 'channels.r = { column = "r", unit = "deg/s" }' in correction.text


def test_a_change_that_is_refused_says_why(tmp_path: Path) -> None:
    """x0 of the file follows from lat and lon: there is no channel to exchange."""
    record = with_swapped_positions(zigzag(noise=1.0))
    path = write_trial(tmp_path, record)
    text = path.read_text(encoding="utf-8")
    text = text.replace(
        'channels.x0 = { column = "x0", unit = "m" }',
        'channels.lat = { column = "x0", unit = "deg", scale = 8.993e-6 }',
    )
    text = text.replace(
        'channels.y0 = { column = "y0", unit = "m" }',
        'channels.lon = { column = "y0", unit = "deg", scale = 8.993e-6 }',
    )
    path.write_text(text, encoding="utf-8")
    correction = corrected_trial(path)
    assert correction.applied == () and correction.text == text
    assert any("'x0' is no column of the file" in line for line in change_lines(correction))
