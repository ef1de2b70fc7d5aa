"""What the printed constants let the cloud do: the inertia weight of eq. (6), by formula and in the searches."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, CloudParticleSwarm, CloudSettings, Optimiser, search
from seatrial_studies.swarm_search import SearchData, whole_record_objective

# draws of En' and r for the quantiles; ends of the central 95 %
_DRAWS, _CENTRAL_95 = 200_000, (0.025, 0.975)


@dataclass(frozen=True)
class CloudWeight:
    """The weight in the middle band A <= r <= B of r = f_best / f.

    Attributes:
        at_ends: weight at r = A and at r = B with En' = En.
        central: ends of the central 95 % of its draws, r uniform in the band, En' ~ N(En, He).
        mean, deviation: of these draws.
        band_shares: of all particles and iterations of the searches, below A, in the band, above B.
    """

    at_ends: tuple[float, float]
    central: tuple[float, float]
    mean: float
    deviation: float
    band_shares: tuple[float, float, float]


def cloud_weight(searches: list[tuple[SearchData, Box]], iterations: int, seed: int) -> CloudWeight:
    """Return the weight by formula, and the bands in which the particles of ICPSO's searches are."""
    settings = CloudSettings(iterations=iterations)
    rng = np.random.default_rng([seed, 37])
    ratio = rng.uniform(settings.a, settings.b, _DRAWS)
    weight = inertia_weight(ratio, rng.normal(settings.entropy, settings.hyper_entropy, _DRAWS), settings)
    low, high = np.quantile(weight, _CENTRAL_95)
    ends = inertia_weight(np.array([settings.a, settings.b]), np.full(2, settings.entropy), settings)
    ratios = np.concatenate([_fitness_ratios(data, box, settings, [seed, k]) for k, (data, box) in enumerate(searches)])
    below, above = float(np.mean(ratios < settings.a)), float(np.mean(ratios > settings.b))
    return CloudWeight(
        (float(ends[0]), float(ends[1])),
        (float(low), float(high)),
        float(weight.mean()),
        float(weight.std()),
        (below, 1.0 - below - above, above),
    )


def inertia_weight(ratio: Array, entropy: Array, settings: CloudSettings) -> Array:
    """Return eq. (6) in the middle band: w1 - (w1 - w2) exp(-(r - Ex)^2 / (2 En'^2)), Ex = 5 w1 - w2."""
    expectation = 5.0 * settings.w1 - settings.w2
    drop = np.exp(-0.5 * ((ratio - expectation) / entropy) ** 2)
    return settings.w1 - (settings.w1 - settings.w2) * drop


def _fitness_ratios(data: SearchData, box: Box, settings: CloudSettings, seed: list[int]) -> Array:
    """Best fitness so far over that of each particle, at every iteration, (iterations x population,)."""
    optimiser: Optimiser = CloudParticleSwarm(box, np.random.default_rng(seed), settings)
    objective = whole_record_objective(data)
    ratios: list[Array] = []
    best = np.inf

    def recorded(points: Array) -> Array:
        nonlocal best
        fitness = objective(points)
        best = min(best, float(fitness.min()))
        ratios.append(best / fitness)
        return fitness

    search(optimiser, recorded)
    return np.concatenate(ratios)
