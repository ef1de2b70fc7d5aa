"""What an output-error estimate is worth where noise in the states disturbs the motion it is made from."""

from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.intervals import MEANING, process_noise_interval
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import NoiseEvidence, ProcessNoise, implied_process_noise
from seatrial.physics.models.roll import roll

DT, ROWS, FINE = 0.05, 1200, 4
B, C, START, SENSOR = 0.06, 6.0, 0.2, 2e-4


def linear() -> Model:
    """Roll with linear damping and restoring free."""
    model = roll().with_values({"b_1": 0.1, "c_1": 5.0})
    return model.with_parameters(model.parameters.fixed("b_2", "b_3", "c_3", "c_5", "phi_0"))


def disturbed_decay(intensity: float, rng: np.random.Generator) -> Record:
    """A linear decay whose rate is disturbed by white noise, by its exact propagator over quarters of a sample."""
    h = DT / FINE
    omega = np.sqrt(C - 0.25 * B**2)
    at = np.exp(-0.5 * B * h)
    c, s = np.cos(omega * h), np.sin(omega * h)
    step = at * np.array([[c + 0.5 * B * s / omega, s / omega], [-C * s / omega, c - 0.5 * B * s / omega]])
    x, phi = np.array([START, 0.0]), np.empty(ROWS)
    for k in range(ROWS * FINE):
        if k % FINE == 0:
            phi[k // FINE] = x[0]
        x = step @ x + np.array([0.0, intensity * np.sqrt(h)]) * rng.standard_normal()
    return Record.from_arrays("decay", np.arange(0.0, ROWS) * DT, {"phi": phi + SENSOR * rng.standard_normal(ROWS)})


def quiet(noise: ProcessNoise) -> ProcessNoise:
    """The same without noise in the states."""
    point = noise.optimum.solution.point.copy()
    point[noise.problem.runs.size] = 0.0
    return replace(noise, optimum=replace(noise.optimum, solution=replace(noise.optimum.solution, point=point)))


def fitted(record: Record) -> PointEstimate:
    """By output error."""
    return estimate_model(
        linear(),
        Runs.one_session_each([record], 5.0),
        EstimateSettings(method=EstimateMethod.OUTPUT_ERROR),
        EstimatorOptions(workers=1),
    ).estimate


def test_without_process_noise_it_is_the_information_matrix() -> None:
    """With the sensor's noise as the residuals have it."""
    made = fitted(disturbed_decay(0.0, np.random.default_rng(2)))
    noise = quiet(implied_process_noise(made, {"phi": float(made.problem.noise[0])}))
    information = made.optimum.normal.without_local()[1]
    np.testing.assert_allclose(process_noise_interval(made, noise).covariance, np.linalg.inv(information), rtol=1e-6)


def test_errors_scatter_as_they_are_said_to() -> None:
    """Over disturbed decays the standardised errors have unit variance; white-noise errors would be 5 times too small.

    Chi-squared of 2 x 16 numbers leaves the limits by chance once in some five hundred cases.
    """
    rng, scaled, white = np.random.default_rng(4), [], []
    for _ in range(16):
        made = fitted(disturbed_decay(8e-4, rng))
        noise = implied_process_noise(made, {})
        assert noise.test.is_nearly_white
        scaled.append((made.common_parameters - [B, C]) / process_noise_interval(made, noise).standard_error)
        white.append((made.common_parameters - [B, C]) / process_noise_interval(made, quiet(noise)).standard_error)
    assert 0.42 < np.mean(np.square(scaled)) < 1.9
    assert np.mean(np.square(white)) > 25.0


def test_a_decay_alone_gets_it_and_says_so() -> None:
    """Output error by the decision table, with its reason, and intervals that know of the disturbance."""
    found = estimate_model(linear(), Runs.one_session_each([disturbed_decay(8e-4, np.random.default_rng(1))], 5.0))
    assert found.criterion == "output error over whole runs"
    assert any("free decay" in reason for reason in found.reasons)
    assert found.interval.meaning == MEANING[NoiseEvidence.ONE_STEP]
    assert found.noise_model.process["p"] > 0.0
