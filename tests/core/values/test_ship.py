"""A ship has a scale that is one."""

import math

import pytest

from seatrial.core.values import InputError, Ship


@pytest.mark.parametrize("scale", [0.0, -40.0, -1e308, math.nan])
def test_a_scale_that_is_none_is_refused(scale: float) -> None:
    with pytest.raises(InputError, match=r"^ship: scale = .* is not positive"):
        Ship("craft", {"L": 9.8}, scale=scale)
