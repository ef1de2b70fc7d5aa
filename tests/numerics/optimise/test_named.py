"""Optimisers by name: every one keeps its box and its budget, with the settings of its source."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.data.trial import SEARCHES
from seatrial.numerics.optimise import (
    OPTIMISERS,
    SEARCH_METHODS,
    Box,
    FitnessMemory,
    SearchBudget,
    SearchError,
    optimiser_named,
    search,
)

BOX = Box(np.array([-1.0, -2.0]), np.array([3.0, 2.0]))


def test_every_search_of_a_trial_file_stands_in_the_table() -> None:
    assert set(SEARCHES) == set(SEARCH_METHODS)


@pytest.mark.parametrize("method", sorted(SEARCH_METHODS))
def test_every_search_stays_within_its_budget(method: str) -> None:
    optimiser = SEARCH_METHODS[method].within(SearchBudget(12, 5))(BOX, np.random.default_rng(0))
    found = search(optimiser, lambda x: np.sum((x - 0.5) ** 2, axis=1))
    assert len(found.history) <= 5
    assert found.evaluations <= 12 * 5


def test_settings_are_those_of_the_source() -> None:
    sizes = {name: (m.population(8), m.iterations) for name, m in SEARCH_METHODS.items()}
    # Qi et al. 2025, section 4.1; Meng et al. 2014, section 3; Hansen 2016, eq. 48: 4 + floor(3 ln 8)
    assert sizes == {
        "pso": (40, 200), "who": (40, 200), "iwho": (40, 200), "icpso": (60, 1000), "de": (40, 200), "cma-es": (10, 200)
    }  # fmt: skip


def test_a_fitness_that_changes_has_remembered_points_judged_again() -> None:
    budget = SearchBudget(12, 3, FitnessMemory.RE_EVALUATE)
    optimiser = SEARCH_METHODS["pso"].within(budget)(BOX, np.random.default_rng(0))
    assert search(optimiser, lambda x: np.sum(x**2, axis=1)).evaluations == 12 + 2 * 24


@pytest.mark.parametrize("name", sorted(OPTIMISERS))
def test_a_built_in_name_makes_an_optimiser_in_its_box(name: str, rng: np.random.Generator) -> None:
    lower, upper = np.array([-1.0, 2.0]), np.array([1.0, 3.0])
    points = optimiser_named(name)(Box(lower, upper), rng).ask()
    assert points.shape[1] == 2 and np.all(points >= lower) and np.all(points <= upper)


def test_an_unknown_name_lists_those_that_are_known() -> None:
    with pytest.raises(SearchError, match=f"no optimiser 'simplex'; known are .*{min(OPTIMISERS)}"):
        optimiser_named("simplex")


@pytest.mark.parametrize("method", sorted(SEARCH_METHODS))
def test_constants_of_a_source_are_settings_of_its_search(method: str) -> None:
    row = SEARCH_METHODS[method]
    defaults = row.constant_values(SearchBudget(12, 5))
    assert set(defaults) == set(row.constants) and all(row.constants.values())
    for name, value in defaults.items():
        factory = row.within(SearchBudget(12, 5, constants={name: 0.9 * value}))
        assert getattr(factory.keywords["settings"], name) == 0.9 * value  # type: ignore[attr-defined]
    with pytest.raises(SearchError, match="has no constant 'P_Z'; it has "):
        row.within(SearchBudget(12, 5, constants={"P_Z": 0.1}))


@pytest.mark.parametrize("method", sorted(SEARCH_METHODS))
def test_the_page_on_methods_has_each_constant_with_its_default(repository: Path, method: str) -> None:
    page = (repository / "docs" / "published-methods.md").read_text(encoding="utf-8")
    table = page.split("| method | constants and defaults |")[1].split("\n\n")[0]
    row = next(line for line in table.splitlines() if line.startswith(f"| `{method}` |"))
    for name, value in SEARCH_METHODS[method].constant_values(SearchBudget(12, 5)).items():
        assert f"`{name}` {value:.6g}" in row
