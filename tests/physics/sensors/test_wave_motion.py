"""Wave motion in channels: which motion each shows, and how large a realisation of it comes out."""

import numpy as np
import pytest

from seatrial.physics.sensors.wave_motion import WaveMotion, motion_of, realised


def test_a_rate_shows_the_motion_of_its_angle() -> None:
    assert [motion_of(channel) for channel in ("psi", "r", "p", "q", "x0")] == ["psi", "psi", "phi", "theta", "x0"]
    states = WaveMotion(("psi", "u"), 2).shown_states(["r", "u", "psi", "v"], 3)
    np.testing.assert_array_equal(states, [[4, 8], [5, 9], [3, 7], [-1, -1]])


def test_a_realisation_has_the_size_asked_for_and_an_angle_and_its_rate_are_of_one_motion() -> None:
    rms, frequency, time = {"psi": 0.02, "r": 0.015, "v": 0.3}, 0.8, 0.1 * np.arange(40000)
    made = realised(rms, frequency, 0.1, time, np.random.default_rng(2))
    assert {channel: float(np.std(values)) for channel, values in made.items()} == pytest.approx(rms, rel=0.1)
    assert np.corrcoef(np.gradient(made["psi"], time), made["r"])[0, 1] > 0.99  # differences of a rate with white kicks
    assert abs(np.corrcoef(made["psi"], made["v"])[0, 1]) < 0.2
