"""Froude similarity: exponents against the laws, and there and back again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import Channel, InputError, Record
from seatrial.core.values.record import froude_factor, froude_scaled


def test_exponents_follow_the_laws() -> None:
    ratio = 45.7
    assert froude_factor("m", ratio) == pytest.approx(ratio)
    assert froude_factor("m/s", ratio) == pytest.approx(froude_factor("m", ratio) / froude_factor("s", ratio))
    assert froude_factor("m/s^2", ratio) == 1.0
    assert froude_factor("rad/s", ratio) == pytest.approx(1.0 / froude_factor("s", ratio))
    assert froude_factor("N", ratio) == pytest.approx(froude_factor("kg", ratio) * froude_factor("m/s^2", ratio))
    assert froude_factor("N m", ratio) == pytest.approx(ratio**4)


def record() -> Record:
    made = Record.from_arrays(
        "run", np.arange(5.0), {"u": np.arange(5.0), "psi": np.ones(5), "thrust": np.full(5, 3.0)}
    )
    return made.with_channel("x0", Channel(np.arange(5.0), "m", "earth", "north", reference_point=0.5))


def test_record_and_its_reference_points_are_scaled() -> None:
    full = froude_scaled(record(), 4.0)
    np.testing.assert_allclose(full.time, 2.0 * np.arange(5.0))
    np.testing.assert_allclose(full["u"], 2.0 * np.arange(5.0))
    np.testing.assert_allclose(full["thrust"], 192.0)
    np.testing.assert_array_equal(full["psi"], 1.0)
    assert full.channel("x0").reference_point == 2.0
    assert "Froude-scaled by 4" in full.provenance.steps


@given(st.floats(0.01, 200.0))
def test_there_and_back(ratio: float) -> None:
    back = froude_scaled(froude_scaled(record(), ratio), 1.0 / ratio)
    for symbol in record().channels:
        np.testing.assert_allclose(back[symbol], record()[symbol], rtol=1e-12)
    np.testing.assert_allclose(back.time, record().time, rtol=1e-12)


@pytest.mark.parametrize("ratio", [0.0, -2.0, float("nan")])
def test_scale_must_be_positive(ratio: float) -> None:
    with pytest.raises(InputError, match="scale must be a positive number"):
        froude_scaled(record(), ratio)
