"""Disturbances with a memory, biases and lags are found where they are, and not where white noise suffices."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.estimation.estimate.disturbance_choice import DisturbanceChoice, choose_disturbance, critical_gain
from seatrial.estimation.estimate.point_estimate import fit_output_error
from seatrial.estimation.estimate.process_noise import ProcessNoise, fit_prediction_error
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto

Array = NDArray[np.float64]
K, T, SPEED = 0.15, 8.0, 2.0
NOISE = {"r": 1e-3, "psi": 3e-3, "x0": 0.1, "y0": 0.1}
DT, FINE, ROWS = 0.5, 10, 1500


@pytest.fixture(scope="module")
def model() -> Model:
    return nomoto().with_values({"K": K, "T": T, "U": SPEED})


def record_of(rng: np.random.Generator, *, gust: float, memory: float, bias: float) -> Record:
    """Steps ten times finer than the samples, exact in r; `gust` in rad/s^2, `bias` a random walk in m over root s."""
    h, rows = DT / FINE, ROWS * FINE
    sampled = 0.3 * np.clip(8.0 * np.sin(2 * np.pi * DT * np.arange(ROWS + 1) / 52.0), -1.0, 1.0)
    delta = np.interp(h * (np.arange(rows) + 0.5), DT * np.arange(ROWS + 1), sampled)
    kicks, keep = rng.standard_normal(rows), np.exp(-h / memory)
    decay = np.exp(-h / T)
    r = psi = x = y = force = 0.0
    kept = np.empty((ROWS, 4))
    for k in range(rows):
        if k % FINE == 0:
            kept[k // FINE] = r, psi, x, y
        force = keep * force + np.sqrt(1.0 - keep**2) * gust * kicks[k]
        before, r = r, decay * r + (1.0 - decay) * (K * delta[k] + T * force)
        middle = psi + 0.25 * h * (before + r)
        x, y = x + h * SPEED * np.cos(middle), y + h * SPEED * np.sin(middle)
        psi += 0.5 * h * (before + r)
    wander = np.cumsum(bias * np.sqrt(DT) * rng.standard_normal((ROWS, 2)), axis=0)
    kept[:, 2:] += wander
    kept += rng.standard_normal(kept.shape) * list(NOISE.values())
    channels = dict(zip(NOISE, kept.T, strict=True))
    return Record.from_arrays("run", np.linspace(0.0, DT * (ROWS - 1), ROWS), {"delta": sampled[:-1], **channels})


_WITH_WAVES = "first-order Markov on r and waves on the sensors"
"""Waves are sought beside gusts that leave white innovations, too: whiteness sees weak waves too rarely."""


def found_in(model: Model, seed: int, *, gust: float = 2e-3, memory: float = 0.02, bias: float = 0.0) -> ProcessNoise:
    record = record_of(np.random.default_rng(seed), gust=gust, memory=memory, bias=bias)
    problem = OutputError(model, cut_segments(model, [record], tuple(NOISE), 20.0), 10 * np.array(list(NOISE.values())),
                          workers=1)  # fmt: skip
    return fit_prediction_error(
        fit_output_error(problem, problem.start(), problem.measured_initial_states(), {}), thorough=True
    )


@pytest.fixture(scope="module")
def gusty(model: Model) -> DisturbanceChoice:
    return choose_disturbance(found_in(model, 1, memory=6.0))


@pytest.fixture(scope="module")
def wandering(model: Model) -> DisturbanceChoice:
    return choose_disturbance(found_in(model, 2, bias=0.1))


def names(choice: DisturbanceChoice) -> list[str]:
    return [f.noise.disturbance_model for f in choice.fitted]


def test_a_gust_with_a_memory(gusty: DisturbanceChoice) -> None:
    white, best = gusty.fitted[1].noise, gusty.chosen.noise
    assert not white.test.is_white
    assert names(gusty) == ["none", "white", "first-order Markov on r", _WITH_WAVES]
    assert best.disturbance_model == "first-order Markov on r"
    assert best.test.is_white
    assert best.added_parameters["gust_memory_r"] == pytest.approx(6.0, rel=0.3)
    assert best.process_intensities["r"] == pytest.approx(2e-3 * np.sqrt(2 * 6.0), rel=0.3)
    assert set(best.measurement_noise) == set(NOISE)
    assert best.common_parameters.shape == white.common_parameters.shape == (2,)
    assert np.all(np.abs(best.common_parameters - [K, T]) / best.interval.standard_error < 3.0)
    estimate = best.as_point_estimate()
    assert estimate.problem.model.equations is white.problem.runs.model.equations
    assert estimate.residuals().shape == estimate.problem.data.measured.shape


def test_wandering_positions(wandering: DisturbanceChoice) -> None:
    best = wandering.chosen.noise
    assert best.disturbance_model == "white and wandering biases of x0, y0"
    assert best.test.is_white
    assert set(best.process_intensities) == {"r"}
    white = best.problem.split(best.optimum.solution.point)[2]
    assert np.all(white[-2:] >= 0.01 * best.problem.runs.noise[-2:])
    wander = 0.1 * np.sqrt(0.5 * best.added_constants["bias_memory"])  # m, stationary
    assert best.measurement_noise["x0"] == pytest.approx(wander, rel=0.5)


def test_white_noise_needs_no_more(model: Model) -> None:
    white = found_in(model, 3)
    choice = choose_disturbance(white)
    assert white.test.is_white
    assert choice.chosen.noise is white
    assert "twice its log-likelihood" in choice.summary


def test_the_table_has_every_candidate(gusty: DisturbanceChoice) -> None:
    rows = gusty.rows(is_used=True)
    none, white, markov, with_waves = rows
    assert [r.degrees_of_freedom for r in rows] == [0, 1, 2, 7]
    assert none.likelihood_ratio == 0.0 < white.likelihood_ratio < markov.likelihood_ratio
    assert with_waves.likelihood_ratio - markov.likelihood_ratio < critical_gain(7 - 2)
    assert [r.is_white for r in rows[:3]] == [False, False, True]
    assert [r.is_chosen for r in rows] == [False, False, True, False]
    assert list(markov.parameters) == ["gust_memory_r"]


def test_the_spread_holds_the_candidates_that_are_not_far_less_likely(gusty: DisturbanceChoice) -> None:
    choice = replace(gusty, fitted=tuple(f for f in gusty.fitted if f.noise.disturbance_model != _WITH_WAVES))
    _, white, markov = choice.fitted
    assert markov.log_likelihood - white.log_likelihood > 12.0
    point, other = markov.noise.common_parameters, white.noise.common_parameters
    np.testing.assert_array_equal(choice.spread(point), 0.0)
    near = replace(white.noise.optimum.normal, cost=markov.noise.optimum.normal.cost + 11.0)
    noise = replace(white.noise, optimum=replace(white.noise.optimum, normal=near))
    likelier = replace(choice, fitted=(choice.fitted[0], replace(white, noise=noise), markov))
    np.testing.assert_allclose(likelier.spread(point), np.outer(other - point, other - point))


def test_a_candidate_that_cannot_be_the_likeliest_is_left_near_its_optimum(wandering: DisturbanceChoice) -> None:
    """Positions wander, so that gusts are far less likely than that, and no search leads so far."""
    gusts = next(f for f in wandering.fitted if f.noise.disturbance_model.startswith("first-order Markov on r"))
    assert wandering.chosen.is_searched
    assert not gusts.is_searched
    assert gusts.log_likelihood < wandering.chosen.log_likelihood


def test_chance_gains_are_those_of_chi_squared() -> None:
    """Abramowitz & Stegun 1972, table 26.8, upper 0.1 % points."""
    assert [critical_gain(k) for k in (1, 2, 5)] == pytest.approx([10.828, 13.816, 20.515], abs=1e-3)


def test_intervals_have_room_for_what_was_added(gusty: DisturbanceChoice) -> None:
    """Unknowns more: the information of the coefficients is that of all, with the others eliminated."""
    best = gusty.chosen.noise
    hessian = best.optimum.normal.hessian
    inside = best.optimum.solution.point > best.problem.lower
    whole = np.linalg.inv(hessian[np.ix_(inside, inside)])
    np.testing.assert_allclose(best.interval.standard_error, np.sqrt(np.diag(whole))[:2], rtol=1e-4)
