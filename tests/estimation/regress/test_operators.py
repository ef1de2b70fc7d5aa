"""Operators are exact where theory says so, of their order elsewhere, and never reach across a gap."""

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.estimation.regress.operators import (
    Central,
    Centred,
    DerivativeOperator,
    Differenced,
    Euler,
    RegressionMotion,
    RegressionRows,
    Smoothed,
    Weak,
    features,
)
from seatrial.physics.models.waterjet import waterjet

TRUE = np.array([p.value for p in waterjet().parameters.free])


def left(rows: RegressionRows) -> np.ndarray:
    """What the true coefficients leave of surge, sway and yaw."""
    return (rows.target - rows.slope @ TRUE)[:, :3]


def test_central_differences_are_of_second_order_where_euler_is_of_first() -> None:
    """Half the step: a quarter of the error, half of Euler's; away from the corners of the nozzle angle."""
    craft = waterjet()
    sizes = {}
    for rate in (5.0, 10.0):
        motion = RegressionMotion.from_record(craft, zigzags().between(62.0, 70.0).resampled(rate))
        for operator in (Euler(), Central()):
            sizes[operator, rate] = float(np.max(np.abs(left(operator.rows(craft, motion))[:, 1])))
    assert sizes[Euler(), 5.0] / sizes[Euler(), 10.0] == pytest.approx(2.0, rel=0.1)
    assert sizes[Central(), 5.0] / sizes[Central(), 10.0] == pytest.approx(4.0, rel=0.2)


@pytest.mark.parametrize("operator", [Euler(), Central(), Smoothed(2.0), Weak(10.0)])
def test_true_coefficients_leave_little(operator: DerivativeOperator) -> None:
    """Less than a twentieth of the sway accelerations."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    rows = operator.rows(craft, motion)
    assert np.std(left(rows)[:, 1]) < 0.05 * np.std(rows.target[:, 1])


def test_a_quasi_difference_is_the_row_less_rho_times_the_one_before() -> None:
    """Song et al. 2025, eq. (17)."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    plain, quasi = Euler().rows(craft, motion), Differenced(Euler(), 0.9).rows(craft, motion)
    np.testing.assert_allclose(quasi.target, plain.target[1:] - 0.9 * plain.target[:-1])
    np.testing.assert_allclose(quasi.slope, plain.slope[1:] - 0.9 * plain.slope[:-1])


def test_centred_rows_have_no_mean() -> None:
    """Song et al. 2025, eq. (18); what is constant becomes zero, not rounding."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    rows = Centred(Euler()).rows(craft, motion)
    np.testing.assert_allclose(rows.slope.mean(axis=0), 0.0, atol=1e-12)
    still = RegressionMotion(motion.time, np.tile(motion.states[100], (len(motion.time), 1)), motion.inputs)
    assert not Centred(Euler()).rows(craft, still).slope.any()


@pytest.mark.parametrize("operator", [Euler(), Central(), Smoothed(2.0), Weak(4.0), Differenced(Euler())])
def test_no_row_reaches_across_a_gap(operator: DerivativeOperator) -> None:
    """Two stretches give the rows of each, whatever lies between them."""
    craft, whole = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    first, second = whole.rows(slice(0, 400)), whole.rows(slice(700, 1500))
    both = RegressionMotion(
        np.concatenate([first.time, second.time]),
        np.concatenate([first.states, second.states]),
        np.concatenate([first.inputs, second.inputs]),
    )
    parts = [operator.rows(craft, m).target for m in (first, second)]
    np.testing.assert_allclose(operator.rows(craft, both).target, np.concatenate(parts), rtol=1e-9, atol=1e-12)


def test_the_weak_form_is_exact_for_windows_of_any_polynomial_motion() -> None:
    """Known terms alone: with x = t^2 the window's mean rate is 2 t at its middle."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    time = motion.time
    states = motion.states.copy()
    states[:, 4] = time**2
    moved = RegressionMotion(time, states, motion.inputs)
    rows = Weak(5.0).rows(craft, moved)
    known = np.interp(rows.time, time, features(craft, moved).known_rates[:, 4])
    assert np.max(np.abs(rows.target[:, 4] + known - 2.0 * rows.time)) < 0.1
