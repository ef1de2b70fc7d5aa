"""Channels that a trial file declares for itself: read, turned, held, and refused where they clash."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.check import canonical_record, examined_record
from seatrial.data.trial import load_runs
from seatrial.data.trial.runs import NO_DECLARED, declared_channels
from seatrial.data.trial.schema import DeclaredChannel

DECLARED = """
[channels.flap]
meaning = "angle of the stern flap"
unit = "deg"
positive = "down"

[channels.valve]
meaning = "opening of the steering valve"
unit = "1"
kind = "command"
"""
RECORDS = """
[[records]]
files = "run.csv"
time = { column = "t" }
channels.u = { column = "u", unit = "m/s" }
channels.flap = { column = "f", unit = "deg", positive = "up", zero = 2.0, span = 0.5, scale = 3.0, offset = 1.0 }
channels.valve = { column = "w", unit = "us", zero = 1500, span = 400 }
"""


def record(folder: Path, declared: str = DECLARED, records: str = RECORDS) -> Record:
    rows = [f"{0.5 * k},{1.0 + 0.01 * (k % 7)},{k % 5},{1900 if k > 20 else 1500}" for k in range(40)]
    (folder / "run.csv").write_text("\n".join(["t,u,f,w", *rows]), encoding="utf-8")
    (folder / "trial.toml").write_text(declared + records, encoding="utf-8")
    (run,) = load_runs(folder / "trial.toml")
    return run.raw_record()


def test_a_declared_channel_has_its_own_unit_side_and_kind(tmp_path: Path) -> None:
    run = record(tmp_path)
    cells = np.arange(40) % 5
    np.testing.assert_allclose(run["flap"], -np.radians((cells - 2.0) / 0.5 * 3.0 + 1.0))
    flap, valve = run.channel("flap"), run.channel("valve")
    assert (flap.unit, flap.frame, flap.positive, flap.is_command) == ("rad", "none", "down", False)
    assert (valve.unit, valve.is_command) == ("1", True)
    np.testing.assert_allclose(run["valve"][[0, -1]], [0.0, 1.0])


def test_checks_and_conventions_leave_it_as_it_is(tmp_path: Path) -> None:
    run = record(tmp_path)
    examined = examined_record(run)
    np.testing.assert_array_equal(canonical_record(examined.record)["flap"], run["flap"])
    assert not [one for one in examined.findings if one.severity.value == "error"]


@pytest.mark.parametrize(
    ("declared", "records", "says"),
    [
        (DECLARED.replace("flap", "delta"), RECORDS, "channels.delta is known already .rudder or nozzle angle."),
        (DECLARED.replace("channels.flap", 'channels."a b"'), RECORDS, "is named by letters, digits and _"),
        (DECLARED, RECORDS.replace('"up"', '"port"'), "'port' is none of down and up"),
        (DECLARED, RECORDS.replace('"f", unit = "deg"', '"f", unit = "m"'), "is no unit of angle of the stern flap"),
        (DECLARED.replace('meaning = "angle of the stern flap"\n', ""), RECORDS, "key 'channels.flap.meaning' is miss"),
        ("", RECORDS, "unknown channel 'flap'"),
    ],
)
def test_what_clashes_is_refused(declared: str, records: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=says):
        record(tmp_path, declared, records)


def test_nothing_declared_is_nothing() -> None:
    assert declared_channels({}) == NO_DECLARED
    one = declared_channels({"flap": DeclaredChannel(meaning="angle", unit="deg")})["flap"]
    assert one.quantity.unit == "rad" and one.kind == "measured"
    one.require_side(None, "here")


@pytest.mark.parametrize("symbol", [f"{letter}_{k}" for letter in ("command", "alpha", "rpm") for k in (1, 7, 12)])
def test_indexed_channels_take_zero_span_scale_offset_and_side(symbol: str, tmp_path: Path) -> None:
    unit, size = {"c": ("us", 1.0), "a": ("deg", np.pi / 180.0), "r": ("rpm", 1.0 / 60.0)}[symbol[0]]
    side = {"c": "astern", "a": "port", "r": "astern"}[symbol[0]]
    column = f'{{ column = "f", unit = "{unit}", zero = 2, span = 4, scale = 3, offset = 0.5, positive = "{side}" }}'
    records = f'[[records]]\nfiles = "run.csv"\ntime = {{ column = "t" }}\nchannels.{symbol} = {column}\n'
    run = record(tmp_path, "", records)
    values = size * ((np.arange(40) % 5 - 2.0) / 4.0 * 3.0 + 0.5)
    np.testing.assert_allclose(run[symbol], values)
    np.testing.assert_allclose(canonical_record(run)[symbol], -values)
