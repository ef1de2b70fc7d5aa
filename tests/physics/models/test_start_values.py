"""Heave and pitch start from mass, inertia and stiffness; other models keep the values they come with."""

import math

import pytest

from seatrial.core.values import InputError, Ship
from seatrial.physics.models import model_named
from seatrial.physics.models.published import START_DAMPING_RATIO, physical_start_values, with_start_values
from seatrial.physics.models.registry import model_summaries

SHIP = Ship("ship", {"m": 4.42e5, "I5": 9.945e7, "c33": 3.15e6, "c55": 6.54e8, "c35": 6.83e6, "c53": 6.83e6})


def test_the_start_has_the_damping_ratio_it_names() -> None:
    start = physical_start_values(dict(SHIP.particulars))
    mass, stiffness = SHIP.particulars["m"] + start["a33"], SHIP.particulars["c33"]
    assert start["a33"] == SHIP.particulars["m"] and start["a35"] == 0.0
    assert start["b33"] / (2.0 * math.sqrt(stiffness * mass)) == pytest.approx(START_DAMPING_RATIO)


def test_only_values_that_are_missing_are_filled() -> None:
    model = model_named("heave_pitch")
    filled = with_start_values(model.with_values(dict(SHIP.particulars) | {"a33": 1.0e5}), SHIP)
    assert filled.parameters["a33"].value == 1.0e5
    assert filled.parameters["a55"].value == SHIP.particulars["I5"]


def test_a_model_with_values_of_its_own_is_left_alone() -> None:
    model = model_named("nomoto")
    assert with_start_values(model, SHIP) is model


def test_every_built_in_model_is_summarised_with_states_inputs_and_source() -> None:
    summaries = {summary.name: summary for summary in model_summaries()}
    assert summaries["waterjet"].states == model_named("waterjet").states
    assert all(s.states and s.inputs and s.source for s in summaries.values() if not s.package)


@pytest.mark.parametrize("name", ["m", "I5", "c33", "c55"])
def test_mass_and_stiffness_that_are_not_positive_are_refused_by_name(name: str) -> None:
    absurd = dict(SHIP.particulars) | {name: -SHIP.particulars[name]}
    with pytest.raises(InputError, match=f"^{name} = -.* is not positive"):
        with_start_values(model_named("heave_pitch").with_values(absurd), Ship("ship", absurd))
