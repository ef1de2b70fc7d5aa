"""Waves much longer than the ship: what heave and pitch become in records (z down, theta bow up), and what not.

At midship the elevation is Re(exp(i omega_e t)), at x Re(exp(i (omega_e t - k x cos(beta)))); so heave up is 1 and
bow up is d zeta / dx = -i k cos(beta) for a hull that the wave carries.
"""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import G, encounter_frequency
from seatrial.physics.simulate.linear import Complex, frequency_response, linear_system
from seatrial_studies.seaway import SPEED, box_hull, ship

everywhere = pytest.mark.parametrize("heading", [0, 30, 60, 90, 120, 150, 180])
at_all_speeds = pytest.mark.parametrize("U", [0.0, 5.0, SPEED])
of_each_table = pytest.mark.parametrize("table", [90, 135, 180])


def recorded(model: Model, omega: Array, U: float, heading: int, shaken_at: Array) -> tuple[Complex, Complex]:
    """z [down] and theta [bow up] per metre under the wave's forces, the ship answering as at `shaken_at` [rad/s]."""
    forces = -np.stack(box_hull().forces(omega, U, math.radians(heading)), axis=1)
    driven = [model.input_names.index(name) for name in ("F3", "M5")]
    response = frequency_response(linear_system(model, ("z", "theta")), shaken_at)[:, :, driven]
    motion = np.einsum("kyu,ku->ky", response, forces)
    return motion[:, 0], motion[:, 1]


@everywhere
@at_all_speeds
@of_each_table
def test_heave_becomes_the_wave(heading: int, U: float, table: int) -> None:
    """In size, sign and phase; the damping left over is of first order in omega, so a tenth leaves a tenth."""
    omega = np.array([1e-3, 1e-4])
    z, _ = recorded(ship(table), omega, U, heading, encounter_frequency(omega, U, math.radians(heading)))
    error = np.abs(-z - 1.0)
    assert error[1] < 1e-4
    assert error[1] == pytest.approx(0.1 * error[0], rel=0.02)


@everywhere
@at_all_speeds
def test_what_restores_it_follows_height_and_slope(heading: int, U: float) -> None:
    """The static answer of the plant to the wave's forces: heave 1 and pitch the slope, abeam none."""
    omega = np.array([1e-3])
    z, theta = recorded(ship(180), omega, U, heading, np.zeros(1))
    k = omega[0] ** 2 / G
    assert abs(-z[0] - 1.0) < 1e-5
    assert abs(theta[0] / k + 1j * math.cos(math.radians(heading))) < 1e-4


@everywhere
@at_all_speeds
@of_each_table
def test_pitch_with_constant_damping_does_not_become_the_slope(heading: int, U: float, table: int) -> None:
    """The slope is of second order in omega, what constant b33 and b53 turn heave into is of first.

    Bow down theta -> -i omega_e (c33 b53 - c53 b33) / (c33 c55 - c35 c53) per metre of heave. Real damping vanishes at
    low frequency, and its part -U A33 is met by the diffraction; constants and a static force have neither.
    """
    model = ship(table)
    omega = np.array([1e-5])
    omega_e = encounter_frequency(omega, U, math.radians(heading))
    _, theta = recorded(model, omega, U, heading, omega_e)
    b33, b53, c33, c35, c53, c55 = (model.parameters[n].value for n in ("b33", "b53", "c33", "c35", "c53", "c55"))
    limit = 1j * omega_e[0] * (c33 * b53 - c53 * b33) / (c33 * c55 - c35 * c53)
    assert theta[0] == pytest.approx(limit, rel=2e-3)
    assert abs(theta[0]) > 1000.0 * omega[0] ** 2 / G
