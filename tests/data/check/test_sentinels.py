"""Readings that stand for none are empty cells; a clock that jumps by days is one sentence; counts agree with nouns."""

from dataclasses import replace
from itertools import accumulate

import numpy as np
import pytest
from tests.data.check.ship import with_values, zigzag

from seatrial.core.values import Array, InputError, Record, Severity
from seatrial.core.values.arrays import sentinel_value, smeared_wraps
from seatrial.data.check import examine, examined_record
from seatrial.data.check.repair import without_sentinels


@pytest.mark.parametrize(("symbol", "sentinel"), [("u", -999.0), ("psi", -17.435839), ("x0", 1e6), ("r", 32.767)])
def test_a_value_far_outside_that_recurs_is_no_reading(symbol: str, sentinel: float) -> None:
    record = zigzag(noise=1.0)
    values = np.array(record[symbol])
    values[[50, 51, 52, 700, 1500]] = sentinel
    (finding,) = [f for f in examine(with_values(record, **{symbol: values})) if f.code == "no-reading"]
    assert f"'{symbol}': 5 readings of" in finding.message
    cleaned = examined_record(with_values(record, **{symbol: values})).record
    np.testing.assert_allclose(cleaned[symbol], record[symbol], atol=0.3)


def test_what_a_craft_does_is_a_reading() -> None:
    record = zigzag(noise=1.0)
    assert without_sentinels(record) == (record, ())
    assert sentinel_value(np.repeat([0.0, 1.0], 50)) is None  # a switch
    assert sentinel_value(np.append(np.linspace(0.0, 1.0, 50), 99.0)) is None  # a single wild sample
    assert sentinel_value(np.full(5, np.nan)) is None


def averaged(psi: Array) -> Array:
    """The angle after a low pass that knows of no whole turns."""
    return np.array(list(accumulate(psi.tolist(), lambda before, now: before + 0.4 * (now - before))))


@pytest.mark.parametrize("turn", [0.0, np.pi])
def test_a_heading_averaged_across_north_is_an_error_and_empty_there(turn: float) -> None:
    record = zigzag()
    psi = np.mod(record["psi"] - np.radians(60.0), 2.0 * np.pi) - turn
    assert smeared_wraps(psi) == []
    examined = examined_record(with_values(record, psi=averaged(psi)))
    (error,) = [f for f in examined.findings if f.code == "angle-wrap" and f.severity is Severity.ERROR]
    assert "runs the wrong way round" in error.evidence
    apart = np.angle(np.exp(1j * (examined.record["psi"] - psi)))
    assert float(np.max(np.abs(apart))) < np.radians(10.0)


def test_a_clock_that_jumps_by_years_is_one_sentence_with_the_edit() -> None:
    record = zigzag()
    jumped = replace(record, time=np.where(np.arange(3000) < 1000, record.time, record.time + 3e8))
    with pytest.raises(InputError, match=r"the clock jumps by 3e\+08 s after 99.9 s; cut the run there: parts = \["):
        examine(jumped)


def test_a_pause_of_minutes_is_no_jump() -> None:
    record = zigzag()
    paused = replace(record, time=np.where(np.arange(3000) < 1500, record.time, record.time + 600.0))
    assert "time-gap" in [finding.code for finding in examine(paused)]


def test_one_is_singular() -> None:
    record = zigzag(noise=1.0)
    values = {symbol: np.append(np.nan, record[symbol][1:]) for symbol in record.channels}
    (finding,) = [f for f in examine(Record.from_arrays("run", record.time, values)) if f.code == "empty-rows"]
    assert "begins with 1 empty row, cut off" in finding.message
