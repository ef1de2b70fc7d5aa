"""A loop's record: scipy's simulation of the same states, and the variances of the spectrum where it is white."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from scipy.signal import lsim

from seatrial.core.values import InputError
from seatrial.physics.loops import fin_loop, state_space
from seatrial.physics.simulate.closed_loop import loop_record

LOOP = fin_loop()
STATES = state_space(LOOP)
GAINS = LOOP.gain_values


def test_output_and_actuator_are_those_of_lsim() -> None:
    disturbance = np.random.default_rng(0).standard_normal(1500)
    rows = np.stack([STATES.c, STATES.actuator_row(GAINS)])
    system = (STATES.closed_loop_matrix(GAINS), STATES.b[:, None], rows, np.zeros((2, 1)))
    _, wanted, _ = lsim(system, disturbance, 0.1 * np.arange(1500), interp=False)
    made = loop_record(STATES, GAINS, disturbance, 0.1)[:, :2]
    assert np.abs(made - wanted).max() < 1e-10 * np.abs(wanted).max()


def test_the_rate_is_the_slope_of_the_actuator() -> None:
    disturbance = np.repeat(np.random.default_rng(1).standard_normal(40), 500)
    made = loop_record(STATES, GAINS, disturbance, 0.001)
    slope = (made[2:, 1] - made[:-2, 1]) / 0.002
    assert np.abs(slope - made[1:-1, 2]).max() < 1e-3 * np.abs(slope).max()


def test_variances_in_white_noise_are_those_of_lyapunov() -> None:
    dt = 0.1
    disturbance = np.random.default_rng(2).standard_normal(200_000)
    A, row = STATES.closed_loop_matrix(GAINS), STATES.actuator_row(GAINS)
    P = solve_continuous_lyapunov(A, -dt * np.outer(STATES.b, STATES.b))
    wanted = [STATES.c @ P @ STATES.c, row @ P @ row]
    assert loop_record(STATES, GAINS, disturbance, dt)[:, :2].var(axis=0) == pytest.approx(wanted, rel=0.05)


def test_a_disturbance_with_gaps_is_refused() -> None:
    with pytest.raises(InputError, match="without gaps"):
        loop_record(STATES, GAINS, np.array([0.0, np.nan, 1.0]), 0.1)
