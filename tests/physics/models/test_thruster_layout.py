"""Layouts of thrusters: what is refused, sharing of coefficients, text and back."""

import math

import pytest

from seatrial.core.values import InputError
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import (
    CATAMARAN,
    AngleInput,
    CommandInput,
    Damping,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)

COMMAND = CommandInput("command_1")


def test_a_layout_is_its_text_again() -> None:
    pod = Thruster("pod", -1.0, 0.0, COMMAND, AngleInput("alpha_1", 0.4, 1.0), ThrustCurve.KNOTS, (-1.0, 0.0, 1.0))
    layout = ThrusterLayout((pod,), Damping.CROSS_FLOW, 5.0, has_voltage=True)
    assert ThrusterLayout.from_text(layout.text()) == layout


def test_coefficients_are_named_by_their_thruster_where_there_are_several_sets() -> None:
    bow = Thruster("bow", 1.0, 0.0, COMMAND, math.pi / 2)
    port, starboard = CATAMARAN.thrusters
    layout = ThrusterLayout((bow, port, starboard))
    assert [layout.suffix(t) for t in layout.thrusters] == ["_bow", "_starboard", "_starboard"]
    assert CATAMARAN.suffix(port) == ""


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"name": "port side"}, "letters, digits and _ only"),
        ({"command": CommandInput("command_1", 1500.0, 0.0)}, "command.span is 0"),
        ({"lag": 0.001}, "give 0 for none"),
        ({"dead_band": 1.0}, "dead_band is a share"),
        ({"curve": ThrustCurve.OPEN_WATER}, "add diameter"),
        ({"curve": ThrustCurve.KNOTS, "knots": (0.0, 1.0)}, "rising shares of full command through 0"),
        ({"same_as": "stern"}, "is no other thruster"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        ThrusterLayout((Thruster(**({"name": "aft", "x": -1.0, "y": 0.0, "command": COMMAND} | changes)),))  # type: ignore[arg-type]


def test_thrusters_that_share_coefficients_have_one_curve_and_a_leader() -> None:
    first = Thruster("a", 0.0, 0.0, COMMAND, curve=ThrustCurve.LINEAR)
    second = Thruster("b", 0.0, 0.0, COMMAND, same_as="a")
    with pytest.raises(InputError, match="different curves"):
        ThrusterLayout((first, second))
    third = Thruster("c", 0.0, 0.0, COMMAND, same_as="b")
    with pytest.raises(InputError, match="shares the coefficients of 'a'"):
        ThrusterLayout((Thruster("a", 0.0, 0.0, COMMAND), second, third))
    with pytest.raises(InputError, match="two thrusters are called 'a'"):
        ThrusterLayout((first, first))
    with pytest.raises(InputError, match=r"add a \[\[thruster\]\] block"):
        ThrusterLayout(())


def test_a_layout_belongs_to_the_model_with_thrusters() -> None:
    assert model_named("thrusters", CATAMARAN.text()).equation_hash == model_named("thrusters").equation_hash
    with pytest.raises(InputError, match="name the model 'thrusters'"):
        model_named("nomoto", CATAMARAN.text())
