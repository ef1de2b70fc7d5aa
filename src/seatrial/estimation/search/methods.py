"""Published searches by name: what each is, where it was printed, and its optimiser within a budget."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

from seatrial.data.trial.settings import EstimateMethod
from seatrial.numerics.optimise import (
    AdaptationSettings,
    CloudParticleSwarm,
    CloudSettings,
    CovarianceAdaptation,
    DifferentialEvolution,
    EvolutionSettings,
    FitnessMemory,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    OptimiserFactory,
    ParticleSwarm,
    SwarmSettings,
    WildHorse,
)


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
    """A published search.

    Attributes:
        title: in words; source: where it was published.
        population: of a search of that many unknowns; iterations: as its source or, where that is silent, ours.
        within: the optimiser of a budget.
    """

    title: str
    source: str
    population: Callable[[int], int]
    iterations: int
    within: Callable[[SearchBudget], OptimiserFactory]


def search_method(method: EstimateMethod) -> SearchMethod:
    """Return what a search's name stands for; a KeyError for a method that is no search."""
    return _METHODS[method]


def _particle_swarm(budget: SearchBudget) -> OptimiserFactory:
    return partial(ParticleSwarm, settings=SwarmSettings(budget.population, budget.iterations, memory=budget.memory))


def _wild_horse(budget: SearchBudget) -> OptimiserFactory:
    return partial(WildHorse, settings=HerdSettings(budget.population, budget.iterations, memory=budget.memory))


def _improved_wild_horse(budget: SearchBudget) -> OptimiserFactory:
    settings = ImprovedHerdSettings(budget.population, budget.iterations, memory=budget.memory)
    return partial(ImprovedWildHorse, settings=settings)


def _cloud_particle_swarm(budget: SearchBudget) -> OptimiserFactory:
    settings = CloudSettings(budget.population, budget.iterations, memory=budget.memory)
    return partial(CloudParticleSwarm, settings=settings)


def _differential_evolution(budget: SearchBudget) -> OptimiserFactory:
    settings = EvolutionSettings(budget.population, budget.iterations, memory=budget.memory)
    return partial(DifferentialEvolution, settings=settings)


def _covariance_adaptation(budget: SearchBudget) -> OptimiserFactory:
    return partial(CovarianceAdaptation, settings=AdaptationSettings(budget.population, budget.iterations))


def _constant(population: int) -> Callable[[int], int]:
    return lambda _: population


_METHODS: Mapping[EstimateMethod, SearchMethod] = MappingProxyType({
    EstimateMethod.PSO: SearchMethod(
        "particle swarm", "Kennedy & Eberhart 1995, as Qi et al. 2025, eq. (29), print it",
        _constant(SwarmSettings.population), SwarmSettings.iterations, _particle_swarm,
    ),
    EstimateMethod.WHO: SearchMethod(
        "wild horse optimiser", "Naruei & Keynia 2022, as Qi et al. 2025, eqs. (15)-(20), print it",
        _constant(HerdSettings.population), HerdSettings.iterations, _wild_horse,
    ),
    EstimateMethod.IWHO: SearchMethod(
        "improved wild horse optimiser", "Qi et al. 2025, eqs. (15)-(25)",
        _constant(ImprovedHerdSettings.population), ImprovedHerdSettings.iterations, _improved_wild_horse,
    ),
    EstimateMethod.ICPSO: SearchMethod(
        "cloud particle swarm", "Meng et al. 2014, eqs. (4)-(6)",
        _constant(CloudSettings.population), CloudSettings.iterations, _cloud_particle_swarm,
    ),
    EstimateMethod.DE: SearchMethod(
        "differential evolution", "Storn & Price 1997, rand/1/bin",
        _constant(EvolutionSettings.population), EvolutionSettings.iterations, _differential_evolution,
    ),
    EstimateMethod.CMA_ES: SearchMethod(
        "covariance matrix adaptation evolution strategy", "Hansen 2016, arXiv:1604.00772",
        AdaptationSettings.default_population, AdaptationSettings.iterations, _covariance_adaptation,
    ),
})  # fmt: skip
