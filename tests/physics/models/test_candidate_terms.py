"""Candidate terms: the model itself with two terms more, which change nothing while they are zero."""

import numpy as np
import pytest

from seatrial.physics.models import waterjet, with_candidate_terms, with_terms
from seatrial.physics.models.candidate_structures import structural_terms, with_second_order
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import CANDIDATE_TERMS, waterjet_candidates


def test_zero_candidates_change_nothing_and_values_are_kept() -> None:
    craft = waterjet().with_values({"m_y": 5000.0})
    wide = with_candidate_terms(craft)
    assert wide.parameters.free_names == (*craft.parameters.free_names, *CANDIDATE_TERMS)
    assert wide.parameters["m_y"].value == 5000.0
    state, inputs, rates = np.array([0.8, 0.1, 0.02, 0.0, 0.0, 0.0]), np.array([0.1, 1.866]), np.empty((2, 6))
    for model, row in zip((craft, wide), rates, strict=True):
        model.compiled.rates(0.0, state, inputs, model.parameters.values, row)
    assert rates[0] == pytest.approx(rates[1], rel=1e-14)
    assert waterjet_candidates().name != craft.name


def test_a_model_without_candidates_is_itself() -> None:
    assert with_candidate_terms(heave_pitch()) is heave_pitch() or with_candidate_terms(heave_pitch()) == heave_pitch()


def test_terms_that_the_model_lacks_come_held_at_zero() -> None:
    craft = waterjet()
    assert with_terms(craft, ("N_v", "m_y")) is craft
    wide = with_terms(craft, ("N_vrr",))
    assert wide.parameters.free_names == craft.parameters.free_names
    assert [wide.parameters[n].value for n in CANDIDATE_TERMS] == [0.0, 0.0]


def test_terms_of_a_family_are_those_of_its_structures_and_of_surge() -> None:
    assert {*CANDIDATE_TERMS, "m_x", "X_vr"} <= structural_terms("waterjet")
    assert {"b_3", "c_5"} <= structural_terms("roll")


def test_the_model_of_second_order_keeps_what_is_stated_of_the_first() -> None:
    first = nomoto().with_values({"U": 5.0, "T": 30.0})
    second = with_second_order(first.with_parameters(first.parameters.freed("alpha")))
    assert second.parameters["U"].value == 5.0 and second.parameters["T_1"].value == 30.0
    assert second.parameters.free_names == ("K", "T_1", "T_2", "T_3", "alpha")
    held = first.with_parameters(first.parameters.fixed("T"))
    assert with_second_order(second) is second and with_second_order(held) is held
