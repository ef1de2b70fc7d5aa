"""Noise in the states as strong as whole runs show, where a memory hides it from one sample to the next."""

import numpy as np
from tests.estimation.estimate.test_process_noise_interval import START, B, C, disturbed_decay, fitted, linear

from seatrial.core.values import Array, Record
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.intervals import MEANING, process_noise_interval, with_whole_run_intensity
from seatrial.estimation.estimate.process_noise import NoiseEvidence, implied_process_noise

STEP, ROWS, MEMORY = 0.02, 1200, 0.3  # s
FORCE = 0.02  # rad/s^2, rms
SENSORS = np.array([2e-4, 2e-3])  # rad, rad/s


def decay_with_memory(rng: np.random.Generator) -> Record:
    """Angle and rate of a linear decay that a first-order Markov force drives, by small steps."""
    kept, force, state, seen = np.exp(-STEP / MEMORY), 0.0, np.array([START, 0.0]), np.empty((ROWS, 2))
    omega = np.sqrt(C - 0.25 * B**2)
    at, c, s = np.exp(-0.5 * B * STEP), np.cos(omega * STEP), np.sin(omega * STEP)
    step = at * np.array([[c + 0.5 * B * s / omega, s / omega], [-C * s / omega, c - 0.5 * B * s / omega]])
    noise = np.sqrt(1.0 - kept**2) * FORCE * rng.standard_normal(ROWS)
    for k in range(ROWS):
        seen[k] = state
        force = kept * force + noise[k]
        state = step @ state + np.array([0.5 * STEP**2, STEP]) * force
    seen += SENSORS * rng.standard_normal((ROWS, 2))
    return Record.from_arrays("decay", STEP * np.arange(0.0, ROWS), {"phi": seen[:, 0], "p": seen[:, 1]})


def standardised(record: Record) -> tuple[Array, Array, float]:
    """Errors over standard errors with the intensity of whole runs and with that of one step; their ratio squared."""
    estimate = fitted(record)
    by_steps = implied_process_noise(estimate, {})
    by_runs = with_whole_run_intensity(by_steps, estimate, estimate.residuals())
    errors = estimate.common_parameters - [B, C]
    intervals = [process_noise_interval(estimate, one) for one in (by_runs, by_steps)]
    ratio = by_runs.process_intensities["p"] / by_steps.process_intensities["p"]
    return errors / intervals[0].standard_error, errors / intervals[1].standard_error, ratio**2


def test_a_memory_of_an_eighth_of_a_period_hides_no_noise_from_the_intervals(rng: np.random.Generator) -> None:
    """Chi-squared of 2 x 24 numbers: beyond 1.54 once in 100 cases; by one step the errors are 1.6 times as large."""
    runs, steps, _ = zip(*(standardised(decay_with_memory(rng)) for _ in range(24)), strict=True)
    assert 0.3 < np.mean(np.square(runs)) < 1.54 < np.mean(np.square(steps))


def test_a_fit_of_a_decay_says_that_its_interval_is_that_of_whole_runs(rng: np.random.Generator) -> None:
    runs = Runs.one_session_each([decay_with_memory(rng)], 5.0)
    fit = estimate_model(linear(), runs, options=EstimatorOptions(workers=1))
    assert MEANING[NoiseEvidence.WHOLE_RUNS] in fit.interval.meaning


def test_of_white_noise_the_intensity_is_that_of_one_step(rng: np.random.Generator) -> None:
    """As few swings show it, within a factor of two, and never less."""
    ratio = standardised(disturbed_decay(8e-4, rng))[2]
    assert 1.0 <= ratio < 2.0
