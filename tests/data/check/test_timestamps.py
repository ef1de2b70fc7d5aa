"""The time base is rebuilt evenly and said so: rounded, repeated, missing stamps, gaps, uneven sampling."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check import rebuild_time_base


def run(time: Array, values: Array | None = None) -> Record:
    return Record.from_arrays("run", time, {"u": np.sin(0.1 * time) if values is None else values})


def codes(record: Record) -> list[str]:
    return [finding.code for finding in rebuild_time_base(record)[1]]


def test_an_even_record_is_returned_as_it_is() -> None:
    record = run(0.1 * np.arange(50))
    assert rebuild_time_base(record) == (record, ())


@given(st.sampled_from([0.03, 0.05, 1 / 3, 0.04]), st.sampled_from([1, 2]), st.integers(60, 300))
@settings(max_examples=30)
def test_rounded_stamps_are_spread(dt: float, decimals: int, count: int) -> None:
    exact = dt * np.arange(count)
    values = np.cos(exact)
    rebuilt, findings = rebuild_time_base(run(np.round(exact, decimals), values))
    if len(findings) == 0:
        return
    assert [f.code for f in findings] == ["time-base"] and "rebuilt" in findings[0].message
    assert rebuilt.is_uniform
    np.testing.assert_array_equal(rebuilt["u"], values)
    assert rebuilt.dt == pytest.approx(dt, rel=0.02)


def test_repeated_stamps_are_named() -> None:
    _, findings = rebuild_time_base(run(np.round(0.05 * np.arange(200), 1), np.arange(200.0)))
    assert "99 repeated or rounded time stamps" in findings[0].message


def test_samples_lost_in_a_gap_become_empty_rows() -> None:
    time = np.delete(0.1 * np.arange(100), slice(40, 47))
    rebuilt, findings = rebuild_time_base(run(time, np.arange(93.0)))
    assert [f.code for f in findings] == ["time-gap"]
    assert len(rebuilt) == 100 and np.isnan(rebuilt["u"][40:47]).all()
    np.testing.assert_array_equal(rebuilt["u"][47:], np.arange(40.0, 93.0))


def test_rows_written_twice_are_dropped() -> None:
    time = np.repeat(0.1 * np.arange(40), [2 if k % 7 == 0 else 1 for k in range(40)])
    rebuilt, findings = rebuild_time_base(run(time))
    assert [f.code for f in findings] == ["repeated-rows"] and len(rebuilt) == 40


def test_rows_alike_by_rounding_are_kept() -> None:
    """Towing tanks write three significant digits: beyond 100 s stamps come in whole seconds."""
    exact = 0.13527 * np.arange(4000)
    time = np.array([float(f"{t:.2E}") for t in exact])
    rebuilt, findings = rebuild_time_base(run(time, np.round(10.0 * np.sin(0.02 * exact))))
    assert [f.code for f in findings] == ["time-base"]
    assert len(rebuilt) == 4000 and rebuilt.dt == pytest.approx(0.13527, rel=1e-4)


def test_uneven_sampling_is_interpolated(rng: np.random.Generator) -> None:
    time = np.cumsum(rng.uniform(0.02, 0.2, 400))
    rebuilt, findings = rebuild_time_base(run(time))
    assert [f.code for f in findings] == ["uneven-sampling"] and rebuilt.is_uniform
    np.testing.assert_allclose(rebuilt["u"], np.sin(0.1 * rebuilt.time), atol=1e-3)
    other, _ = rebuild_time_base(run(np.cumsum(rng.uniform(0.02, 0.2, 300))))
    assert [one.dt for one in (rebuilt, other)] == pytest.approx([1.0 / 9.0] * 2)  # the mean is 0.11 s


def test_missing_stamps_are_counted_in() -> None:
    time = 0.1 * np.arange(30)
    time[[0, 10, 11, 29]] = np.nan
    rebuilt, findings = rebuild_time_base(run(time, np.arange(30.0)))
    assert [f.code for f in findings] == ["time-base"] and "4 time stamps missing" in findings[0].message
    np.testing.assert_allclose(rebuilt.time, 0.1 * np.arange(30), atol=1e-12)


def test_empty_rows_at_the_ends_are_cut() -> None:
    time = np.r_[np.nan, 0.1 * np.arange(20), np.full(5, np.nan)]
    values = np.r_[np.nan, np.ones(20), np.full(5, np.nan)]
    rebuilt, findings = rebuild_time_base(run(time, values))
    assert len(rebuilt) == 20 and findings[0].code == "empty-rows" and "6 empty rows" in findings[0].message
    assert "12 empty cells" in findings[0].evidence


def test_refusals() -> None:
    with pytest.raises(InputError, match="time runs backwards at sample 3"):
        rebuild_time_base(run(np.array([0.0, 0.2, 0.1])))
    with pytest.raises(InputError, match="one sample"):
        rebuild_time_base(run(np.array([0.0])))
    with pytest.raises(InputError, match="holds no values at all"):
        rebuild_time_base(run(np.arange(3.0), np.full(3, np.nan)))
