"""Augmented models: the same motion where nothing drives the new states, and what drives them where something does."""

import numpy as np
import pytest

from seatrial.core.equations.augment import (
    band_names,
    bias_name,
    biased_name,
    force_peaks,
    gust_name,
    is_biased,
    lagged_name,
    wave_names,
    with_biases,
    with_gusts,
    with_lags,
    with_wave_forces,
)
from seatrial.core.values import InputError
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.sensors.settings import Antenna
from seatrial.physics.simulate.replay import trajectory

DT, ROWS = 0.1, 200
INPUTS = 0.3 * np.sin(0.1 * np.arange(ROWS))[:, None]


def test_a_gust_pushes_and_fades() -> None:
    """With r' = gust and nothing else, r = g0 tau (1 - exp(-t / tau)): damping and rudder switched off by T."""
    model = with_gusts(nomoto().with_values({"T": 1e12}), {"r": 2.0})
    assert model.states[-1] == gust_name("r") == "gust_r"
    start = np.zeros(5)
    start[-1] = 0.01
    states, _ = trajectory(model, 0.0 * INPUTS, DT, start)
    time = DT * np.arange(ROWS)
    np.testing.assert_allclose(states[:, -1], 0.01 * np.exp(-time / 2.0), rtol=1e-6)
    np.testing.assert_allclose(states[:, 0], 0.02 * (1.0 - np.exp(-time / 2.0)), atol=1e-8)


def test_biases_are_added_to_what_is_read() -> None:
    model = with_biases(nomoto().with_values({"U": 1.0}), ("x0", "y0"), 5.0)
    assert model.outputs[-2:] == (biased_name("x0"), biased_name("y0"))
    assert [is_biased(o) for o in (*model.outputs, "x0")] == [True, True, False]
    start = np.zeros(6)
    start[4:] = 3.0, -4.0
    states, outputs = trajectory(model, INPUTS, DT, start)
    assert model.states[4:] == (bias_name("x0"), bias_name("y0"))
    left = np.exp(-DT * np.arange(ROWS) / 5.0)
    np.testing.assert_allclose(states[:, 4:], left[:, None] * [3.0, -4.0], rtol=1e-5)
    np.testing.assert_allclose(outputs[:, -2:], states[:, 2:4] + states[:, 4:], rtol=1e-14)


def test_a_bias_is_added_to_what_the_instrument_shows() -> None:
    craft = with_sensors(nomoto().with_values({"U": 1.0}), Sensors(antenna=Antenna(2.0, 0.0)))
    model = with_biases(craft, ("x0", "y0"), 5.0)
    start = np.zeros(6)
    start[4:] = 3.0, -4.0
    states, outputs = trajectory(model, INPUTS, DT, start)
    arm = 2.0 * np.stack([np.cos(states[:, 1]), np.sin(states[:, 1])], axis=1)
    np.testing.assert_allclose(outputs[:, -2:], states[:, 2:4] + states[:, 4:] + arm, rtol=1e-12)


def test_a_lagging_channel_follows() -> None:
    model = with_lags(nomoto(), ("r",), 0.5)
    states, _ = trajectory(model, INPUTS, DT, np.zeros(5))
    late = states[:, model.states.index(lagged_name("r"))]
    np.testing.assert_allclose(0.5 * np.gradient(late, DT)[1:-1], (states[:, 0] - late)[1:-1], atol=2e-5)


@pytest.mark.parametrize(
    "more",
    [
        lambda m: with_gusts(m, {"r": 1.0}),
        lambda m: with_lags(m, ("r",), 1.0),
    ],
)
def test_twice_the_same_is_refused(more) -> None:
    with pytest.raises(InputError, match="already"):
        more(more(nomoto()))


def test_equations_written_twice_share_their_machine_code() -> None:
    """A search writes the same augmented model hundreds of times; code loaded each time would never be freed."""
    once, again = (with_gusts(nomoto(), {"r": memory}) for memory in (3.0, 5.0))
    assert once.equations is not again.equations
    assert once.compiled is again.compiled


def test_wave_forces_at_two_peaks_have_their_own_states() -> None:
    model = with_wave_forces(with_wave_forces(nomoto(), ("r",), 1, 0.8, 0.1), ("r",), 2, 0.4, 0.05)
    assert force_peaks(nomoto()) == 0 and force_peaks(model) == 2
    assert {name for peak in (1, 2) for name in wave_names("r", peak)} < set(model.states)
    assert [model.parameters[name].value for name in band_names(2)] == [0.4, 0.05]
