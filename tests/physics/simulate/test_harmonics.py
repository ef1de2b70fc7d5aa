"""Harmonic response: against the integrated equations, and energy that a fixed sum of harmonics brings."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import theoretical_coefficients
from seatrial.physics.simulate.linear import LinearBatch, frequency_response, harmonic_motion, linear_system


def test_motion_in_harmonics_equals_the_propagated_one(rng: np.random.Generator) -> None:
    model = theoretical_coefficients(90).applied_to(heave_pitch())
    omega, dt, n = np.array([0.7, -1.3, 2.1]), 0.02, 2001
    amplitude = np.zeros((3, 4), complex)
    amplitude[:, :2] = rng.normal(size=(3, 2, 2)) @ [1, 1j] * [2e5, 5e6]
    time, start = np.arange(n) * dt, rng.normal(size=4) * 0.1
    exact = harmonic_motion(linear_system(model), omega, amplitude, time, start)
    u = (np.exp(1j * np.outer(time, omega)) @ amplitude).real
    y, _ = LinearBatch(model, np.ascontiguousarray(u), np.array([0, n]), dt, model.states).simulate(
        0, 1, start[None], model.parameters.values[None], np.empty((1, 0))
    )
    np.testing.assert_allclose(y, exact, atol=1e-5 * np.abs(exact).max())


def test_a_constant_force_is_met_by_the_stiffness() -> None:
    model = theoretical_coefficients(180).applied_to(heave_pitch())
    still = frequency_response(linear_system(model, ("z", "theta")), np.zeros(1))[0, :, :2].real
    stiffness = np.array([[3.15e6, 6.83e6], [6.83e6, 6.54e8]])
    np.testing.assert_allclose(still @ stiffness, np.eye(2), atol=1e-9)


def test_a_ship_that_turns_has_no_frequency_response() -> None:
    with pytest.raises(InputError, match="not linear"):
        linear_system(nomoto())
