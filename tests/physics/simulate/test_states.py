"""States of a model along a record: as measured, derived where they follow from others, refused where they do not."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.models import model_named
from seatrial.physics.simulate.states import hidden_states, measured_states, unobserved_states

TIME = np.arange(0.0, 20.0, 0.1)
RATE = 0.05  # yaw rate of the record [rad/s]


def turning(**channels: np.ndarray) -> Record:
    """A record that turns steadily."""
    return Record.from_arrays("turn", TIME, {"psi": RATE * TIME, "delta": np.full(len(TIME), 0.1), **channels})


def test_yaw_rate_follows_from_heading() -> None:
    model = model_named("nomoto")
    assert unobserved_states(model, turning()) == ()
    states = measured_states(model, turning())
    np.testing.assert_allclose(states[:, model.states.index("r")], RATE, rtol=1e-9)
    np.testing.assert_allclose(states[:, model.states.index("psi")], RATE * TIME)


def test_body_velocities_follow_from_track_and_heading() -> None:
    model = model_named("waterjet")
    record = turning(x0=np.sin(RATE * TIME) / RATE, y0=(1.0 - np.cos(RATE * TIME)) / RATE)
    states = measured_states(model, record)
    inner = slice(10, -10)
    np.testing.assert_allclose(states[inner, model.states.index("u")], 1.0, atol=1e-4)
    np.testing.assert_allclose(states[inner, model.states.index("v")], 0.0, atol=1e-4)


def test_a_state_that_nothing_implies_is_named() -> None:
    model = model_named("waterjet")
    assert set(unobserved_states(model, turning())) == {"u", "v"}
    with pytest.raises(InputError, match="neither holds nor implies 'u'"):
        measured_states(model, turning())


def test_a_state_of_no_instrument_is_hidden() -> None:
    assert hidden_states(model_named("nomoto2"), [turning()]) == ("r_rest",)


def test_a_state_at_rest_has_its_parameter() -> None:
    assert model_named("roll").rest_parameter("phi") == "phi_0"
    assert model_named("roll").rest_parameter("p") == "" and model_named("nomoto").rest_parameter("delta") == ""
