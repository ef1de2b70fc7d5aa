"""Waves that force a craft to yaw under autopilot: its coefficients come out, and what the waves are."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.physics.models.nomoto import nomoto

Array = NDArray[np.float64]
K, T, DT, ROWS = 0.09, 11.0, 0.5, 1800
OMEGA, ZETA, RMS = 0.8, 0.1, np.radians(1.0)  # of the yaw that the waves cause
NOISE = np.radians([0.05, 0.1])  # of heading [rad] and yaw rate [rad/s]


def steered(seed: int) -> Record:
    """Heading steps under a PD autopilot that answers the waves, exact from sample to sample (Van Loan 1978).

    States xi, eta, r, psi: r' = (K delta - r) / T + eta, xi'' + 2 zeta omega xi' + omega^2 xi = noise; the rudder runs
    straight between samples.
    """
    rng = np.random.default_rng(seed)
    A = np.zeros((6, 6))  # the rudder and its rate behind the states
    A[0, 1], A[1, :2] = 1.0, [-(OMEGA**2), -2.0 * ZETA * OMEGA]
    A[2, 1], A[2, 2], A[2, 4], A[3, 2], A[4, 5] = 1.0, -1.0 / T, K / T, 1.0, 1.0
    noise = np.zeros((4, 4))
    noise[1, 1] = 4.0 * ZETA * OMEGA**3 * (OMEGA * RMS) ** 2
    phi, block = expm(A * DT), expm(np.block([[-A[:4, :4], noise], [np.zeros((4, 4)), A[:4, :4].T]]) * DT)
    kick = np.linalg.cholesky(block[4:, 4:].T @ block[:4, 4:] + 1e-18 * np.eye(4))  # for rounding
    x, delta, slow, goal = np.zeros(4), 0.0, 0.0, 0.0
    x[:2] = OMEGA * RMS * np.array([1.0, OMEGA]) * rng.standard_normal(2)  # stationary
    rows = np.empty((ROWS, 3))
    for k in range(ROWS):
        shown = x[[3, 2]] + NOISE * rng.standard_normal(2)
        rows[k] = [delta, *shown]
        goal += np.radians(rng.choice([-20.0, 20.0])) if k % 120 == 20 else 0.0
        slow += (1.0 - np.exp(-DT / 2.0)) * (shown[1] - slow)
        order = np.clip(1.0 * (goal - shown[0]) - 5.0 * slow, -0.4, 0.4)
        rate = np.clip((order - delta) / DT, -0.1, 0.1)
        x = phi[:4, :4] @ x + phi[:4, 4] * delta + phi[:4, 5] * rate + kick @ rng.standard_normal(4)
        delta += rate * DT
    return Record.from_arrays("run", DT * np.arange(ROWS), dict(zip(("delta", "psi", "r"), rows.T, strict=True)))


@pytest.fixture(scope="module")
def estimation() -> Estimation:
    return estimate_model(nomoto(), Runs.one_session_each([steered(3)], 40.0), options=EstimatorOptions(workers=1))


def test_the_coefficients_are_those_of_the_craft(estimation: Estimation) -> None:
    error = estimation.estimate.common_parameters[:2] - [K, T]
    assert np.all(np.abs(error) < 2.5 * estimation.interval.standard_error[:2])
    assert np.all(estimation.interval.standard_error[:2] < [0.05 * K, 0.15 * T])


def test_the_waves_are_found_and_said(estimation: Estimation) -> None:
    noise = estimation.noise_model
    (waves,) = noise.waves
    assert noise.disturbance == "waves forcing r"
    assert waves.frequency == pytest.approx(OMEGA, rel=0.1)
    assert waves.rms["psi"] == pytest.approx(RMS, rel=0.3)
    assert waves.rms["r"] == pytest.approx(OMEGA * RMS, rel=0.3)
    assert noise.wave_cost is not None and noise.wave_cost > 1.0
    assert noise.measurement["psi"] == pytest.approx(np.hypot(waves.rms["psi"], NOISE[0]), rel=0.1)
