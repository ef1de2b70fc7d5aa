"""Programmes of craft with thrusters: what a text says, and what cannot be read."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.manoeuvres.thrust_programme import EXAMPLES, thrust_programme


def test_numbers_are_per_cent_and_degrees_and_sides_turn_the_yaw_command() -> None:
    zigzag = thrust_programme("zigzag:30/20:port")
    assert (zigzag.yaw, zigzag.ahead, zigzag.is_from_rest) == (-0.3, None, False)
    assert zigzag.switching == pytest.approx(np.radians(20.0))
    assert (thrust_programme("spin:50").yaw, thrust_programme("spin:50").ahead) == (0.5, 0.0)
    assert thrust_programme("straight:25").is_from_rest and not thrust_programme("stop:25").is_from_rest


@pytest.mark.parametrize("text", ["turning-circle:35", "spin", "spin:0", "zigzag:20", "stop:120", "straight:fast"])
def test_what_cannot_be_read_names_what_can(text: str) -> None:
    with pytest.raises(InputError) as error:
        thrust_programme(text)
    assert any(example in str(error.value) for example in EXAMPLES.values())
