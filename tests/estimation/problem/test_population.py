"""Sessions as a population: the deviation between sessions against its marginal likelihood, computed directly."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import multivariate_normal

from seatrial.core.values import Array, Prior
from seatrial.estimation.problem.population import SessionPopulation

DECLARED = (Prior(0.0, 2.0),)
SESSIONS = 12
NO_COVARIATE = np.zeros((SESSIONS, 1))


def optimum(measured: Array, noise: Array, population: SessionPopulation, covariates: Array) -> tuple[Array, Array]:
    """Offsets (sessions, 1) that these measurements and the population determine together, and their precision."""
    own = population.deviation[0] ** -2.0 * np.eye(len(measured))
    precision = np.linalg.inv(noise) + own
    right = np.linalg.solve(noise, measured) + own @ population.means(covariates)[:, 0]
    return np.linalg.solve(precision, right)[:, None], precision


def settled(measured: Array, noise: Array, covariates: Array = NO_COVARIATE, centred: int = 0) -> SessionPopulation:
    population = SessionPopulation.as_declared(DECLARED, covariates, centred)
    for _ in range(30):
        population = population.fitted(*optimum(measured, noise, population, covariates), covariates)
    return population


@pytest.fixture
def noise(rng: np.random.Generator) -> Array:
    """Errors of the sessions' estimates, correlated by the coefficients they share."""
    common = rng.standard_normal(SESSIONS)
    return 0.09 * np.eye(SESSIONS) + 0.04 * np.outer(common, common)


def test_the_deviation_between_sessions_is_the_likeliest(noise: Array, rng: np.random.Generator) -> None:
    measured = rng.multivariate_normal(np.full(SESSIONS, 0.7), noise + 0.25 * np.eye(SESSIONS))
    flat = DECLARED[0].standard_deviation ** 2 * np.ones((SESSIONS, SESSIONS))  # of the mean

    def cost(deviation: float) -> float:
        covariance = noise + flat + deviation**2 * np.eye(SESSIONS)
        likelihood = multivariate_normal.logpdf(measured, np.zeros(SESSIONS), covariance)
        return float(-likelihood - np.log(deviation) + deviation / DECLARED[0].standard_deviation)

    likeliest = minimize_scalar(cost, bounds=(0.01, 3.0), method="bounded", options={"xatol": 1e-8}).x
    population = settled(measured, noise)
    assert population.deviation[0] == pytest.approx(likeliest, rel=2e-3)
    total = noise + population.deviation[0] ** 2 * np.eye(SESSIONS)
    weights = np.linalg.solve(total, np.ones(SESSIONS))  # generalised least squares, with the mean's prior
    precision = weights.sum() + DECLARED[0].standard_deviation ** -2
    assert population.mean[0] == pytest.approx(weights @ measured / precision, rel=1e-3)
    variance = population.deviation[0] ** 2 + 1.0 / precision
    assert population.new_session_covariance[0, 0] == pytest.approx(variance, rel=1e-3)


def test_a_declared_mean_stays_and_the_deviation_is_about_it(noise: Array, rng: np.random.Generator) -> None:
    """Offsets of 0.7 on average: the deviation about zero is the likeliest one, and no error of a mean is added."""
    measured = rng.multivariate_normal(np.full(SESSIONS, 0.7), noise + 0.25 * np.eye(SESSIONS))

    def cost(deviation: float) -> float:
        likelihood = multivariate_normal.logpdf(measured, np.zeros(SESSIONS), noise + deviation**2 * np.eye(SESSIONS))
        return float(-likelihood - np.log(deviation) + deviation / DECLARED[0].standard_deviation)

    likeliest = minimize_scalar(cost, bounds=(0.01, 3.0), method="bounded", options={"xatol": 1e-8}).x
    population = settled(measured, noise, centred=1)
    assert population.mean[0] == 0.0
    assert population.deviation[0] == pytest.approx(likeliest, rel=2e-3)
    assert population.deviation[0] > settled(measured, noise).deviation[0]
    assert population.new_session_covariance[0, 0] == population.deviation[0] ** 2
    assert population.of_new_session(measured[:, None], NO_COVARIATE, np.zeros(1))[0] == 0.0


