"""Functions with known minima, shifted and rotated in boxes that are not centred on them, and every optimiser."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.numerics.optimise import (
    AdaptationSettings,
    Box,
    CloudParticleSwarm,
    CloudSettings,
    CovarianceAdaptation,
    DifferentialEvolution,
    EvolutionSettings,
    FitnessMemory,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    Optimiser,
    ParticleSwarm,
    StrideVariant,
    SwarmSettings,
    WildHorse,
)

Array = NDArray[np.float64]
OptimiserFactory = Callable[[Box, np.random.Generator, int, int, FitnessMemory], Optimiser]
REFERENCE = StrideVariant.REFERENCE

KINDS: dict[str, OptimiserFactory] = {
    "pso": lambda b, g, n, t, m: ParticleSwarm(b, g, SwarmSettings(n, t, memory=m)),
    "who paper": lambda b, g, n, t, m: WildHorse(b, g, HerdSettings(n, t, memory=m)),
    "who reference": lambda b, g, n, t, m: WildHorse(b, g, HerdSettings(n, t, variant=REFERENCE, memory=m)),
    "iwho": lambda b, g, n, t, m: ImprovedWildHorse(b, g, ImprovedHerdSettings(n, t, memory=m)),
    "icpso": lambda b, g, n, t, m: CloudParticleSwarm(b, g, CloudSettings(n, t, memory=m)),
    "de": lambda b, g, n, t, m: DifferentialEvolution(b, g, EvolutionSettings(n, t, memory=m)),
    "cma": lambda b, g, n, t, m: CovarianceAdaptation(b, g, AdaptationSettings(n, t)),  # noqa: ARG005
}
WITH_MEMORY = [kind for kind in KINDS if kind != "cma"]


def make_optimiser(kind: str, box: Box, seed: int, population: int = 40, iterations: int = 200) -> Optimiser:
    """An optimiser of a kind with its own seed."""
    return KINDS[kind](box, np.random.default_rng(seed), population, iterations, FitnessMemory.KEEP)


@dataclass(frozen=True)
class Landscape:
    """A function of rows with its minimum 0 at `least`, turned by a fixed rotation."""

    function: Callable[[Array], Array]
    least: Array

    def __call__(self, points: Array) -> Array:
        d = len(self.least)
        rotation = np.linalg.qr(np.random.default_rng(3).normal(size=(d, d)))[0]
        return self.function((points - self.least) @ rotation)


def sphere(y: Array) -> Array:
    return np.sum(y**2, axis=1)


def rosenbrock(y: Array) -> Array:
    z = y + 1
    return np.sum(100 * (z[:, 1:] - z[:, :-1] ** 2) ** 2 + (1 - z[:, :-1]) ** 2, axis=1)


def rastrigin(y: Array) -> Array:
    return np.sum(y**2 - 10 * np.cos(2 * np.pi * y) + 10, axis=1)


LEAST = np.array([2.0, -1.0, 3.0, 1.0, 0.5, 4.0, -2.0, 1.3])
BOX = Box(np.full(8, -3.0), np.array([7.0, 7.0, 8.0, 7.0, 5.0, 7.0, 9.0, 7.0]))
SQUARE = Landscape(sphere, LEAST)
