"""The paper's searches made again, beside plain particle swarms, in boxes about the truth and beside it."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, StrEnum
from functools import partial

import numpy as np

from seatrial.core.values import Array, Progress
from seatrial.numerics.optimise import Box, CloudParticleSwarm, CloudSettings, ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.population import Population
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.swarm_search import Data, Searches, centred, off_centre, sailed, searched, whole_record

SOURCE = (
    "Meng Fei, Xu Hongyang, Xie Zhibin: Parameter identification of ship longitudinal motions based on cloud particle "
    "swarm optimization algorithm (in Chinese), Ship Science and Technology 2014(7), 37-40, "
    "doi 10.3404/j.issn.1672-7649.2014.07.0083"
)
HEADINGS = (0, 45, 90, 135, 180)
SEA_STATE_3 = 0.88
NOISE = (HEAVE_NOISE, PITCH_NOISE)
ITERATIONS, QUICK_ITERATIONS, RUNS, QUICK_RUNS = 1000, 400, 5, 3
SHORTER = (0.2, 0.5)
NARROW, WIDE = 0.1, 0.5


class Algorithm(StrEnum):
    """The paper's swarm, and the plain one with inertia that it springs from."""

    ICPSO = "ICPSO"
    PSO = "PSO"


class Setting(Enum):
    """Where is searched; the paper's box is not printed."""

    OFF_CENTRE = "±50 %, truth off centre"
    CENTRED = "±10 % about the truth"


def optimisers(iterations: int) -> dict[Algorithm, Callable[[Box, np.random.Generator], Population]]:
    """As the paper sets them: 60 particles, c1 = c2 = 2.05, A .15, B .93, p_m .2; PSO with the constriction's."""
    return {
        Algorithm.ICPSO: partial(CloudParticleSwarm, settings=CloudSettings(iterations=iterations)),
        Algorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(population=60, iterations=iterations)),
    }


@dataclass(frozen=True, eq=False)
class Repetition:
    """Searches by setting, heading and algorithm; the seas by heading.

    `shorter`: searches of ICPSO off centre with fewer iterations, by their number and heading.
    `unweighted`: searches off centre by eq. (4) as it is printed, without an inertia weight, by heading.
    """

    searches: dict[tuple[Setting, int, Algorithm], Searches]
    seas: dict[int, list[Data]]
    shorter: dict[tuple[int, int], Searches]
    unweighted: dict[int, Searches]
    iterations: int

    def above_best(self, heading: int, algorithm: Algorithm) -> Array:
        """Fitness at each run's end off centre, over the better of both swarms in its sea and box, less 1; (runs,)."""
        return self._above(heading, self.searches[Setting.OFF_CENTRE, heading, algorithm])

    def unweighted_above_best(self, heading: int) -> Array:
        """The same of the law as printed."""
        return self._above(heading, self.unweighted[heading])

    def _above(self, heading: int, found: Searches) -> Array:
        swarms = [self._ends(heading, self.searches[Setting.OFF_CENTRE, heading, a]) for a in Algorithm]
        return self._ends(heading, found) / np.min(swarms, axis=0) - 1.0

    def _ends(self, heading: int, found: Searches) -> Array:
        pairs = zip(self.seas[heading], found.points, strict=True)
        return np.array([float(whole_record(sea)(point[None])[0]) for sea, point in pairs])


def repetition(*, quick: bool, seed: int, progress: Progress | None) -> Repetition:
    """Five runs of 1000 iterations; `quick`: three of 400."""
    runs, iterations = (QUICK_RUNS, QUICK_ITERATIONS) if quick else (RUNS, ITERATIONS)
    seas = {
        heading: [
            sailed(heading, np.random.default_rng([seed, heading, run]), height=SEA_STATE_3, has_fin=True, noise=NOISE)
            for run in range(runs)
        ]
        for heading in HEADINGS
    }
    found = {}
    for setting in Setting:
        if progress:
            progress(f"searches: {setting.value}")
        for heading, met in seas.items():
            for algorithm, made in optimisers(iterations).items():
                boxes = _boxes(setting, met, seed)
                found[setting, heading, algorithm] = searched(met, boxes, made, _judged, seed)
    if progress:
        progress("fewer iterations, and the law as printed")
    shorter = {}
    for few in (round(share * iterations) for share in SHORTER):
        made = optimisers(few)[Algorithm.ICPSO]
        for heading, met in seas.items():
            boxes = _boxes(Setting.OFF_CENTRE, met, seed)
            shorter[few, heading] = searched(met, boxes, made, _judged, seed)
    unweighted = {
        heading: searched(met, _boxes(Setting.OFF_CENTRE, met, seed), _unweighted(iterations), _judged, seed)
        for heading, met in seas.items()
    }
    return Repetition(found, seas, shorter, unweighted, iterations)


def _unweighted(iterations: int) -> Callable[[Box, np.random.Generator], Population]:
    """Eq. (4) as printed: the velocity counts whole; velocities limited as ICPSO's."""
    cloud = CloudSettings()
    plain = SwarmSettings(cloud.population, iterations, 1.0, cloud.c1, cloud.c2, cloud.velocity_limit)
    return partial(ParticleSwarm, settings=plain)


def _boxes(setting: Setting, seas: list[Data], seed: int) -> list[Box]:
    truth = seas[0].truth
    if setting is Setting.OFF_CENTRE:
        return [off_centre(truth, WIDE, np.random.default_rng([seed, 7, run])) for run in range(len(seas))]
    return [centred(truth, NARROW)] * len(seas)


def _judged(data: Data, _: Population) -> Callable[[np.ndarray], np.ndarray]:
    return whole_record(data)
