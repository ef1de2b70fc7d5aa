"""Reversals and energy of an actuator, against a harmonic motion."""

import math

import pytest

from seatrial.physics.loops import ActuatorDrive, reversals_per_hour


def test_a_harmonic_turns_back_twice_a_period() -> None:
    omega = 0.8
    assert reversals_per_hour(omega, omega**2) == pytest.approx(2.0 * 3600.0 * omega / (2.0 * math.pi))


def test_a_reversal_costs_the_kinetic_energy_of_its_peak_over_the_efficiency() -> None:
    peak = 0.3
    assert ActuatorDrive(800.0, 0.8).energy(peak**2 / 2.0) == pytest.approx(0.5 * 800.0 * peak**2 / 0.8)
