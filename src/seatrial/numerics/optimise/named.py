"""Optimisers by name: the table of the built-in ones, and those that other packages install."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from seatrial._plugins import installed, load_plugin
from seatrial.numerics.optimise.cma_es import AdaptationSettings, CovarianceAdaptation
from seatrial.numerics.optimise.differential_evolution import DifferentialEvolution, EvolutionSettings
from seatrial.numerics.optimise.particle_swarm import CloudParticleSwarm, CloudSettings, ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.population import Box, FitnessMemory, Optimiser, SearchError
from seatrial.numerics.optimise.wild_horse import HerdSettings, ImprovedHerdSettings, ImprovedWildHorse, WildHorse

ENTRY_POINT_GROUP = "seatrial.optimisers"
OptimiserFactory = Callable[[Box, np.random.Generator], Optimiser]


@dataclass(frozen=True)
class SearchBudget:
    """Size and length of a search.

    Attributes:
        population: points of an iteration; iterations: populations judged, the first included.
        memory: what becomes of the fitness of remembered points; a fitness that changes from iteration to iteration
            needs them judged again.
    """

    population: int
    iterations: int
    memory: FitnessMemory = FitnessMemory.KEEP


@dataclass(frozen=True)
class SearchMethod:
    """A published search: a row of the table of built-in optimisers.

    Attributes:
        name: in Python; title: in words; source: where it was published.
        optimiser: its class; settings: of a budget.
        iterations: as its source or, where that is silent, ours.
        population: of a search of that many unknowns.
    """

    name: str
    title: str
    source: str
    optimiser: Callable[..., Optimiser]
    settings: Callable[[SearchBudget], Any]
    iterations: int
    population: Callable[[int], int]

    def within(self, budget: SearchBudget) -> OptimiserFactory:
        """Return what makes the optimiser of that budget from a box and a generator."""
        return partial(self.optimiser, settings=self.settings(budget))


def _constant(population: int) -> Callable[[int], int]:
    return lambda _: population


SEARCH_METHODS: Mapping[str, SearchMethod] = MappingProxyType({
    "pso": SearchMethod(
        "particle_swarm", "particle swarm", "Kennedy & Eberhart 1995, as Qi et al. 2025, eq. (29), print it",
        ParticleSwarm, lambda b: SwarmSettings(b.population, b.iterations, memory=b.memory),
        SwarmSettings.iterations, _constant(SwarmSettings.population),
    ),
    "who": SearchMethod(
        "wild_horse", "wild horse optimiser", "Naruei & Keynia 2022, as Qi et al. 2025, eqs. (15)-(20), print it",
        WildHorse, lambda b: HerdSettings(b.population, b.iterations, memory=b.memory),
        HerdSettings.iterations, _constant(HerdSettings.population),
    ),
    "iwho": SearchMethod(
        "improved_wild_horse", "improved wild horse optimiser", "Qi et al. 2025, eqs. (15)-(25)",
        ImprovedWildHorse, lambda b: ImprovedHerdSettings(b.population, b.iterations, memory=b.memory),
        ImprovedHerdSettings.iterations, _constant(ImprovedHerdSettings.population),
    ),
    "icpso": SearchMethod(
        "cloud_particle_swarm", "cloud particle swarm", "Meng et al. 2014, eqs. (4)-(6)",
        CloudParticleSwarm, lambda b: CloudSettings(b.population, b.iterations, memory=b.memory),
        CloudSettings.iterations, _constant(CloudSettings.population),
    ),
    "de": SearchMethod(
        "differential_evolution", "differential evolution", "Storn & Price 1997, rand/1/bin",
        DifferentialEvolution, lambda b: EvolutionSettings(b.population, b.iterations, memory=b.memory),
        EvolutionSettings.iterations, _constant(EvolutionSettings.population),
    ),
    "cma-es": SearchMethod(
        "covariance_adaptation", "covariance matrix adaptation evolution strategy", "Hansen 2016, arXiv:1604.00772",
        CovarianceAdaptation, lambda b: AdaptationSettings(b.population, b.iterations),
        AdaptationSettings.iterations, AdaptationSettings.default_population,
    ),
})  # fmt: skip
"""Name of a method in a trial file -> the search that it stands for: an optimiser of the package is entered here."""

OPTIMISERS: Mapping[str, OptimiserFactory] = MappingProxyType({m.name: m.optimiser for m in SEARCH_METHODS.values()})


def optimiser_named(name: str) -> OptimiserFactory:
    """Return what makes an optimiser, with its default settings, from a box and a generator.

    Raises:
        SearchError: there is no such optimiser, or an installed one cannot be loaded; the sentence says which.
    """
    if name in OPTIMISERS:
        return OPTIMISERS[name]
    names = installed(ENTRY_POINT_GROUP)
    if name not in names:
        raise SearchError(f"There is no optimiser '{name}'; known are {', '.join(sorted((*OPTIMISERS, *names)))}.")
    return load_plugin(ENTRY_POINT_GROUP, name, SearchError)
