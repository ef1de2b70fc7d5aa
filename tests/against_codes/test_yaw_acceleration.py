"""The yaw acceleration of waves against Capytaine 3.0: a box of 100 x 14 x 4 m at rest in deep water.

Yaw excitation (diffraction and Froude-Krylov) over moment of inertia, added inertia and radiation damping, of a box of
40 x 6 x 4 panels with a lid, mass even over its volume. The closed form knows no diffraction but the added mass and no
radiation: it is 2.5 to 6.1 % above in waves longer than the hull, and 6 % off either way in shorter ones.
"""

import math

import numpy as np
import pytest

from seatrial.physics.loops import YawAcceleration

OMEGA = np.array([0.3, 0.45, 0.6, 0.75, 0.9])
CAPYTAINE = {  # heading in degrees -> rad/s^2 per metre of wave
    30.0: np.array([3.369516e-4, 1.5548241e-3, 3.946907e-3, 6.1009214e-3, 4.82484e-3]),
    45.0: np.array([3.90958e-4, 1.8402743e-3, 4.9424039e-3, 8.7453360e-3, 9.9310581e-3]),
    135.0: np.array([3.90958e-4, 1.8402743e-3, 4.9424039e-3, 8.7453360e-3, 9.9310581e-3]),
}


@pytest.mark.parametrize("heading", list(CAPYTAINE))
def test_the_closed_form_is_within_seven_per_cent_of_the_panel_code(heading: float) -> None:
    size = np.abs(YawAcceleration(100.0, 4.0).amplitude(OMEGA, 0.0, math.radians(heading)))
    assert size == pytest.approx(CAPYTAINE[heading], rel=0.07)
