"""Parts of the linear controller: its size, its limits, and what stall leaves of an angle."""

import pytest

from seatrial.numerics.kernels.feedback import clamp, controller_size, effective_angle


def test_a_controller_of_order_n_takes_its_matrices() -> None:
    n = 3
    transition, gains, order_row = n * n, 2 * n, n + 2
    assert controller_size(n) == transition + gains + order_row


@pytest.mark.parametrize(("value", "cut"), [(0.5, 0.5), (2.0, 1.0), (-2.0, -1.0)])
def test_a_value_is_cut_on_both_sides(value: float, cut: float) -> None:
    assert clamp(value, 1.0) == cut


@pytest.mark.parametrize(("angle", "effect"), [(0.2, 0.2), (0.4, 0.25), (-0.4, -0.25), (1.0, 0.0)])
def test_beyond_stall_the_lift_falls_to_nothing(angle: float, effect: float) -> None:
    assert effective_angle(angle, stall=0.3, loss=0.5) == pytest.approx(effect)
