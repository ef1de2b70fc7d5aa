"""What is known of the ship comes first, and the natural period gives the rest."""

import math

import pytest

from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.values import Ship
from seatrial.estimation.identify.roll_characteristics import gyradius_findings, roll_inertia
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


def test_a_period_that_is_not_determined_leaves_the_radius_open() -> None:
    radius = roll_inertia(Ship("s", {"GM": 1.1}), IntervalEstimate(1.0, -0.1, 2.1)).gyradius
    assert radius is not None and radius.upper == math.inf


@pytest.mark.parametrize(("radius", "text"), [(3.87, "0.47 of the breadth"), (2.0, "0.24 of the breadth"), (3.2, "")])
def test_a_radius_unusual_for_the_breadth_is_named_with_the_usual_height(radius: float, text: str) -> None:
    ship = Ship("yacht", {"L": 36.0, "B": 8.2, "GM": 1.1})
    findings = gyradius_findings(ship, IntervalEstimate(radius, radius, radius))
    assert [text in f.message for f in findings] == ([True] if text else [])
    if radius == 3.87:
        assert "GM would be 0.79 m" in findings[0].advice


def test_without_height_breadth_or_radius_nothing_is_judged() -> None:
    radius = IntervalEstimate(9.0, 9.0, 9.0)
    assert gyradius_findings(Ship("s", {"B": 8.2}), radius) == gyradius_findings(Ship("s", {"GM": 1.0}), radius) == ()
    assert gyradius_findings(Ship("s", {"B": 8.2, "GM": 1.0}), None) == ()
