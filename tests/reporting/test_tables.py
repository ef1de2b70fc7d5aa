"""Sentences about signs are true for the model on the page."""

import pytest

from seatrial.core.equations import Model
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import waterjet
from seatrial.reporting.model_chapter import sign_conventions


def test_a_rudder_that_turns_to_port_is_declared_with_the_sign_of_the_records() -> None:
    text = sign_conventions(waterjet())
    assert "In these equations δ is positive when it turns the craft to port" in text
    assert "records, plots and tables give it positive to starboard" in text


@pytest.mark.parametrize("model", [nomoto(), abkowitz()])
def test_a_rudder_that_turns_to_starboard_is_said_once(model: Model) -> None:
    text = sign_conventions(model)
    assert "δ is positive when it turns the craft to starboard." in text and "port" not in text


def test_a_model_without_heading_and_rudder_has_no_sentence_on_them() -> None:
    assert sign_conventions(roll()) == "Axes: x forward, y to starboard, z down."
