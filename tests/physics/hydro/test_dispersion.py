"""Dispersion: the relation holds, deep water is its limit, the group velocity is its slope."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import G, group_velocity, wavenumber

omegas, depths = st.floats(0.05, 20.0), st.floats(0.05, 500.0)


@given(omegas, depths)
def test_the_relation_holds_at_any_depth(omega: float, depth: float) -> None:
    k = float(wavenumber(omega, depth))
    assert G * k * np.tanh(k * depth) == pytest.approx(omega**2, rel=1e-10)


@given(omegas, depths)
def test_the_group_velocity_is_the_slope(omega: float, depth: float) -> None:
    step = 1e-5 * omega
    slope = 2.0 * step / float(wavenumber(omega + step, depth) - wavenumber(omega - step, depth))
    assert float(group_velocity(omega, depth)) == pytest.approx(slope, rel=1e-5)


def test_infinite_depth_is_the_limit() -> None:
    w = np.array([0.5, 2.0, 9.0])
    assert wavenumber(w, np.inf) == pytest.approx(w**2 / G)
    assert group_velocity(w, 1e4) == pytest.approx(0.5 * G / w)


def test_still_water_has_no_wave_number() -> None:
    with pytest.raises(InputError, match="positive frequencies"):
        wavenumber(0.0, 1.0)
