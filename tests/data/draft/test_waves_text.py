"""The hull of which only the length is known is a plausible one."""

import math

import pytest

from seatrial.data.draft.draft_text import ship_in_waves
from seatrial.data.draft.ship_estimates import StatedSize


def test_natural_periods_are_those_of_a_ship() -> None:
    """With added masses as large as the masses, heave and pitch of a 100 m ship have periods of 5 to 9 s."""
    values = {one.key: one.value for one in ship_in_waves(StatedSize(100.0))}
    for mass, stiffness in (("m", "c33"), ("I5", "c55")):
        assert 5.0 < 2.0 * math.pi * math.sqrt(2.0 * values[mass] / values[stiffness]) < 9.0


def test_stiffness_is_that_of_the_stated_water() -> None:
    sea, fresh = ({one.key: one for one in ship_in_waves(StatedSize(2.6, rho=rho))} for rho in (0.0, 1000.0))
    assert fresh["c33"].value / sea["c33"].value == pytest.approx(1000.0 / 1025.0)
    assert "in sea water" in sea["c33"].line and "in water of 1000 kg/m^3" in fresh["c33"].line


@pytest.mark.parametrize(("key", "power"), [("m", 3), ("c33", 2), ("c55", 4), ("I5", 5)])
def test_ships_of_one_form_scale_as_froude(key: str, power: int) -> None:
    small, large = ({one.key: one.value for one in ship_in_waves(StatedSize(length))} for length in (2.0, 4.0))
    assert large[key] == pytest.approx(2.0**power * small[key])
