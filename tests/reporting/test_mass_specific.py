"""Units of coefficients whose forces are those on each kilogram."""

from dataclasses import replace

import pytest
from tests.reporting.test_thruster_chapter import CRAFT

from seatrial.core.results import Fit
from seatrial.physics.models import model_named
from seatrial.reporting.model_chapter import mass_specific_unit, with_mass_specific_units


@pytest.mark.parametrize(("unit", "text"), [
    ("N", "N/kg"), ("kg", "1"), ("kg/s", "1/s"), ("kg/m", "1/m"), ("kg m^2", "m^2"), ("kg m^2/s", "m^2/s"),
    ("kg m/s", "m/s"), ("N^0.5 s/m", "N^0.5 s/(m kg^0.5)"), ("s^2/m^2", "s^2/m^2"), ("rad", "rad"), ("1", "1"),
    ("1/m", "1/m"),
])  # fmt: skip
def test_mass_and_force_stand_over_kilograms(unit: str, text: str) -> None:
    assert mass_specific_unit(unit) == text


def test_no_unit_of_the_model_keeps_mass_but_those_of_forces() -> None:
    units = {p.unit for p in model_named("thrusters").parameters}
    assert {mass_specific_unit(one) for one in units if "kg" in one or "N" in one} == {
        "N/kg", "1", "1/s", "1/m", "m", "m^2", "m/s", "m^2/s", "N^0.5 s/(m kg^0.5)",
    }  # fmt: skip


def test_a_craft_of_known_thrust_and_a_ship_keep_their_units(fit: Fit) -> None:
    (first, *rest) = fit.coefficients
    heavy = replace(fit, coefficients=(replace(first, unit="kg/s"), *rest))
    assert with_mass_specific_units(heavy) is heavy
    assert with_mass_specific_units(replace(heavy, thruster_craft=CRAFT)).coefficients[0].unit == "1/s"
    newtons = replace(heavy, thruster_craft=replace(CRAFT, force_unit="N"))
    assert with_mass_specific_units(newtons) is newtons
