"""Encounter: one wave in head seas, up to three in following seas, bad speeds and headings."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.sea.spectrum import speed_factor, wave_frequency


def test_the_wave_of_a_head_sea_is_found_and_that_of_a_following_sea_refused() -> None:
    omega = np.array([0.5, 1.0, 2.5])
    np.testing.assert_allclose(wave_frequency(encounter_frequency(omega, 9.26, 2.4), 9.26, 2.4), omega)
    with pytest.raises(InputError, match="three waves"):
        wave_frequency(omega, 9.26, 0.5)


@pytest.mark.parametrize(("U", "beta", "said"), [(-1.0, 1.0, "knots"), (60.0, 1.0, "knots"), (9.0, 90.0, "degrees")])
def test_speed_and_heading_out_of_sense_are_refused(U: float, beta: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        speed_factor(U, beta)
