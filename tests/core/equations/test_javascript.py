"""Rates as JavaScript: functions of Math, conditions and signs as the equations have them."""

from seatrial.core.equations.latex import rates_function
from seatrial.physics.models.published import kvlcc2


def test_a_modulus_and_a_condition_are_those_of_the_equations() -> None:
    text = rates_function(kvlcc2())
    assert "Math.abs(" in text and "?" in text
    assert text.startswith("(x, u, p, out) => {") and "out[5] = " in text
