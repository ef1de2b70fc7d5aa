"""Optimisers that know no ship."""

from seatrial.optimise.ask_tell import Box, Optimiser, SearchError, fitness_of, search
from seatrial.optimise.cloud_particle_swarm import CloudParticleSwarm, CloudSettings
from seatrial.optimise.cma_es import AdaptationSettings, CovarianceAdaptation
from seatrial.optimise.differential_evolution import DifferentialEvolution, EvolutionSettings
from seatrial.optimise.dominance import hypervolume, non_dominated
from seatrial.optimise.improved_wild_horse import ImprovedHerdSettings, ImprovedWildHorse
from seatrial.optimise.least_squares import LeastSquares, Normal, Optimum, levenberg_marquardt
from seatrial.optimise.multistart import Multistart, Restarts, multistart
from seatrial.optimise.population import Memory
from seatrial.optimise.pso import ParticleSwarm, SwarmSettings
from seatrial.optimise.random_weight_genetic import Front, GeneticSettings, Normaliser, RandomWeightGenetic
from seatrial.optimise.solution import Solution, Status
from seatrial.optimise.wild_horse import HerdSettings, Variant, WildHorse

__all__ = [
    "AdaptationSettings",
    "Box",
    "CloudParticleSwarm",
    "CloudSettings",
    "CovarianceAdaptation",
    "DifferentialEvolution",
    "EvolutionSettings",
    "Front",
    "GeneticSettings",
    "HerdSettings",
    "ImprovedHerdSettings",
    "ImprovedWildHorse",
    "LeastSquares",
    "Memory",
    "Multistart",
    "Normal",
    "Normaliser",
    "Optimiser",
    "Optimum",
    "ParticleSwarm",
    "RandomWeightGenetic",
    "Restarts",
    "SearchError",
    "Solution",
    "Status",
    "SwarmSettings",
    "Variant",
    "WildHorse",
    "fitness_of",
    "hypervolume",
    "levenberg_marquardt",
    "multistart",
    "non_dominated",
    "search",
]
