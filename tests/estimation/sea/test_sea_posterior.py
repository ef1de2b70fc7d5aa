"""Draws of heading, ship and sea from one stretch, against weighted draws of what was known before it."""

import math
from functools import cache

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.estimation.sea import (
    BIN_STRIDE,
    MotionSpectrum,
    SeaLikelihood,
    ShipInSea,
    altered_loop,
    draw_ship_in_sea,
    encountered_sea,
)
from seatrial.estimation.sea.sea_likelihood import HEADING, PERIOD, POINT_SIZE, SHIP
from seatrial.physics.loops import HullFactor
from seatrial.physics.loops.structures import fin_loop

HULL, U, BETA = HullFactor(100.0, 10.5, 3.4), 9.26, math.radians(110.0)
DEVIATIONS = np.array([0.2, 0.1, 0.3])
SHIP_FACTORS, SEA = np.log([1.1, 1.03, 0.9]), np.log([3.0, 9.8, 1.0])
STEP = 0.06
FINE = np.arange(5, 35) * STEP  # rad/s, of a stretch so short that the prior has many points in what it allows


@cache
def likelihood(*, is_random: bool = True) -> SeaLikelihood:
    """A stretch without control whose spectrum is that of the truth, with random phases or as it is on average."""
    loop, rng = altered_loop(fin_loop(), SHIP_FACTORS), np.random.default_rng(5)
    sea = encountered_sea(FINE, U, BETA, HULL)
    density = sea.density(SEA, np.abs(loop.disturbance.frequency_response(sea.omega_e)) ** 2)[::BIN_STRIDE]
    noise, none = 1e-3 * float(np.max(density)), np.zeros(len(density))
    observed = (density + noise) * (rng.exponential(size=len(none)) if is_random else 1.0)
    motion = MotionSpectrum(FINE[::BIN_STRIDE], STEP, observed, 1j * none, none, noise)
    return SeaLikelihood(motion, fin_loop(), U, HULL, 9.0, DEVIATIONS)


@cache
def draws() -> ShipInSea:
    """From one seed."""
    return draw_ship_in_sea(likelihood(), np.random.default_rng(1))


def columns(draws: ShipInSea) -> Array:
    """Heading, logarithm of the period and the ship's factors, (n, 5)."""
    return np.column_stack([draws.headings, draws.seas[:, 1], draws.ships])


def test_draws_are_spread_as_weighted_draws_of_the_prior() -> None:
    """Importance sampling (Robert & Casella 2004, Monte Carlo Statistical Methods, section 3.3), many more points."""
    rng, (low, high) = np.random.default_rng(2), likelihood().periods
    size = 16_000
    points = np.column_stack([
        rng.uniform(0.0, math.pi, size), rng.uniform(low, high, size), rng.standard_normal((size, POINT_SIZE - 2))
    ])  # fmt: skip
    evidence = likelihood().heights(points).evidence
    weight = np.exp(evidence - np.max(evidence))
    weight /= np.sum(weight)
    assert 1.0 / np.sum(weight**2) > 150.0
    values = np.column_stack([points[:, HEADING], points[:, PERIOD], DEVIATIONS * points[:, SHIP]])
    mean = weight @ values
    deviation = np.sqrt(weight @ (values - mean) ** 2)
    drawn = columns(draws())
    np.testing.assert_allclose((np.mean(drawn, axis=0) - mean) / deviation, 0.0, atol=0.25)
    np.testing.assert_allclose(np.std(drawn, axis=0) / deviation, 1.0, atol=0.25)


def test_the_truth_is_among_the_draws() -> None:
    truth = np.array([BETA, SEA[1], *SHIP_FACTORS])
    below = np.mean(columns(draws()) < truth, axis=0)
    assert np.all((below > 0.005) & (below < 0.995))
    assert 0.005 < np.mean(draws().seas[:, 0] < SEA[0]) < 0.995


def test_the_seed_gives_the_same_bits() -> None:
    again = draw_ship_in_sea(likelihood(), np.random.default_rng(1))
    np.testing.assert_array_equal(again.headings, draws().headings)
    np.testing.assert_array_equal(again.seas, draws().seas)


def test_nothing_lies_outside_what_is_looked_at() -> None:
    points = np.zeros((3, POINT_SIZE))
    points[:, HEADING], points[:, PERIOD] = (1.0, -0.1, 1.0), (math.log(9.0), math.log(9.0), math.log(90.0))
    evidence = likelihood().heights(points).evidence
    assert np.isfinite(evidence[0])
    assert np.all(np.isneginf(evidence[1:]))


@pytest.mark.parametrize("axis", [HEADING, PERIOD])
def test_evidence_of_the_mean_spectrum_is_largest_near_the_truth(axis: int) -> None:
    truth = np.array([BETA, SEA[1], *(SHIP_FACTORS / DEVIATIONS), 0.0, 0.0])
    points = np.tile(truth, (41, 1))
    points[:, axis] += np.linspace(-0.5, 0.5, 41)
    best = points[int(np.argmax(likelihood(is_random=False).heights(points).evidence)), axis]
    assert best == pytest.approx(truth[axis], abs=0.1)
