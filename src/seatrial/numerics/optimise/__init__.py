"""Optimisers that know no ship."""

from seatrial.numerics.optimise.ask_tell import Box, Optimiser, SearchError, fitness_of, search
from seatrial.numerics.optimise.cloud_particle_swarm import CloudParticleSwarm, CloudSettings
from seatrial.numerics.optimise.cma_es import AdaptationSettings, CovarianceAdaptation
from seatrial.numerics.optimise.differential_evolution import DifferentialEvolution, EvolutionSettings
from seatrial.numerics.optimise.dominance import hypervolume, non_dominated
from seatrial.numerics.optimise.improved_wild_horse import ImprovedHerdSettings, ImprovedWildHorse
from seatrial.numerics.optimise.least_squares import LeastSquares, Normal, Optimum, levenberg_marquardt
from seatrial.numerics.optimise.multistart import Multistart, Restarts, multistart
from seatrial.numerics.optimise.population import Memory
from seatrial.numerics.optimise.pso import ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.random_weight_genetic import Front, GeneticSettings, Normaliser, RandomWeightGenetic
from seatrial.numerics.optimise.solution import Solution, Status
from seatrial.numerics.optimise.wild_horse import HerdSettings, Variant, WildHorse

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