def test_intervals_of_new_sessions_hold_the_new_offset(rng: np.random.Generator) -> None:
    noise, inside = 0.01 * np.eye(SESSIONS), []
    for _ in range(200):
        measured, new = 0.7 + 0.5 * rng.standard_normal(SESSIONS) + 0.1 * rng.standard_normal(SESSIONS), 0.7
        new += 0.5 * rng.standard_normal()
        population = settled(measured, noise)
        inside.append(abs(new - population.mean[0]) <= 1.96 * np.sqrt(population.new_session_covariance[0, 0]))
    assert 0.90 <= np.mean(inside) <= 0.99  # three binomial standard deviations about 0.95


def test_one_session_leaves_what_is_declared() -> None:
    one = SessionPopulation.as_declared(DECLARED, np.zeros((1, 1)))
    for _ in range(40):
        offsets, precision = optimum(np.array([1.0]), np.array([[1e-6]]), one, np.zeros((1, 1)))
        one = one.fitted(offsets, precision, np.zeros((1, 1)))
    # its offset is as far from the mean as the mean from zero: the likeliest deviation is that of one session more
    assert 0.5 * DECLARED[0].standard_deviation < one.deviation[0] < DECLARED[0].standard_deviation
    assert one.mean[0] == pytest.approx(0.5, abs=0.35)


def test_the_mean_follows_a_covariate(rng: np.random.Generator) -> None:
    helm = np.linspace(5.0, 35.0, SESSIONS)[:, None]
    measured = 1.0 - 0.04 * (helm[:, 0] - 20.0) + 0.02 * rng.standard_normal(SESSIONS)
    population = settled(measured, 1e-4 * np.eye(SESSIONS), helm)
    assert population.means(np.array([35.0]))[0] == pytest.approx(0.4, abs=0.05)
    assert population.means(np.array([5.0]))[0] == pytest.approx(1.6, abs=0.05)
    assert population.deviation[0] < 0.1
    rest = helm[:, 0] != 35.0
    expected = population.of_new_session(measured[rest, None], helm[rest], np.array([35.0]))
    assert expected[0] == pytest.approx(0.4, abs=0.05)
    without = settled(measured, 1e-4 * np.eye(SESSIONS))
    assert without.deviation[0] > 5.0 * population.deviation[0]


def test_further_kinds_stand_behind_as_declared() -> None:
    population = replace(SessionPopulation.as_declared(DECLARED, NO_COVARIATE), mean=np.array([0.4]))
    wider = population.with_kinds([Prior(1.0, 0.1)])
    np.testing.assert_array_equal(wider.mean, [0.4, 1.0])
    np.testing.assert_array_equal(wider.deviation, [2.0, 0.1])
    np.testing.assert_array_equal(wider.means(np.array([3.0, 4.0])), [0.4, 1.0])


def test_records_that_show_nothing_leave_the_spread_as_it_is() -> None:
    """The difference of two equal precisions may round below zero; the spread must not grow without end."""
    declared = [Prior(0.0, 0.577, "declared")]
    population = SessionPopulation.as_declared(declared, np.zeros((1, 1)))
    precision = np.array([[0.577**-2.0 * (1.0 - 1e-9)]])
    for _ in range(10):
        population = population.fitted(np.array([[0.1]]), precision, np.zeros((1, 1)))
    assert 0.1 < population.deviation[0] < 2.0


def test_a_fixed_spread_stays_as_declared_and_the_mean_moves() -> None:
    declared = [Prior(0.0, 0.1, "declared")]
    population = SessionPopulation.as_declared(declared, np.zeros((4, 1))).with_fixed_spread([True])
    offsets, precision = np.array([[0.4], [0.5], [0.45], [0.42]]), np.diag(np.full(4, 1e4 + 100.0))
    fitted = population.fitted(offsets, precision, np.zeros((4, 1)))
    assert fitted.deviation[0] == 0.1 and 0.2 < fitted.mean[0] < 0.5
