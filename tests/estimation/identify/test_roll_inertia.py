"""What is known of the ship comes first, and the natural period gives the rest."""

import math

import pytest

from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.values import Ship
from seatrial.estimation.identify.roll_inertia import roll_inertia
from seatrial.physics.hydro.free_roll import metacentric_height

C_1 = IntervalEstimate(1.0, 0.9, 1.1)


@pytest.mark.parametrize(
    ("particulars", "value", "width", "said"),
    [
        ({"k_xx_prime": 2.1, "k_xx": 1.0}, 2.1, 0.0, "taken as exact"),
        ({"k_xx": 1.9, "B": 5.0, "GM": 9.0}, 1.9 * math.sqrt(1.18), 0.219, "added inertia of 18 (5 to 30) %"),
        ({"B": 5.0}, 2.0, 0.5, "0.4 (0.35 to 0.45) of the breadth"),
    ],
)
def test_the_radius_of_gyration_is_given_or_assumed(
    particulars: dict[str, float], value: float, width: float, said: str
) -> None:
    inertia = roll_inertia(Ship("s", particulars), C_1)
    radius, height = inertia.gyradius, inertia.metacentric_height
    assert radius is not None and height is not None
    assert radius.value == pytest.approx(value)
    assert radius.upper - radius.lower == pytest.approx(width, abs=1e-3)
    assert said in inertia.source
    assert height.lower == pytest.approx(metacentric_height(0.9, radius.lower))
    assert height.upper == pytest.approx(metacentric_height(1.1, radius.upper))


def test_a_metacentric_height_that_is_known_gives_the_radius() -> None:
    """And the way back gives the height again; the breadth is no longer needed."""
    inertia = roll_inertia(Ship("s", {"GM": 1.1, "B": 5.0}), C_1)
    radius, height = inertia.gyradius, inertia.metacentric_height
    assert radius is not None and height is not None
    assert (height.lower, height.value, height.upper) == (1.1, 1.1, 1.1)
    assert metacentric_height(1.0, radius.value) == pytest.approx(1.1)
    assert metacentric_height(0.9, radius.upper) == metacentric_height(1.1, radius.lower) == pytest.approx(1.1)
    assert "GM of the ship, 1.1 m" in inertia.source
    assert "3.3" not in inertia.source and "0.66 of the breadth, ships have 0.35 to 0.45" in inertia.source


def test_a_radius_that_ships_have_is_not_questioned() -> None:
    assert "of the breadth" not in roll_inertia(Ship("s", {"GM": 1.1, "B": 8.2}), C_1).source


def test_a_period_that_is_not_determined_leaves_the_radius_open() -> None:
    radius = roll_inertia(Ship("s", {"GM": 1.1}), IntervalEstimate(1.0, -0.1, 2.1)).gyradius
    assert radius is not None and radius.upper == math.inf
