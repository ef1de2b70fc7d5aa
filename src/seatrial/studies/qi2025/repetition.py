"""The paper's searches made again: its setting as deduced, the same off centre, and with the whole record."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import partial

import numpy as np

from seatrial.models.qi2025 import HEADINGS
from seatrial.optimise import (
    Box,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    Memory,
    ParticleSwarm,
    SwarmSettings,
    WildHorse,
)
from seatrial.optimise.population import Population
from seatrial.studies.qi2025.published import Algorithm
from seatrial.studies.swarm_search import (
    Angle,
    Data,
    Fitness,
    Searches,
    centred,
    off_centre,
    one_sample,
    sailed,
    searched,
    whole_record,
)
from seatrial.values import Progress

ITERATIONS, RUNS = 200, 10
NARROW, WIDE = 0.1, 0.5


class Setting(Enum):
    """What is searched: box, fitness, unit of pitch, and whether remembered points are judged again."""

    PAPER = "±10 % about the truth, one sample an iteration, pitch in rad"
    DEGREES = "the same, pitch in degrees"
    REMEMBERED = "the same in rad, remembered fitness never renewed"
    OFF_CENTRE = "±50 %, truth off centre, one sample an iteration, pitch in rad"
    WHOLE = "±10 % about the truth, whole record, pitch in degrees"
    WHOLE_OFF_CENTRE = "±50 %, truth off centre, whole record, pitch in degrees"


# what the claims rest on
JUDGED = (Setting.PAPER, Setting.DEGREES, Setting.OFF_CENTRE, Setting.WHOLE_OFF_CENTRE)
Made = Callable[[Box, np.random.Generator], Population]


def optimisers(iterations: int, memory: Memory) -> dict[Algorithm, Made]:
    """The three of the paper; PSO's omega, c1, c2 are not printed, ours are the constriction's."""
    return {
        Algorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(iterations=iterations, memory=memory)),
        Algorithm.WHO: partial(WildHorse, settings=HerdSettings(iterations=iterations, memory=memory)),
        Algorithm.IWHO: partial(ImprovedWildHorse, settings=ImprovedHerdSettings(iterations=iterations, memory=memory)),
    }


@dataclass(frozen=True, eq=False)
class Repetition:
    """Searches by setting, heading and algorithm, and the seas they met, by heading."""

    searches: dict[tuple[Setting, int, Algorithm], Searches]
    seas: dict[int, list[Data]]
    runs: int


def repetition(*, quick: bool, seed: int, progress: Progress | None) -> Repetition:
    """Ten runs of every setting; `quick` leaves out those that no claim rests on."""
    seas = {h: [sailed(h, np.random.default_rng([seed, h, run])) for run in range(RUNS)] for h in HEADINGS}
    found = {}
    for setting in JUDGED if quick else tuple(Setting):
        if progress:
            progress(f"searches: {setting.value}")
        for heading in HEADINGS:
            boxes = _boxes(setting, seas[heading], seed)
            memory = Memory.KEEP if setting is Setting.REMEMBERED else Memory.RE_EVALUATE
            for algorithm, made in optimisers(ITERATIONS, memory).items():
                judge = partial(_judged, setting)
                found[setting, heading, algorithm] = searched(seas[heading], boxes, made, judge, seed)
    return Repetition(found, seas, RUNS)


def _boxes(setting: Setting, seas: list[Data], seed: int) -> list[Box]:
    truth = seas[0].truth
    if setting in (Setting.OFF_CENTRE, Setting.WHOLE_OFF_CENTRE):
        return [off_centre(truth, WIDE, np.random.default_rng([seed, 7, run])) for run in range(len(seas))]
    return [centred(truth, NARROW)] * len(seas)


def _judged(setting: Setting, data: Data, optimiser: Population) -> Fitness:
    if setting in (Setting.WHOLE, Setting.WHOLE_OFF_CENTRE):
        return whole_record(data, Angle.DEGREES)
    return one_sample(data, optimiser, Angle.DEGREES if setting is Setting.DEGREES else Angle.RADIANS)
