"""The paper's searches made again, beside plain particle swarms, in boxes about the truth and beside it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import partial

import numpy as np

from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.search import Fitness
from seatrial.numerics.optimise import (
    Box,
    CloudParticleSwarm,
    CloudSettings,
    ParticleSwarm,
    Population,
    SwarmSettings,
)
from seatrial.problems import centred_box, off_centre_box
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.swarm_search import (
    RepeatedSearches,
    SearchData,
    repeat_searches,
    simulate_search_data,
    whole_record_objective,
)

SOURCE = (
    "Meng Fei, Xu Hongyang, Xie Zhibin: Parameter identification of ship longitudinal motions based on cloud particle "
    "swarm optimization algorithm (in Chinese), Ship Science and Technology 2014(7), 37-40, "
    "doi 10.3404/j.issn.1672-7649.2014.07.0083"
)
SwarmFactory = Callable[[Box, np.random.Generator], Population]
# deg, headings of the paper's tables
HEADINGS = (0, 45, 90, 135, 180)
# m, significant height assumed for sea state 3
SEA_STATE_3 = 0.88
NOISE = (HEAVE_NOISE, PITCH_NOISE)
# iterations and runs of each search; our choice
ITERATIONS, QUICK_ITERATIONS, RUNS, QUICK_RUNS = 1000, 400, 5, 3
# shares of the iterations that the shorter searches have; our choice
SHORTER_SHARES = (0.2, 0.5)
# half widths of the search box, shares of the truth; our choice
NARROW_HALF_WIDTH, WIDE_HALF_WIDTH = 0.1, 0.5


class SwarmAlgorithm(StrEnum):
    """The paper's swarm, and the plain one with inertia that it springs from."""

    ICPSO = "ICPSO"
    PSO = "PSO"


class BoxPlacement(Enum):
    """Where is searched; the paper's box is not printed."""

    OFF_CENTRE = "±50 %, truth off centre"
    CENTRED = "±10 % about the truth"


def optimisers(iterations: int) -> dict[SwarmAlgorithm, SwarmFactory]:
    """As the paper sets them: 60 particles, c1 = c2 = 2.05, A 0.15, B 0.93, p_m 0.2; PSO with the constriction's."""
    return {
        SwarmAlgorithm.ICPSO: partial(CloudParticleSwarm, settings=CloudSettings(iterations=iterations)),
        SwarmAlgorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(population=60, iterations=iterations)),
    }


class CloudVariant(StrEnum):
    """ICPSO with one of its two uses of the cloud left out."""

    STEADY_WEIGHT = "ICPSO, weight without randomness (He = 0)"
    NO_MUTATION = "ICPSO without mutation"


@dataclass(frozen=True, eq=False)
class CloudSwarmReproduction:
    """Searches by setting, heading and algorithm; the seas by heading.

    Attributes:
        shorter_searches: of ICPSO off centre with fewer iterations, by their number and heading.
        unweighted_searches: off centre by eq. (4) as it is printed, without an inertia weight, by heading.
        variants: of ICPSO off centre, by variant and heading.
        noise_free_searches: of ICPSO off centre in the first sea without noise, by number of iterations and heading.
        iterations: of a search.
    """

    searches: dict[tuple[BoxPlacement, int, SwarmAlgorithm], RepeatedSearches]
    seas: dict[int, list[SearchData]]
    shorter_searches: dict[tuple[int, int], RepeatedSearches]
    unweighted_searches: dict[int, RepeatedSearches]
    variants: dict[tuple[CloudVariant, int], RepeatedSearches]
    noise_free_searches: dict[tuple[int, int], RepeatedSearches]
    iterations: int

    @property
    def run_count(self) -> int:
        """Return the runs at each heading."""
        return len(next(iter(self.seas.values())))

    def excess_fitness(self, heading: int, searches: RepeatedSearches) -> Array:
        """Fitness off centre after each iteration over the better end of both swarms, less 1; (runs, iterations)."""
        ends = [self.searches[BoxPlacement.OFF_CENTRE, heading, a].histories[:, -1] for a in SwarmAlgorithm]
        return searches.histories / np.min(ends, axis=0)[:, None] - 1.0


