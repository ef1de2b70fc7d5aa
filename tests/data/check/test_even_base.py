"""Rounded stamps: the true step is found, every row stays at its place, and what drops rows is an error."""

import numpy as np
import pytest

from seatrial.core.values import Array, Channel, Record, Severity
from seatrial.data.check.examine import examined_record
from seatrial.data.check.repair import dropped_rows_findings
from seatrial.data.check.time_base import even_base


def three_digits(time: Array) -> Array:
    return np.array([float(f"{t:.3g}") for t in time])


def record(time: Array, clock: Array | None = None) -> Record:
    truth = time if clock is None else clock
    return Record.from_arrays("run", time, {"u": 2.0 + np.sin(0.05 * truth), "r": 0.05 * np.cos(0.05 * truth)})


def test_stamps_of_three_significant_digits_keep_every_row() -> None:
    """Steps of 0.1, 1 and 10 s as the clock grows; the true step is 0.135264 s."""
    step = 0.135264
    clock = step * np.arange(9000)
    base = even_base(three_digits(clock))
    assert base.is_even and base.gaps.size == 0
    np.testing.assert_allclose(base.step, step, rtol=2e-4)
    np.testing.assert_array_equal(base.index, np.arange(9000))
    examined = examined_record(record(three_digits(clock), clock))
    assert len(examined.record) == 9000
    assert not [finding for finding in examined.findings if finding.severity is Severity.ERROR]


@pytest.mark.parametrize("rate", [8.0, 7.39, 5.0])
def test_whole_seconds_with_a_pause_keep_every_row(rate: float) -> None:
    clock = np.arange(4000) / rate
    clock[2000:] += 90.0
    base = even_base(np.floor(clock))
    assert base.is_even and base.gaps.tolist() == [1999]
    np.testing.assert_allclose(1.0 / base.step, rate, rtol=1e-3)
    skipped = base.index[2000] - base.index[1999] - 1
    assert abs(skipped - 90.0 * rate) <= 1.2 * rate  # a second on either side is not known


def test_a_step_without_rounding_is_exact() -> None:
    time = np.delete(0.05 * np.arange(1000), [300, 301, 302])
    base = even_base(time)
    np.testing.assert_allclose([base.step, base.jitter], [0.05, 0.0], atol=1e-9)
    assert base.is_even and base.gaps.tolist() == [299] and base.index[300] == 303


def test_rows_that_a_repair_drops_are_an_error() -> None:
    time = 0.1 * np.arange(3000)
    whole = record(time)
    assert dropped_rows_findings(whole, [whole.between(0.0, 290.0)]) == ()
    assert dropped_rows_findings(whole, [whole.between(0.0, 140.0), whole.between(145.0, 299.9)]) == ()
    (finding,) = dropped_rows_findings(whole, [whole.between(0.0, 200.0)])
    assert finding.severity is Severity.ERROR and "drops 33% of its rows" in finding.message
    assert "2001 of 3000 rows remain" in finding.evidence


def test_an_input_that_is_mostly_empty_is_named() -> None:
    time = 0.1 * np.arange(3000)
    whole = record(time)
    values = np.where(np.arange(3000) % 1000 < 10, 0.1, np.nan)
    holed = whole.with_channel("delta", Channel.from_notation("delta", values))
    (finding,) = [one for one in examined_record(holed).findings if one.code == "rows-dropped"]
    assert "remove channels.delta, which is empty in 2970 rows" in finding.advice


def test_each_lost_second_of_a_clock_counts() -> None:
    """Whole seconds of which two were not logged: the step stays one second, and a part of the log has the same."""
    time = np.delete(np.arange(0.0, 600.0), [100, 400])
    base = even_base(time)
    assert base.is_even and base.step == pytest.approx(1.0, abs=1e-12) and not base.gaps.size
    np.testing.assert_array_equal(base.index, time)
    jittered = 0.1 * np.delete(np.arange(600), [100, 400]) + np.random.default_rng(1).uniform(-0.002, 0.002, 598)
    assert even_base(jittered).step == pytest.approx(0.1, abs=1e-5) and even_base(jittered).index[-1] == 599
