"""Thrust of the B series against its chart and against the open-water curves of two tankers."""

import numpy as np
import pytest

from seatrial.physics.hydro.empirical import thrust_coefficient, thrust_quadratic
from seatrial.physics.models.published import ParameterSet, esso_osaka, kvlcc2_l7


def test_the_quadratic_is_the_series_within_a_hundredth() -> None:
    J = np.linspace(0.0, 0.6, 13)
    for pitch_ratio in (0.6, 0.8, 1.0):
        k = thrust_quadratic(pitch_ratio, 0.55, 4)
        quadratic = k[0] + k[1] * J + k[2] * J**2
        np.testing.assert_allclose(quadratic, thrust_coefficient(J, pitch_ratio, 0.55, 4), atol=2e-3)


@pytest.mark.parametrize(
    ("ship", "pitch_ratio", "area_ratio", "blades"), [(kvlcc2_l7(), 0.721, 0.431, 4), (esso_osaka(), 0.715, 0.682, 5)]
)
def test_published_propellers_are_near(ship: ParameterSet, pitch_ratio: float, area_ratio: float, blades: int) -> None:
    """P/D, A_E/A_0 and blades of KVLCC2 (SIMMAN 2008) and Esso Osaka (Crane 1979); K_T of their MMG models."""
    J = np.linspace(0.0, 0.4, 9)
    published = ship.values["k_0"] + ship.values["k_1"] * J + ship.values["k_2"] * J**2
    np.testing.assert_allclose(thrust_coefficient(J, pitch_ratio, area_ratio, blades), published, rtol=0.09)


def test_more_pitch_gives_more_thrust() -> None:
    low, high = (thrust_coefficient(np.array([0.3]), pitch, 0.5, 4)[0] for pitch in (0.6, 1.0))
    assert 0.0 < low < high
