"""What a coefficient stands for follows from its name, and every hull coefficient of a model has a meaning."""

import pytest

from seatrial.physics.models import model_named
from seatrial.physics.models.forces import derivative_meaning


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("Y_vvr", "sway force from v^2 r"),
        ("N_r", "yaw moment from r"),
        ("X_dd", "surge force from delta^2"),
        ("N_0", "yaw moment straight ahead"),
        ("Y_0uu", "sway force from u^2"),
        ("R_0", "resistance straight ahead"),
    ],
)
def test_the_letters_are_read(name: str, meaning: str) -> None:
    assert derivative_meaning(name) == meaning


def test_a_term_with_a_modulus_is_named_as_it_stands_in_the_equation() -> None:
    assert derivative_meaning("Y_vv", "v|v|") == "sway force from v|v|"
    assert model_named("waterjet").parameters["N_rr"].meaning == "yaw moment from r|r|"


@pytest.mark.parametrize("name", ["waterjet", "mmg", "abkowitz", "heave_pitch", "roll", "nomoto"])
def test_every_free_coefficient_of_a_model_has_a_meaning(name: str) -> None:
    assert [p.name for p in model_named(name).parameters.free if not p.meaning] == []
