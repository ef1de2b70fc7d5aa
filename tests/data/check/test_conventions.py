"""Declared conventions to the house's: signs, frames, reference points, unwrapping; twice is once."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.data.check.ship import in_earth_axes, with_declaration, with_values, zigzag

from seatrial.core.values import InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.check.conventions import statement_findings


def expect_equal(a: Record, b: Record, tolerance: float = 1e-12) -> None:
    assert list(a.channels) == list(b.channels)
    for symbol, channel in a.channels.items():
        np.testing.assert_allclose(channel.values, b[symbol], rtol=0, atol=tolerance)
        for key in ("unit", "frame", "positive", "reference_point"):
            assert getattr(channel, key) == getattr(b.channel(symbol), key)


@st.composite
def conventions(draw: st.DrawFn) -> Record:
    record = zigzag(draw(st.floats(-0.6, 0.6)), count=200)
    if draw(st.booleans()):
        record = in_earth_axes(record)
    for symbol in ("psi", "r", "delta"):
        if draw(st.booleans()):
            record = with_declaration(record, symbol, positive="port")
    if draw(st.booleans()):
        record = with_declaration(record, "y0", positive="west")
    for symbol in ("v", "x0", "y0"):
        record = with_declaration(record, symbol, reference_point=draw(st.floats(-3, 3)))
    return record


@given(conventions(), st.floats(-3, 3))
@settings(max_examples=30)
def test_twice_is_once(record: Record, point: float) -> None:
    once = canonical_record(record, point)
    twice = canonical_record(once, point)
    for symbol in once.channels:
        np.testing.assert_array_equal(once[symbol], twice[symbol])
    assert once.provenance == twice.provenance


def test_a_record_in_house_conventions_is_untouched() -> None:
    expect_equal(canonical_record(zigzag()), zigzag(), 0.0)


def test_earth_fixed_velocities_come_back_into_the_ship() -> None:
    expect_equal(canonical_record(in_earth_axes(zigzag())), zigzag())


@pytest.mark.parametrize(("symbol", "positive"), [("delta", "port"), ("psi", "port"), ("y0", "west"), ("u", "aft")])
def test_signs_are_turned_as_declared(symbol: str, positive: str) -> None:
    turned = with_values(with_declaration(zigzag(), symbol, positive=positive), **{symbol: -zigzag()[symbol]})
    expect_equal(canonical_record(turned), zigzag())


@given(st.floats(-5, 5), st.floats(-5, 5))
@settings(max_examples=20)
def test_reference_points_there_and_back(there: float, back: float) -> None:
    moved = canonical_record(canonical_record(zigzag(count=200), there), back)
    direct = canonical_record(zigzag(count=200), back)
    expect_equal(moved, direct, 1e-11)


def test_the_shifted_point_moves_with_its_own_velocity() -> None:
    """Oracle: d(position)/dt at the new point equals the turned velocity there."""
    record = canonical_record(zigzag(count=2000), 2.0)
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    east = record["u"] * s + record["v"] * c
    np.testing.assert_allclose(np.gradient(record["y0"], record.dt)[5:-5], east[5:-5], atol=2e-3)
    assert record.channel("v").reference_point == 2.0 and record.channel("u").reference_point == 2.0
    np.testing.assert_array_equal(record["u"], zigzag(count=2000)["u"])


def test_headings_are_unwrapped_over_holes() -> None:
    record = zigzag()
    psi = np.linspace(0.0, 20.0, len(record))
    wrapped = (psi + np.pi) % (2 * np.pi) - np.pi
    wrapped[100:110] = np.nan
    unwrapped = canonical_record(with_values(record, psi=wrapped))["psi"]
    known = np.isfinite(wrapped)
    np.testing.assert_allclose(unwrapped[known], psi[known], atol=1e-12)
    assert np.isnan(unwrapped[100:110]).all()


def test_a_drift_speed_is_moved_by_the_rate_of_the_heading_where_no_gyro_is_recorded() -> None:
    record = zigzag()
    moved = canonical_record(record.without("r"), 1.0)
    expected = record["v"] + np.gradient(record["psi"], record.time)
    np.testing.assert_allclose(moved["v"], expected, atol=1e-12)


def test_refusals() -> None:
    with pytest.raises(InputError, match="positive must be 'starboard' or 'port', not 'left'"):
        canonical_record(with_declaration(zigzag(), "delta", positive="left"))
    with pytest.raises(InputError, match="needs the heading 'psi'"):
        canonical_record(zigzag().without("r", "psi", "x0", "y0"), 1.0)
    with pytest.raises(InputError, match="heading 'psi'"):
        canonical_record(in_earth_axes(zigzag()).without("psi", "x0", "y0"))


@pytest.mark.parametrize(("place", "count"), [(0.0, 1), (1.9, 0)])
def test_waves_met_ahead_of_midship_refute_no_side_of_heave(place: float, count: int) -> None:
    """At midship heave against long waves has another side; a probe half a wave ahead shows the same."""
    time = 0.05 * np.arange(4000)
    wave = sum(0.02 * np.cos(rate * time + phase) for rate, phase in ((2.0, 0.3), (2.6, 1.9), (3.1, 4.0), (3.7, 5.1)))
    record = Record.from_arrays("run", time, {"zeta": wave, "z": 0.8 * wave})  # z down, as waves lift no craft
    record = record.with_channel("zeta", replace(record.channel("zeta"), reference_point=place))
    findings, _ = statement_findings(record)
    assert [one.code for one in findings] == ["wrong-sign"] * count


@pytest.mark.parametrize("seed", range(4))
def test_the_noise_of_a_straight_run_contradicts_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = np.arange(280) / 10.0  # a compass that is coarser than the gyro, on a course of 28 s
    swing = np.radians(3.0 * np.exp(-time / 8.0))
    channels = {"psi": swing + rng.normal(0.0, np.radians(0.5), 280), "r": np.gradient(swing, 0.1)}
    channels["r"] += rng.normal(0.0, np.radians(0.25), 280)
    assert statement_findings(Record.from_arrays("straight", time, channels)) == ((), frozenset())
