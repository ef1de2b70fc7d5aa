"""Coefficients that were not fitted are a baseline only where something is known of all of them."""

from dataclasses import replace

from seatrial.core.equations import Model
from seatrial.core.values import Parameters, Prior
from seatrial.estimation.predict.window_scores import prior_means
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.sensors import Compass, Sensors, with_sensors


def with_priors(model: Model, names: set[str]) -> Model:
    """The model with a prior about the value of each of these coefficients."""
    known = (replace(p, prior=Prior(p.value, 0.5)) if p.name in names else p for p in model.parameters)
    return replace(model, parameters=Parameters(tuple(known)))


def test_priors_of_instruments_alone_are_no_knowledge_of_a_craft() -> None:
    craft = thrusters()
    measured = with_sensors(craft, Sensors(compass=Compass.HARMONIC))
    assert any(p.prior is not None for p in measured.parameters.free)
    assert prior_means(measured) == {}


def test_some_priors_beside_start_values_are_no_published_craft() -> None:
    assert prior_means(with_priors(thrusters(), {"M_v", "Y_v"})) == {}


def test_priors_of_all_coefficients_are_a_craft_that_was_not_fitted() -> None:
    craft = thrusters()
    free = set(craft.parameters.free_names)
    measured = with_sensors(with_priors(craft, free), Sensors(compass=Compass.OFFSET))
    assert prior_means(measured) == {n: craft.parameters[n].value for n in free} | {"compass_A": 0.0}
