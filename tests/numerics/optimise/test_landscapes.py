"""Shifted, rotated functions in boxes not centred on their minimum, against a random search of the same budget."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import mannwhitneyu
from tests.numerics.optimise.landscapes import (
    BOX,
    KINDS,
    LEAST,
    Array,
    Landscape,
    make_optimiser,
    rastrigin,
    rosenbrock,
    sphere,
)

from seatrial.numerics.optimise import Box, search

BUDGET = 40 * 200
SEEDS = range(5)


@pytest.mark.long(every=2)
@pytest.mark.parametrize(("function", "limit"), [(sphere, 0.01), (rosenbrock, 15.0), (rastrigin, 25.0)])
@pytest.mark.parametrize("kind", KINDS)
def test_it_finds_what_a_random_search_does_not(kind: str, function: Callable[[Array], Array], limit: float) -> None:
    landscape = Landscape(function, LEAST)
    found = [search(make_optimiser(kind, BOX, seed), landscape).value for seed in SEEDS]
    drawn = [landscape(BOX.random_points(np.random.default_rng(seed), BUDGET)).min() for seed in SEEDS]
    assert np.median(found) < limit < min(drawn)


def _ends(kind: str, lower: float, least: float) -> Array:
    """Decades of the value reached on a sphere in a box 10 wide."""
    box = Box(np.full(8, lower), np.full(8, lower + 10))
    landscape = Landscape(sphere, np.full(8, least))
    return np.array([np.log10(search(make_optimiser(kind, box, seed), landscape).value + 1e-300) for seed in SEEDS])


@pytest.mark.parametrize("kind", KINDS)
def test_wild_horses_alone_are_drawn_to_zero(kind: str) -> None:
    """The same problem moved by a constant: only leaders that go to -WH or omega WH notice, by many decades."""
    at_zero, moved = _ends(kind, -5.0, 0.0), _ends(kind, 95.0, 100.0)
    if kind in ("who paper", "who reference", "iwho"):
        assert at_zero.max() < moved.min() - 12
    else:
        assert abs(np.median(at_zero) - np.median(moved)) < 1


@pytest.mark.parametrize("kind", ["who paper", "who reference", "iwho"])
def test_it_is_zero_that_draws_them_not_the_centre_of_the_box(kind: str) -> None:
    centred, aside = _ends(kind, 95.0, 100.0), _ends(kind, 95.0, 101.7)
    assert mannwhitneyu(centred, aside).pvalue > 0.01
