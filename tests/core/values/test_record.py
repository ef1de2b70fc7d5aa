"""Records: one time base, immutable, out to pandas and xarray and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from seatrial.core.values import Channel, InputError, Record, RecordKind

finite = st.floats(-1e6, 1e6)


@pytest.fixture
def record() -> Record:
    time = np.arange(0.0, 10.0, 0.1)
    made = Record.from_arrays("run 1", time, {"u": 1.0 + 0.01 * time, "delta": np.sin(time)})
    rudder = made.channel("delta")
    port = Channel(rudder.values, rudder.unit, rudder.frame, "port", 1.5, "RUDDER [deg]")
    return made.with_channel("delta", port, "relabelled")


def assert_same(a: Record, b: Record) -> None:
    assert a.name == b.name
    np.testing.assert_array_equal(a.time, b.time)
    assert list(a.channels) == list(b.channels)
    for symbol in a.channels:
        x, y = a.channel(symbol), b.channel(symbol)
        np.testing.assert_array_equal(x.values, y.values)
        metadata = (x.unit, x.frame, x.positive, x.reference_point, x.label)
        assert metadata == (y.unit, y.frame, y.positive, y.reference_point, y.label)


def test_pandas_round_trip(record: Record) -> None:
    back = Record.from_dataframe(record.to_dataframe())
    assert_same(record, back)
    assert (back.kind, back.provenance) == (record.kind, record.provenance)


def test_time_that_runs_backwards_is_refused_and_repeated_stamps_have_no_step() -> None:
    with pytest.raises(InputError, match="time runs backwards at sample 3"):
        Record.from_arrays("r", np.array([0.0, 0.2, 0.1]), {"u": np.ones(3)})
    repeated = Record.from_arrays("r", np.zeros(3), {"u": np.ones(3)})
    with pytest.raises(InputError, match="uneven time base"):
        _ = repeated.dt


def test_xarray_round_trip(record: Record) -> None:
    pytest.importorskip("xarray", reason="needs the extra 'formats'")
    assert_same(record, Record.from_xarray(record.to_xarray()))


@given(arrays.arrays(np.float64, st.tuples(st.just(3), st.integers(1, 20)), elements=finite))
def test_pandas_round_trip_of_any_numbers(values: np.ndarray) -> None:
    made = Record.from_arrays("any", np.arange(values.shape[1]) * 0.5, dict(zip(("u", "v", "r"), values, strict=True)))
    assert_same(made, Record.from_dataframe(made.to_dataframe()))


def test_a_bare_frame_takes_the_tables_conventions(record: Record) -> None:
    frame = record.to_dataframe()
    frame.attrs = {}
    made = Record.from_dataframe(frame, name="bare")
    assert made.name == "bare"
    assert made.channel("delta").positive == "starboard"


def test_nothing_can_be_written_to(record: Record) -> None:
    with pytest.raises(ValueError, match="read-only"):
        record["u"][0] = 5.0
    with pytest.raises(TypeError):
        record.channels["u"] = record.channel("delta")  # type: ignore[index]


def test_the_caller_s_array_is_copied() -> None:
    values = np.ones(3)
    made = Record.from_arrays("copy", np.arange(3.0), {"u": values})
    values[0] = 9.0
    assert made["u"][0] == 1.0


def test_time_step_and_duration(record: Record) -> None:
    assert record.dt == pytest.approx(0.1, rel=1e-12)
    assert record.duration == pytest.approx(9.9)
    assert record.is_uniform


def test_an_uneven_time_base_has_no_step() -> None:
    made = Record.from_arrays("uneven", np.array([0.0, 0.1, 0.3]), {"u": np.ones(3)})
    with pytest.raises(InputError, match="'uneven' has an uneven time base"):
        _ = made.dt


def test_one_sample_has_no_step() -> None:
    made = Record.from_arrays("short", np.array([0.0]), {"u": np.ones(1)})
    with pytest.raises(InputError, match="'short' has one sample"):
        _ = made.dt


def test_resampling_by_a_divisor_keeps_the_samples(record: Record) -> None:
    made = record.resampled(5.0)
    np.testing.assert_array_equal(made["u"], record["u"][::2])
    assert made.dt == pytest.approx(0.2)


def test_resampling_otherwise_is_linear(record: Record) -> None:
    made = record.resampled(7.0)
    np.testing.assert_allclose(made["u"], 1.0 + 0.01 * made.time, rtol=1e-12)
    assert made.time[-1] <= record.time[-1]
    assert made.provenance.steps[-1] == "resampled to 7 Hz"


@pytest.mark.parametrize("rate", [1e12, np.inf, np.nan])
def test_a_rate_beyond_any_memory_is_refused(record: Record, rate: float) -> None:
    with pytest.raises(InputError, match="give a lower rate"):
        record.resampled(rate)


def test_cutting_is_inclusive_of_both_ends(record: Record) -> None:
    made = record.between(1.0, 2.0)
    assert (made.time[0], made.time[-1]) == pytest.approx((1.0, 2.0))
    assert len(made) == 11
    since_1970 = Record.from_arrays("run", 1.7e9 + np.arange(100) * 0.1, {"u": np.zeros(100)})
    assert len(since_1970.between(1.7e9 + 2.0, 1.7e9 + 3.0)) == 11
    with pytest.raises(InputError, match=r"'run 1' has no samples between 20 and 30 s"):
        record.between(20.0, 30.0)


def test_matrix_is_in_the_order_asked_for(record: Record) -> None:
    made = record.matrix(("delta", "u"))
    assert made.shape == (100, 2) and made.flags.c_contiguous
    np.testing.assert_array_equal(made[:, 1], record["u"])
    assert record.matrix(()).shape == (100, 0)


def test_provenance_says_what_was_done(record: Record) -> None:
    assert record.provenance.steps == ("relabelled",)
    assert record.without("delta").renamed("b").name == "b"
    assert record.kind is RecordKind.MEASURED


def test_bad_records_are_refused() -> None:
    with pytest.raises(InputError, match="'empty' is empty"):
        Record.from_arrays("empty", np.empty(0), {})
    with pytest.raises(InputError, match="channel 'u' has 2 samples, time 3"):
        Record.from_arrays("ragged", np.arange(3.0), {"u": np.ones(2)})
    with pytest.raises(InputError, match="unknown channel 'deltaa'; did you mean 'delta'"):
        Record.from_arrays("name", np.arange(3.0), {"deltaa": np.ones(3)})


def test_an_absent_channel_is_named(record: Record) -> None:
    with pytest.raises(InputError, match="'run 1' has no channel 'psi'"):
        record["psi"]


def test_what_was_not_measured_stays_marked_through_cuts_and_rates() -> None:
    time = 0.1 * np.arange(100)
    plain = Record.from_arrays("run", time, {"u": time})
    record = plain.with_channel("u", plain.channel("u").with_measured(np.arange(100) % 10 == 3))
    assert np.flatnonzero(np.isfinite(record.measured("u")))[:2].tolist() == [3, 13]
    np.testing.assert_allclose(record.channel("u").readings[:2], [0.3, 1.3])
    assert np.isfinite(record.between(1.0, 2.0).measured("u")).sum() == 1
    slow = record.resampled(2.0)  # every fifth row: what was read in between counts at the nearest
    assert np.flatnonzero(np.isfinite(slow.measured("u")))[:2].tolist() == [1, 3]
    assert np.isfinite(plain.measured("u")).all() and plain.channel("u").with_measured(time >= 0.0).is_measured is None


def test_what_is_computed_of_a_record_is_computed_once(record: Record) -> None:
    calls = list[str]()

    def duration(one: Record) -> float:
        calls.append(one.name)
        return one.duration

    assert record.computed(duration) == record.computed(duration) == record.duration
    other = record.renamed("run 2")
    assert other.computed(duration) == record.duration
    assert calls == ["run 1", "run 2"]
