"""Optimisers by name: the table of the built-in ones, and those that other packages install."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
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
        constants: of the method, by name, that differ from its source's.
    """

    population: int
    iterations: int
    memory: FitnessMemory = FitnessMemory.KEEP
    constants: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SearchMethod:
    """A published search: a row of the table of built-in optimisers.

    Attributes:
        name: in Python; title: in words; source: where it was published.
        optimiser: its class; settings: the class of its settings, which holds the defaults.
        iterations: as its source or, where that is silent, ours.
        population: of a search of that many unknowns.
        constants: name of each constant that can be set -> where its default stands.
    """

    name: str
    title: str
    source: str
    optimiser: Callable[..., Optimiser]
    settings: type[Any]
    iterations: int
    population: Callable[[int], int]
    constants: Mapping[str, str]

    def within(self, budget: SearchBudget) -> OptimiserFactory:
        """Return what makes the optimiser of that budget from a box and a generator.

        Raises:
            SearchError: a constant that the method does not have, or a value that it cannot take.
        """
        for name in budget.constants:
            if name not in self.constants:
                raise SearchError(f"The {self.title} has no constant '{name}'; it has {', '.join(self.constants)}.")
        budgeted = {"population": budget.population, "iterations": budget.iterations, "memory": budget.memory}
        names = {field.name for field in fields(self.settings)}
        settings = self.settings(**{n: v for n, v in budgeted.items() if n in names}, **budget.constants)
        return partial(self.optimiser, settings=settings)

    def constant_values(self, budget: SearchBudget) -> dict[str, float]:
        """Return every constant of the method, as the budget or else its source has it."""
        defaults: dict[str, Any] = {field.name: field.default for field in fields(self.settings)}
        return {name: float(budget.constants.get(name, defaults[name])) for name in self.constants}


def _constant(population: int) -> Callable[[int], int]:
    return lambda _: population


_CONSTRICTION = "Clerc & Kennedy 2002; Qi et al. 2025 print none"
_QI = "Qi et al. 2025, section 4.1"
_MENG, _MENG_CLOUD = "Meng et al. 2014, the simulation", "Meng et al. 2014, below eq. (6)"
_STORN = "Storn & Price 1997, initial choices"
_OURS = "ours; not printed"

SEARCH_METHODS: Mapping[str, SearchMethod] = MappingProxyType({
    "pso": SearchMethod(
        "particle_swarm", "particle swarm", "Kennedy & Eberhart 1995, as Qi et al. 2025, eq. (29), print it",
        ParticleSwarm, SwarmSettings, SwarmSettings.iterations, _constant(SwarmSettings.population),
        {"omega": _CONSTRICTION, "c1": _CONSTRICTION, "c2": _CONSTRICTION, "velocity_limit": _OURS},
    ),
    "who": SearchMethod(
        "wild_horse", "wild horse optimiser", "Naruei & Keynia 2022, as Qi et al. 2025, eqs. (15)-(20), print it",
        WildHorse, HerdSettings, HerdSettings.iterations, _constant(HerdSettings.population),
        {"P_S": _QI, "P_C": _QI},
    ),
    "iwho": SearchMethod(
        "improved_wild_horse", "improved wild horse optimiser", "Qi et al. 2025, eqs. (15)-(25)",
        ImprovedWildHorse, ImprovedHerdSettings, ImprovedHerdSettings.iterations,
        _constant(ImprovedHerdSettings.population),
        {"P_S": _QI, "P_C": _QI, "omega_min": _QI, "omega_max": _QI, "scatter": "Qi et al. 2025, below eq. (21)"},
    ),
    "icpso": SearchMethod(
        "cloud_particle_swarm", "cloud particle swarm", "Meng et al. 2014, eqs. (4)-(6)",
        CloudParticleSwarm, CloudSettings, CloudSettings.iterations, _constant(CloudSettings.population),
        {
            "c1": _MENG, "c2": _MENG, "A": _MENG, "B": _MENG, "p_m": _MENG, "w1": _MENG_CLOUD, "w2": _MENG_CLOUD,
            "En": _MENG_CLOUD, "He": _MENG_CLOUD, "velocity_limit": _OURS, "spread": _OURS,
        },
    ),
    "de": SearchMethod(
        "differential_evolution", "differential evolution", "Storn & Price 1997, rand/1/bin",
        DifferentialEvolution, EvolutionSettings, EvolutionSettings.iterations,
        _constant(EvolutionSettings.population),
        {"F": _STORN, "CR": _STORN},
    ),
    "cma-es": SearchMethod(
        "covariance_adaptation", "covariance matrix adaptation evolution strategy", "Hansen 2016, arXiv:1604.00772",
        CovarianceAdaptation, AdaptationSettings, AdaptationSettings.iterations,
        AdaptationSettings.default_population, {"step": "Hansen 2016, appendix A"},
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
