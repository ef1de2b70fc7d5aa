"""Optimisers by name."""

import numpy as np
import pytest

from seatrial.numerics.optimise.named import OPTIMISERS, optimiser_named
from seatrial.numerics.optimise.population import Box, SearchError


@pytest.mark.parametrize("name", sorted(OPTIMISERS))
def test_a_built_in_name_makes_an_optimiser_in_its_box(name: str, rng: np.random.Generator) -> None:
    lower, upper = np.array([-1.0, 2.0]), np.array([1.0, 3.0])
    points = optimiser_named(name)(Box(lower, upper), rng).ask()
    assert points.shape[1] == 2 and np.all(points >= lower) and np.all(points <= upper)


def test_an_unknown_name_lists_those_that_are_known() -> None:
    with pytest.raises(SearchError, match=f"no optimiser 'simplex'; known are .*{min(OPTIMISERS)}"):
        optimiser_named("simplex")
