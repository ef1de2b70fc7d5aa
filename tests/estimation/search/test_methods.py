"""Published searches by name: every one has its optimiser, with the settings of its source."""

import numpy as np
import pytest

from seatrial.data.trial import SEARCHES, EstimateMethod
from seatrial.estimation.search import SearchBudget, search_method
from seatrial.numerics.optimise import (
    Box,
    CloudParticleSwarm,
    CovarianceAdaptation,
    DifferentialEvolution,
    FitnessMemory,
    ImprovedWildHorse,
    ParticleSwarm,
    WildHorse,
    search,
)

BOX = Box(np.array([-1.0, -2.0]), np.array([3.0, 2.0]))
KINDS = {
    EstimateMethod.PSO: ParticleSwarm, EstimateMethod.WHO: WildHorse, EstimateMethod.IWHO: ImprovedWildHorse,
    EstimateMethod.ICPSO: CloudParticleSwarm, EstimateMethod.DE: DifferentialEvolution,
    EstimateMethod.CMA_ES: CovarianceAdaptation,
}  # fmt: skip


@pytest.mark.parametrize("method", SEARCHES)
def test_every_search_stays_within_its_budget(method: EstimateMethod) -> None:
    optimiser = search_method(method).within(SearchBudget(12, 5))(BOX, np.random.default_rng(0))
    assert type(optimiser) is KINDS[method]
    found = search(optimiser, lambda x: np.sum((x - 0.5) ** 2, axis=1))
    assert len(found.history) <= 5
    assert found.evaluations <= 12 * 5


def test_settings_are_those_of_the_source() -> None:
    sizes = {m.value: (search_method(m).population(8), search_method(m).iterations) for m in SEARCHES}
    # Qi et al. 2025, section 4.1; Meng et al. 2014, section 3; Hansen 2016, eq. 48: 4 + floor(3 ln 8)
    assert sizes == {
        "pso": (40, 200), "who": (40, 200), "iwho": (40, 200), "icpso": (60, 1000), "de": (40, 200), "cma-es": (10, 200)
    }  # fmt: skip


def test_a_fitness_that_changes_has_remembered_points_judged_again() -> None:
    budget = SearchBudget(12, 3, FitnessMemory.RE_EVALUATE)
    optimiser = search_method(EstimateMethod.PSO).within(budget)(BOX, np.random.default_rng(0))
    assert search(optimiser, lambda x: np.sum(x**2, axis=1)).evaluations == 12 + 2 * 24
