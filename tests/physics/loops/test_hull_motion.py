"""Motions of a hull as what disturbs a loop: against the equations solved as a matrix, and against single waves."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.hydro.excitation import BoxHull, encounter_frequency
from seatrial.physics.loops import Block
from seatrial.physics.loops.encounter_spectrum import ForcedMotion, HullMotion, refuse_unknown_sea
from seatrial.physics.sea.spectrum import ittc

U, BETA = 9.26, math.radians(135.0)
BOX = BoxHull(60.0, 7.137, 2.27, 3.15e6, 6.83e6, 6.83e6, 6.54e8)
HEAVE = ForcedMotion(Block("", (-1e-6,), (1.0, 1.0, 3.0)), Block("", (-1e-9, -2e-9), (1.0, 1.0, 3.0)))
PITCH = ForcedMotion(Block("", (2e-9,), (1.0, 1.5, 4.0)), Block("", (-5e-9,), (1.0, 1.5, 4.0)))


def at(x: float) -> HullMotion:
    return HullMotion(BOX, HEAVE, PITCH, 1.0, -x)


def test_the_motion_is_that_of_the_forces_at_the_signed_frequency_of_encounter() -> None:
    """In following seas too, where the ship overtakes short waves and the motion is the conjugate of one met."""
    omega = np.linspace(0.2, 2.0, 40)
    for beta in (BETA, math.radians(20.0)):
        s, (F3, M5) = 1j * encounter_frequency(omega, U, beta), BOX.forces(omega, U, beta)
        heave = (-1e-6 * F3 + (-1e-9 * s - 2e-9) * M5) / (s**2 + s + 3.0)
        pitch = (2e-9 * F3 - 5e-9 * M5) / (s**2 + 1.5 * s + 4.0)
        np.testing.assert_allclose(at(20.0).amplitude(omega, U, beta), heave - 20.0 * pitch, rtol=1e-12)


def test_nothing_moves_where_the_forces_are_not_known() -> None:
    lower, upper = at(0.0).frequency_range
    assert lower == 0.0
    assert upper == pytest.approx(math.sqrt(9.80665 / 2.27), rel=1e-3)
    assert not np.any(at(0.0).amplitude(np.array([1.01, 2.0]) * upper, U, BETA))


def test_a_sea_of_short_waves_is_refused() -> None:
    refuse_unknown_sea(BOX, ittc(1.5))
    with pytest.raises(InputError, match="where the sea has 81 % of its energy"):
        refuse_unknown_sea(BOX, ittc(0.88))
