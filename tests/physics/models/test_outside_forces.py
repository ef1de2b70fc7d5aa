"""Forces from outside add to the craft's own; the matrices of its equations are those that its rates have."""

import numpy as np
import pytest
from tests.control.station.station_cases import craft, cross_drive

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models.thrust_orders import (
    OUTSIDE_FORCES,
    inertia_matrix,
    thrust_configuration,
    with_outside_forces,
)

STATE = {"u": 0.4, "v": -0.2, "r": 0.3}


def accelerations(model: Model, inputs: Array) -> Array:
    state, rates = np.zeros(len(model.states)), np.empty(len(model.states))
    for name, value in STATE.items():
        state[model.states.index(name)] = value
    model.compiled.rates(0.0, state, inputs, model.parameters.values, rates)
    return rates[[model.states.index(name) for name in STATE]]


def test_a_force_from_outside_accelerates_mass_and_added_mass() -> None:
    model = cross_drive()
    pushed, inputs = with_outside_forces(model), np.zeros(len(model.input_names))
    assert pushed.input_names[-3:] == OUTSIDE_FORCES
    force = np.array([5.0, -3.0, 2.0])
    change = accelerations(pushed, np.concatenate([inputs, force])) - accelerations(model, inputs)
    assert inertia_matrix(model) @ change == pytest.approx(force)


def test_the_configuration_is_that_of_places_and_angles() -> None:
    """At (0.45, -0.35), 45 degrees to starboard: arm 0.45 sin + 0.35 cos."""
    own = craft(cross_drive())
    B = thrust_configuration(own.model, own.thrusters[:1], [np.pi / 4.0])
    assert B[:, 0] == pytest.approx(np.sqrt(0.5) * np.array([1.0, 1.0, 0.8]))
    assert own.model.parameters.value_of("no_such", 0.0) == 0.0
