"""Waves of the training runs on a simulated record: what a model file keeps of them, and how large they come out."""

import numpy as np
import pytest

import seatrial as st
from seatrial import api
from seatrial.core.results import Waves
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile, model_text, parse_model
from seatrial.physics.models.nomoto import nomoto

SEA = Waves(0.8, 0.1, {"psi": 0.01, "r": 0.008})


def test_a_model_file_keeps_its_waves() -> None:
    file = ModelFile(nomoto(), waves=(SEA,))
    assert parse_model(model_text(file), "file in memory").waves == (SEA,)


def test_sensors_show_the_waves_and_the_craft_does_not_move_otherwise() -> None:
    file = ModelFile(nomoto().with_values({"U": 5.0}), waves=(SEA,))
    calm, moved = (
        st.simulate(file, "zigzag:20/20", speed=5.0, duration=2000.0, waves=w, seed=3) for w in (False, True)
    )
    assert np.std(moved["psi"] - calm["psi"]) == pytest.approx(0.01, rel=0.3)
    assert np.std(moved["r"] - calm["r"]) == pytest.approx(0.008, rel=0.3)
    slope = np.gradient(moved["psi"] - calm["psi"], calm.dt)
    assert np.corrcoef(slope, moved["r"] - calm["r"])[0, 1] > 0.99, "an angle and its rate show one motion"
    np.testing.assert_array_equal(moved["x0"], calm["x0"])


def test_without_waves_there_is_nothing_to_add() -> None:
    with pytest.raises(InputError, match="showed no waves"):
        api.in_waves(nomoto(), st.simulate(ModelFile(nomoto()), "zigzag:20/20", speed=5.0, duration=60.0))
