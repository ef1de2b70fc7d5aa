"""Optimisers: least squares, evolution strategies, swarms; start points and stopping rules."""

from seatrial.numerics.optimise.ask_tell import Box, Optimiser, SearchError, fitness_function, search
from seatrial.numerics.optimise.cloud_particle_swarm import CloudParticleSwarm, CloudSettings
from seatrial.numerics.optimise.cma_es import AdaptationSettings, CovarianceAdaptation
from seatrial.numerics.optimise.differential_evolution import DifferentialEvolution, EvolutionSettings
from seatrial.numerics.optimise.dominance import hypervolume, non_dominated
from seatrial.numerics.optimise.improved_wild_horse import ImprovedHerdSettings, ImprovedWildHorse
from seatrial.numerics.optimise.least_squares import LeastSquaresProblem, NormalEquations, Optimum, levenberg_marquardt
from seatrial.numerics.optimise.multistart import Multistart, RestartSettings, multistart
from seatrial.numerics.optimise.particle_swarm import ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.population import FitnessMemory
from seatrial.numerics.optimise.random_weight_genetic import (
    GeneticSettings,
    NonDominatedSet,
    Normaliser,
    RandomWeightGenetic,
)
from seatrial.numerics.optimise.solution import Solution, Status
from seatrial.numerics.optimise.wild_horse import HerdSettings, StrideVariant, WildHorse

__all__ = [
    "AdaptationSettings",
    "Box",
    "CloudParticleSwarm",
    "CloudSettings",
    "CovarianceAdaptation",
    "DifferentialEvolution",
    "EvolutionSettings",
    "FitnessMemory",
    "GeneticSettings",
    "HerdSettings",
    "ImprovedHerdSettings",
    "ImprovedWildHorse",
    "LeastSquaresProblem",
    "Multistart",
    "NonDominatedSet",
    "NormalEquations",
    "Normaliser",
    "Optimiser",
    "Optimum",
    "ParticleSwarm",
    "RandomWeightGenetic",
    "RestartSettings",
    "SearchError",
    "Solution",
    "Status",
    "StrideVariant",
    "SwarmSettings",
    "WildHorse",
    "fitness_function",
    "hypervolume",
    "levenberg_marquardt",
    "multistart",
    "non_dominated",
    "search",
]
