"""Waves that move the compass: the manoeuvre's model comes out, and what the waves are. By a simulator of this file."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.disturbance_models import with_waves_only
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.physics.models.nomoto import nomoto

Array = NDArray[np.float64]
K, T, DT, ROWS, FINE = 0.09, 11.0, 1.0, 700, 4
OMEGA, ZETA, RMS = 0.8, 0.1, np.radians(0.5)
GUST, MEMORY = 2e-4, 8.0  # rad/s^2 rms, s
NOISE = np.radians(0.1)


def narrow_band(rng: np.random.Generator, rows: int) -> Array:
    """Displacement and rate of a stationary second-order process, exact from sample to sample, (rows, 2)."""
    phi = expm(DT * np.array([[0.0, 1.0], [-(OMEGA**2), -2.0 * ZETA * OMEGA]]))
    stationary = RMS**2 * np.diag([1.0, OMEGA**2])
    kick = np.linalg.cholesky(stationary - phi @ stationary @ phi.T)
    state, rows_of = np.linalg.cholesky(stationary) @ rng.standard_normal(2), np.empty((rows, 2))
    for row in rows_of:
        row[:] = state
        state = phi @ state + kick @ rng.standard_normal(2)
    return rows_of


def in_waves(seed: int, gusts: float = GUST, memory: float = MEMORY) -> Record:
    """Rudder steps at 3 deg/s, Markov gusts, waves on a compass of 0.1 deg; a quarter of a sample is a step.

    gusts: rad/s^2, rms; memory: of them [s].
    """
    rng, h = np.random.default_rng(seed), DT / FINE
    order = np.radians(np.repeat(rng.choice([-20.0, -10.0, 10.0, 20.0], ROWS // 35), 35))
    delta = np.zeros(ROWS)
    for k in range(1, ROWS):
        delta[k] = delta[k - 1] + np.clip(order[k] - delta[k - 1], -np.radians(3.0) * DT, np.radians(3.0) * DT)
    keep, decay = np.exp(-h / memory), np.exp(-h / T)
    fine = np.interp(h * (np.arange(FINE * ROWS) + 0.5), DT * np.arange(ROWS), delta)
    r = psi = gust = 0.0
    heading = np.empty(ROWS)
    for k, rudder in enumerate(fine):
        if k % FINE == 0:
            heading[k // FINE] = psi
        rest = K * rudder + T * gust
        psi, r = psi + rest * h + (r - rest) * T * (1.0 - decay), rest + (r - rest) * decay
        gust = keep * gust + np.sqrt(1.0 - keep**2) * gusts * rng.standard_normal()
    shown = heading + narrow_band(rng, ROWS)[:, 0] + NOISE * rng.standard_normal(ROWS)
    return Record.from_arrays("run", DT * np.arange(ROWS), {"delta": delta, "psi": shown})


@pytest.fixture(scope="module")
def estimation() -> Estimation:
    return estimate_model(nomoto(), Runs.one_session_each([in_waves(7)], 40.0), options=EstimatorOptions(workers=1))


def test_the_coefficients_are_those_of_the_manoeuvre(estimation: Estimation) -> None:
    error = estimation.estimate.common_parameters[:2] / [K, T] - 1.0
    assert np.all(np.abs(error) < [0.05, 0.10])
    assert np.all(np.abs(error * [K, T]) < 3.0 * estimation.interval.standard_error[:2])
    assert np.all(estimation.interval.standard_error[:2] < [0.05 * K, 0.10 * T])
    assert estimation.whiteness.is_white


def test_the_waves_are_found_and_said(estimation: Estimation) -> None:
    noise = estimation.noise_model
    (waves,) = noise.waves
    assert noise.disturbance == "first-order Markov on r and waves on the sensors"
    assert waves.frequency == pytest.approx(OMEGA, rel=0.1)
    assert waves.rms["psi"] == pytest.approx(RMS, rel=0.25)
    assert noise.measurement["psi"] == pytest.approx(np.hypot(RMS, NOISE), rel=0.25)
    assert noise.wave_cost is not None and noise.wave_cost >= 1.0
    assert noise.wave_sentences[0].startswith("Waves of 7") or noise.wave_sentences[0].startswith("Waves of 8")


def test_a_peak_that_is_none_leaves_the_gusts_beside_it(estimation: Estimation) -> None:
    """Without its peak the disturbance is gusts alone, as likely as with a peak that moves nothing."""
    noise, local = estimation.process_noise, np.zeros((0, 0))
    assert noise is not None
    alone = with_waves_only(noise, [False])
    problem, still = noise.problem, noise.optimum.solution.point.copy()
    still[problem.runs.size + len(problem.process) + 2] = 0.0  # the variance of psi, after frequency and damping
    assert alone.name == "first-order Markov on r"
    assert alone.unknown_count == 2
    assert alone.cost == pytest.approx(problem.cost(still, local), rel=1e-9)
    assert with_waves_only(noise, [True]).cost == pytest.approx(noise.optimum.normal.cost, rel=1e-9)


def test_gusts_that_lead_output_error_astray_are_searched_from_elsewhere() -> None:
    """They move the craft as far as the rudder does: from the coefficients of whole runs no waves are found."""
    record = in_waves(4, gusts=2e-3, memory=20.0)
    estimation = estimate_model(nomoto(), Runs.one_session_each([record], 40.0), options=EstimatorOptions(workers=1))
    away = estimation.estimate.common_parameters[:2] - [K, T]
    assert estimation.noise_model.disturbance == "first-order Markov on r and waves on the sensors"
    assert np.all(np.abs(away) < 3.0 * estimation.interval.standard_error[:2])
