"""The steering model of the other sign: a ship that turns by itself."""

from seatrial.physics.models.candidate_structures import course_unstable
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.waterjet import waterjet


def test_only_a_steering_model_of_open_signs_has_an_unstable_twin() -> None:
    assert course_unstable(waterjet()) is waterjet()
    held = nomoto().with_parameters(nomoto().parameters.fixed("K"))
    assert course_unstable(held) is held
    for model, slow in ((nomoto(), "T"), (nomoto2(), "T_1")):
        twin = course_unstable(model).parameters
        assert (twin["K"].value, twin[slow].value) == (-model.parameters["K"].value, -model.parameters[slow].value)
