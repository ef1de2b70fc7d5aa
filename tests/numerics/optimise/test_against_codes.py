"""Differential evolution beside SciPy's, the covariance adaptation bit for bit with the package called by hand."""

from collections.abc import Callable

import numpy as np
import pytest
from cmaes import CMA
from scipy.optimize import differential_evolution
from scipy.stats import mannwhitneyu
from tests.numerics.optimise.landscapes import BOX, LEAST, SQUARE, Array, Landscape, make_optimiser, rosenbrock, sphere

from seatrial.numerics.optimise import AdaptationSettings, Box, CovarianceAdaptation, SearchError, Status, search


def _scipys(landscape: Landscape, weight: float) -> list[float]:
    """CR .9, 40 vectors, 80 generations at once; SciPy redraws what leaves the box."""
    bounds = list(zip(BOX.lower, BOX.upper, strict=True))
    return [
        differential_evolution(
            lambda x: landscape(x.T), bounds, strategy="rand1bin", maxiter=79, popsize=5, tol=0, mutation=weight,
            recombination=0.9, rng=seed, polish=False, init="random", updating="deferred", vectorized=True,
        ).fun
        for seed in range(12)
    ]  # fmt: skip


@pytest.mark.parametrize("function", [sphere, rosenbrock])
def test_differential_evolution_reaches_what_scipys_does(function: Callable[[Array], Array]) -> None:
    landscape = Landscape(function, LEAST)
    ours = [search(make_optimiser("de", BOX, seed, iterations=80), landscape).value for seed in range(12)]
    assert mannwhitneyu(ours, _scipys(landscape, 0.5)).pvalue > 0.05


def test_the_comparison_sees_another_weight() -> None:
    ours = [search(make_optimiser("de", BOX, seed, iterations=80), SQUARE).value for seed in range(12)]
    assert mannwhitneyu(ours, _scipys(SQUARE, 0.7)).pvalue < 0.001


def test_covariance_adaptation_is_the_package_in_the_unit_box() -> None:
    ours = CovarianceAdaptation(BOX, np.random.default_rng(8), AdaptationSettings(12, 40))
    seed = int(np.random.default_rng(8).integers(2**32))
    unit = np.array([[0.0, 1.0]] * 8)
    theirs = CMA(np.full(8, 0.5), 0.3, bounds=unit, n_max_resampling=20, seed=seed, population_size=12)
    for _ in range(40):
        drawn = [theirs.ask() for _ in range(12)]
        points = np.array([BOX.lower + x * BOX.width for x in drawn])
        assert np.array_equal(ours.ask(), points)
        fitness = SQUARE(points)
        theirs.tell([(x, float(f)) for x, f in zip(drawn, fitness, strict=True)])
        ours.tell(fitness)


def test_covariance_adaptation_stops_by_itself_where_nothing_is_left_to_gain() -> None:
    solution = search(CovarianceAdaptation(BOX, np.random.default_rng(1), AdaptationSettings(iterations=5000)), SQUARE)
    assert solution.status is Status.CONVERGED
    assert solution.evaluations < 20000
    assert np.allclose(solution.point, LEAST, atol=1e-6)


def test_a_single_unknown_is_searched_too() -> None:
    box = Box(np.array([-1.0]), np.array([4.0]))
    for kind in ("pso", "who paper", "iwho", "icpso", "de", "cma"):
        found = search(make_optimiser(kind, box, 1), lambda x: (x[:, 0] - 0.7) ** 2)
        assert found.point[0] == pytest.approx(0.7, abs=1e-2), kind


def test_a_step_that_is_none_is_refused() -> None:
    with pytest.raises(SearchError, match="positive share"):
        AdaptationSettings(step=0.0)
