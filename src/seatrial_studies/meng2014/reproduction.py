"""The paper's searches made again, beside plain particle swarms, in boxes about the truth and beside it."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, StrEnum
from functools import partial

import numpy as np

from seatrial.core.values import Array, ProgressReporter
from seatrial.numerics.optimise import Box, CloudParticleSwarm, CloudSettings, ParticleSwarm, Population, SwarmSettings
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.swarm_search import (
    RepeatedSearches,
    SearchData,
    centred_box,
    off_centre_box,
    repeat_searches,
    simulate_search_data,
    whole_record_objective,
)

SOURCE = (
    "Meng Fei, Xu Hongyang, Xie Zhibin: Parameter identification of ship longitudinal motions based on cloud particle "
    "swarm optimization algorithm (in Chinese), Ship Science and Technology 2014(7), 37-40, "
    "doi 10.3404/j.issn.1672-7649.2014.07.0083"
)
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


def optimisers(iterations: int) -> dict[SwarmAlgorithm, Callable[[Box, np.random.Generator], Population]]:
    """As the paper sets them: 60 particles, c1 = c2 = 2.05, A 0.15, B 0.93, p_m 0.2; PSO with the constriction's."""
    return {
        SwarmAlgorithm.ICPSO: partial(CloudParticleSwarm, settings=CloudSettings(iterations=iterations)),
        SwarmAlgorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(population=60, iterations=iterations)),
    }


@dataclass(frozen=True, eq=False)
class CloudSwarmReproduction:
    """Searches by setting, heading and algorithm; the seas by heading.

    `shorter`: searches of ICPSO off centre with fewer iterations, by their number and heading.
    `unweighted`: searches off centre by eq. (4) as it is printed, without an inertia weight, by heading.
    """

    searches: dict[tuple[BoxPlacement, int, SwarmAlgorithm], RepeatedSearches]
    seas: dict[int, list[SearchData]]
    shorter_searches: dict[tuple[int, int], RepeatedSearches]
    unweighted_searches: dict[int, RepeatedSearches]
    iterations: int

    def excess_fitness(self, heading: int, algorithm: SwarmAlgorithm) -> Array:
        """Fitness at each run's end off centre, over the better of both swarms in its sea and box, less 1; (runs,)."""
        return self._relative_excess(heading, self.searches[BoxPlacement.OFF_CENTRE, heading, algorithm])

    def unweighted_excess_fitness(self, heading: int) -> Array:
        """Return the same of the law as printed."""
        return self._relative_excess(heading, self.unweighted_searches[heading])

    def _relative_excess(self, heading: int, searches: RepeatedSearches) -> Array:
        swarms = [
            self._final_fitness(heading, self.searches[BoxPlacement.OFF_CENTRE, heading, a]) for a in SwarmAlgorithm
        ]
        return self._final_fitness(heading, searches) / np.min(swarms, axis=0) - 1.0

    def _final_fitness(self, heading: int, searches: RepeatedSearches) -> Array:
        pairs = zip(self.seas[heading], searches.points, strict=True)
        return np.array([float(whole_record_objective(sea)(point[None])[0]) for sea, point in pairs])


def reproduce_searches(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> CloudSwarmReproduction:
    """Five runs of 1000 iterations; `quick`: three of 400."""
    runs, iterations = (QUICK_RUNS, QUICK_ITERATIONS) if quick else (RUNS, ITERATIONS)
    seas = {
        heading: [
            simulate_search_data(
                heading, np.random.default_rng([seed, heading, run]), height=SEA_STATE_3, has_fin=True, noise=NOISE
            )
            for run in range(runs)
        ]
        for heading in HEADINGS
    }
    found = {}
    for setting in BoxPlacement:
        if report_progress:
            report_progress(f"searches: {setting.value}")
        for heading, met in seas.items():
            for algorithm, made in optimisers(iterations).items():
                boxes = _boxes(setting, met, seed)
                found[setting, heading, algorithm] = repeat_searches(met, boxes, made, _objective, seed)
    if report_progress:
        report_progress("fewer iterations, and the law as printed")
    shorter = {}
    for few in (round(share * iterations) for share in SHORTER_SHARES):
        made = optimisers(few)[SwarmAlgorithm.ICPSO]
        for heading, met in seas.items():
            boxes = _boxes(BoxPlacement.OFF_CENTRE, met, seed)
            shorter[few, heading] = repeat_searches(met, boxes, made, _objective, seed)
    unweighted = {
        heading: repeat_searches(
            met, _boxes(BoxPlacement.OFF_CENTRE, met, seed), _unweighted_swarm(iterations), _objective, seed
        )
        for heading, met in seas.items()
    }
    return CloudSwarmReproduction(found, seas, shorter, unweighted, iterations)


def _unweighted_swarm(iterations: int) -> Callable[[Box, np.random.Generator], Population]:
    """Eq. (4) as printed: the velocity counts whole; velocities limited as ICPSO's."""
    cloud = CloudSettings()
    plain = SwarmSettings(cloud.population, iterations, 1.0, cloud.c1, cloud.c2, cloud.velocity_limit)
    return partial(ParticleSwarm, settings=plain)


def _boxes(setting: BoxPlacement, seas: list[SearchData], seed: int) -> list[Box]:
    truth = seas[0].truth
    if setting is BoxPlacement.OFF_CENTRE:
        return [
            off_centre_box(truth, WIDE_HALF_WIDTH, np.random.default_rng([seed, 7, run])) for run in range(len(seas))
        ]
    return [centred_box(truth, NARROW_HALF_WIDTH)] * len(seas)


def _objective(data: SearchData, _: Population) -> Callable[[np.ndarray], np.ndarray]:
    return whole_record_objective(data)
