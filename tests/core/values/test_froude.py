"""Froude similarity: exponents against the laws, and there and back again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import Channel, InputError, Record
from seatrial.core.values.froude import factor, scaled


def test_exponents_follow_the_laws() -> None:
    ratio = 45.7
    assert factor("m", ratio) == pytest.approx(ratio)
    assert factor("m/s", ratio) == pytest.approx(factor("m", ratio) / factor("s", ratio))
    assert factor("m/s^2", ratio) == 1.0
    assert factor("rad/s", ratio) == pytest.approx(1.0 / factor("s", ratio))
    assert factor("N", ratio) == pytest.approx(factor("kg", ratio) * factor("m/s^2", ratio))
    assert factor("N m", ratio) == pytest.approx(ratio**4)


def record() -> Record:
    made = Record.of("run", np.arange(5.0), {"u": np.arange(5.0), "psi": np.ones(5), "thrust": np.full(5, 3.0)})
    return made.with_channel("x0", Channel(np.arange(5.0), "m", "earth", "north", reference_point=0.5))


def test_record_and_its_reference_points_are_scaled() -> None:
    full = scaled(record(), 4.0)
    np.testing.assert_allclose(full.time, 2.0 * np.arange(5.0))
    np.testing.assert_allclose(full["u"], 2.0 * np.arange(5.0))
    np.testing.assert_allclose(full["thrust"], 192.0)
    np.testing.assert_array_equal(full["psi"], 1.0)
    assert full.channel("x0").reference_point == 2.0
    assert "Froude-scaled by 4" in full.provenance.steps


@given(st.floats(0.01, 200.0))
def test_there_and_back(ratio: float) -> None:
    back = scaled(scaled(record(), ratio), 1.0 / ratio)
    for symbol in record().channels:
        np.testing.assert_allclose(back[symbol], record()[symbol], rtol=1e-12)
    np.testing.assert_allclose(back.time, record().time, rtol=1e-12)


@pytest.mark.parametrize("ratio", [0.0, -2.0, float("nan")])
def test_scale_must_be_positive(ratio: float) -> None:
    with pytest.raises(InputError, match="scale must be a positive number"):
        scaled(record(), ratio)