def reproduce_searches(*, quick: bool, seed: int, report_progress: ProgressReporter) -> CloudSwarmReproduction:
    """Five runs of 1000 iterations; `quick`: three of 400."""
    runs, iterations = (QUICK_RUNS, QUICK_ITERATIONS) if quick else (RUNS, ITERATIONS)
    report_progress("seas")
    seas = {heading: [_sea(heading, run, seed, NOISE) for run in range(runs)] for heading in HEADINGS}
    searches = {}
    for setting in BoxPlacement:
        report_progress(f"searches: {setting.value}")
        for heading, met in seas.items():
            for algorithm, make in optimisers(iterations).items():
                searches[setting, heading, algorithm] = _search(met, make, seed, setting)
    lengths = [round(share * iterations) for share in (*SHORTER_SHARES, 1.0)]
    report_progress("fewer iterations, and without noise")
    shorter, quiet = {}, {}
    for few in lengths:
        make = optimisers(few)[SwarmAlgorithm.ICPSO]
        for heading, met in seas.items():
            if few < iterations:
                shorter[few, heading] = _search(met, make, seed)
            quiet[few, heading] = _search([_sea(heading, 0, seed, (0.0, 0.0))], make, seed)
    report_progress("the law as printed, and the cloud left out")
    unweighted = {heading: _search(met, _unweighted_swarm(iterations), seed) for heading, met in seas.items()}
    variants = {
        (variant, heading): _search(met, _variant(variant, iterations), seed)
        for variant in CloudVariant
        for heading, met in seas.items()
    }
    return CloudSwarmReproduction(searches, seas, shorter, unweighted, variants, quiet, iterations)


def _sea(heading: int, run: int, seed: int, noise: tuple[float, float]) -> SearchData:
    rng = np.random.default_rng([seed, heading, run])
    return simulate_search_data(heading, rng, height=SEA_STATE_3, has_fin=True, noise=noise)


def _search(
    seas: list[SearchData], make: SwarmFactory, seed: int, setting: BoxPlacement = BoxPlacement.OFF_CENTRE
) -> RepeatedSearches:
    return repeat_searches(seas, _boxes(setting, seas, seed), make, _objective, seed)


def _unweighted_swarm(iterations: int) -> SwarmFactory:
    """Eq. (4) as printed: the velocity counts whole; velocities limited as ICPSO's."""
    cloud = CloudSettings()
    plain = SwarmSettings(cloud.population, iterations, 1.0, cloud.c1, cloud.c2, cloud.velocity_limit)
    return partial(ParticleSwarm, settings=plain)


def _variant(variant: CloudVariant, iterations: int) -> SwarmFactory:
    whole = CloudSettings(iterations=iterations)
    settings = {
        CloudVariant.STEADY_WEIGHT: replace(whole, hyper_entropy=0.0),
        CloudVariant.NO_MUTATION: replace(whole, mutation=0.0),
    }[variant]
    return partial(CloudParticleSwarm, settings=settings)


def _boxes(setting: BoxPlacement, seas: list[SearchData], seed: int) -> list[Box]:
    if setting is BoxPlacement.OFF_CENTRE:
        return off_centre_boxes(seas, seed)
    return [centred_box(seas[0].truth, NARROW_HALF_WIDTH)] * len(seas)


def off_centre_boxes(seas: list[SearchData], seed: int) -> list[Box]:
    """Return the box of each run off centre."""
    truth = seas[0].truth
    return [off_centre_box(truth, WIDE_HALF_WIDTH, np.random.default_rng([seed, 7, run])) for run in range(len(seas))]


def _objective(data: SearchData, _: Population) -> Fitness:
    return whole_record_objective(data)
