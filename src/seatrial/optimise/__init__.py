"""Optimisers that know no ship."""

from seatrial.optimise.ask_tell import Box, Optimiser, SearchError, fitness_of, search
from seatrial.optimise.cloud_particle_swarm import CloudParticleSwarm, CloudSettings
from seatrial.optimise.improved_wild_horse import ImprovedHerdSettings, ImprovedWildHorse
from seatrial.optimise.least_squares import LeastSquares, Normal, Optimum, levenberg_marquardt
from seatrial.optimise.population import Memory
from seatrial.optimise.pso import ParticleSwarm, SwarmSettings
from seatrial.optimise.solution import Solution, Status
from seatrial.optimise.wild_horse import HerdSettings, Variant, WildHorse

__all__ = [
    "Box",
    "CloudParticleSwarm",
    "CloudSettings",
    "HerdSettings",
    "ImprovedHerdSettings",
    "ImprovedWildHorse",
    "LeastSquares",
    "Memory",
    "Normal",
    "Optimiser",
    "Optimum",
    "ParticleSwarm",
    "SearchError",
    "Solution",
    "Status",
    "SwarmSettings",
    "Variant",
    "WildHorse",
    "fitness_of",
    "levenberg_marquardt",
    "search",
]
