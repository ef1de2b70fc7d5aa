"""Optimisers by name: the built-in ones, and those that other packages install under ``seatrial.optimisers``."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from seatrial._plugins import installed, load_plugin
from seatrial.numerics.optimise.cma_es import CovarianceAdaptation
from seatrial.numerics.optimise.differential_evolution import DifferentialEvolution
from seatrial.numerics.optimise.particle_swarm import CloudParticleSwarm, ParticleSwarm
from seatrial.numerics.optimise.population import Box, Optimiser, SearchError
from seatrial.numerics.optimise.wild_horse import ImprovedWildHorse, WildHorse

ENTRY_POINT_GROUP = "seatrial.optimisers"
OptimiserFactory = Callable[[Box, np.random.Generator], Optimiser]

OPTIMISERS: Mapping[str, OptimiserFactory] = MappingProxyType(
    {
        "cloud_particle_swarm": CloudParticleSwarm,
        "covariance_adaptation": CovarianceAdaptation,
        "differential_evolution": DifferentialEvolution,
        "improved_wild_horse": ImprovedWildHorse,
        "particle_swarm": ParticleSwarm,
        "wild_horse": WildHorse,
    }
)


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
