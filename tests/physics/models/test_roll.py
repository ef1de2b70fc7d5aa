"""Free roll: energy falls by what damping takes, and known coefficients come back from noise."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.settings import dominant_period
from seatrial.estimation.identify import estimate_model
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.roll import roll
from seatrial.physics.simulate.replay import inputs_of, trajectory

TRUE = {"b_1": 0.03, "b_2": 0.2, "b_3": 0.1, "c_1": 4.0, "c_3": 6.0, "c_5": -20.0, "phi_0": 0.01}
DT, ROWS = 0.05, 1600


def decayed(noise: float = 0.0) -> Record:
    """Released at 20 deg; only the angle is measured."""
    states, _ = trajectory(roll().with_values(TRUE), np.zeros((ROWS, 2)), DT, np.array([0.35, 0.0]))
    phi = states[:, 0] + noise * np.random.default_rng(1).standard_normal(ROWS)
    return Record.from_arrays("decay", DT * np.arange(ROWS), {"phi": phi})


def test_energy_falls_by_the_work_of_damping() -> None:
    """d/dt (p^2/2 + potential) = -(b_1 p^2 + b_2 |p|^3 + b_3 p^4)."""
    states, _ = trajectory(roll().with_values(TRUE), np.zeros((ROWS, 2)), DT, np.array([0.35, 0.0]))
    phi, p = states[:, 0] - TRUE["phi_0"], states[:, 1]
    energy = p**2 / 2 + TRUE["c_1"] * phi**2 / 2 + TRUE["c_3"] * phi**4 / 4 + TRUE["c_5"] * phi**6 / 6
    power = TRUE["b_1"] * p**2 + TRUE["b_2"] * np.abs(p) ** 3 + TRUE["b_3"] * p**4
    work = np.concatenate([[0.0], np.cumsum(0.5 * DT * (power[1:] + power[:-1]))])
    np.testing.assert_allclose(energy, energy[0] - work, atol=2e-4 * energy[0])


@pytest.mark.parametrize(("channel", "per_radian"), [("alpha_w", 1.0), ("alpha_f", 0.256)])
def test_a_held_slope_heels_it_to_its_own_side(channel: str, per_radian: float) -> None:
    """To the angle itself in a wave slope held long; to K_alpha times the angle of fins."""
    ship = roll().with_values({"b_1": 1.0, "c_1": 4.0, "K_alpha": 0.256})
    slope = Record.from_arrays("held", DT * np.arange(ROWS), {channel: np.full(ROWS, 0.05)})
    states, _ = trajectory(ship, inputs_of(ship, slope), DT, np.zeros(2))
    assert states[-1, 0] == pytest.approx(per_radian * 0.05, rel=1e-6)


def test_forced_rolling_is_that_of_the_transfer_function() -> None:
    """1 / (T^2 s^2 + 2 zeta T s + 1), Yu et al. 2014, driven at resonance: amplitude 1 / (2 zeta)."""
    T, damping = np.sqrt(1.43242), 0.3796
    ship = roll().with_values({"b_1": damping / T**2, "c_1": 1.0 / T**2})
    time = 0.02 * np.arange(8000)
    wave = Record.from_arrays("wave", time, {"alpha_w": 0.02 * np.cos(time / T)})
    states, _ = trajectory(ship, inputs_of(ship, wave), 0.02, np.zeros(2))
    assert np.abs(states[-1000:, 0]).max() == pytest.approx(0.02 * T / damping, rel=1e-3)


def test_coefficients_come_back_without_a_guess() -> None:
    """From the angle alone, exact without noise; within four standard errors of .05 deg of it."""
    exact = estimate_model(roll(), Runs.one_session_each([decayed()], 5.0))
    np.testing.assert_allclose(exact.estimate.common_parameters[:7], list(TRUE.values()), rtol=1e-6)
    noisy = estimate_model(roll(), Runs.one_session_each([decayed(np.radians(0.05))], 5.0))
    wrong = np.abs(noisy.estimate.common_parameters[:7] - list(TRUE.values())) / noisy.interval.standard_error[:7]
    assert wrong.max() < 4.0


def test_the_period_is_that_of_the_swing() -> None:
    """Within a per cent of 2 pi / sqrt(c_1) at small angles; nothing that stands still has one."""
    time = DT * np.arange(ROWS)
    assert dominant_period(0.1 * np.cos(2.0 * time) + 0.3, DT) == pytest.approx(np.pi, rel=0.01)
    with pytest.raises(InputError, match="never swings"):
        dominant_period(np.ones(50), DT)


def test_only_ships_without_heading_and_speed_swing() -> None:
    """A steered ship does not, whatever its model."""
    assert not roll().has_course
    assert not heave_pitch().has_course
    assert nomoto().has_course
