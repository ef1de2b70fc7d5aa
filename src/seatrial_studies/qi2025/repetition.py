"""The paper's searches made again: its setting as deduced, the same off centre, and with the whole record."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import partial

import numpy as np

from seatrial.core.values import Array, Progress
from seatrial.numerics.optimise import (
    Box,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    Memory,
    ParticleSwarm,
    SwarmSettings,
    Variant,
    WildHorse,
)
from seatrial.numerics.optimise.population import Population
from seatrial.physics.models.qi2025 import HEADINGS
from seatrial_studies.qi2025.carried import carried_sample
from seatrial_studies.qi2025.published import Algorithm
from seatrial_studies.swarm_search import (
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

ITERATIONS, RUNS, QUICK_RUNS = 200, 10, 5
# how often the ten runs are made again, for the scatter of what they give
TENS, QUICK_TENS = 10, 3
# the heading of the paper's figures, whose coefficients it does not print
SHOWN = 45
NARROW, WIDE = 0.1, 0.5


class Setting(Enum):
    """What is searched: box, fitness, unit of pitch, and whether remembered points are judged again."""

    PAPER = "±10 % about the truth, one sample an iteration, pitch in rad"
    DEGREES = "±10 %, one sample, pitch in degrees"
    CARRIED = "±10 %, one sample from the identified model's own state, pitch in degrees"
    CARRIED_RADIANS = "±10 %, one sample from the identified model's own state, pitch in rad"
    REFERENCE = "±10 %, one sample, pitch in rad, strides as in the program of WHO's authors"
    REMEMBERED = "±10 %, one sample, pitch in rad, remembered fitness never renewed"
    OFF_CENTRE = "±50 %, truth off centre, one sample an iteration, pitch in rad"
    WHOLE = "±10 % about the truth, whole record, pitch in degrees"
    WHOLE_OFF_CENTRE = "±50 %, truth off centre, whole record, pitch in degrees"


# what the claims rest on
JUDGED = (Setting.PAPER, Setting.DEGREES, Setting.CARRIED, Setting.OFF_CENTRE, Setting.WHOLE_OFF_CENTRE)
# as often as the paper also when quick: their means of ten stand beside the print
TEN_TIMES = (Setting.PAPER, Setting.CARRIED)
DRAWN = (Setting.PAPER, Setting.DEGREES, Setting.CARRIED, Setting.REMEMBERED)
Made = Callable[[Box, np.random.Generator], Population]


def optimisers(iterations: int, memory: Memory, variant: Variant = Variant.PAPER) -> dict[Algorithm, Made]:
    """The three of the paper; PSO's omega, c1, c2 are not printed, ours are the constriction's."""
    plain = HerdSettings(iterations=iterations, memory=memory, variant=variant)
    improved = ImprovedHerdSettings(iterations=iterations, memory=memory, variant=variant)
    return {
        Algorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(iterations=iterations, memory=memory)),
        Algorithm.WHO: partial(WildHorse, settings=plain),
        Algorithm.IWHO: partial(ImprovedWildHorse, settings=improved),
    }


@dataclass(frozen=True, eq=False)
class Repetition:
    """Searches by setting, heading and algorithm, and the seas they met, by heading.

    At 45 degrees one run of the settings of the figures, with the coefficients of 90 degrees, assumed.
    `tens`: by heading, IWHO's mean error of the mean of ten in the paper's setting, as often as ten runs were made.
    """

    searches: dict[tuple[Setting, int, Algorithm], Searches]
    seas: dict[int, list[Data]]
    tens: dict[int, Array]
    runs: int
    is_quick: bool

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Those searched at the headings of the tables."""
        return tuple(s for s in Setting if (s, HEADINGS[0], Algorithm.IWHO) in self.searches)


def repetition(*, quick: bool, seed: int, progress: Progress | None) -> Repetition:
    """Ten runs of every setting; `quick` leaves out those that no claim rests on and runs others five times."""
    headings = (*HEADINGS, SHOWN)
    seas = {h: [sailed(h, np.random.default_rng([seed, h, run])) for run in range(RUNS)] for h in headings}
    found = {}
    for setting in Setting:
        met = (*(HEADINGS if setting in JUDGED or not quick else ()), *((SHOWN,) if setting in DRAWN else ()))
        if progress and met:
            progress(f"searches: {setting.value}")
        for heading in met:
            runs = 1 if heading == SHOWN else QUICK_RUNS if quick and setting not in TEN_TIMES else RUNS
            found |= _searched(setting, heading, seas[heading][:runs], seed)
    if progress:
        progress("the ten runs again")
    again = {h: _tens(h, QUICK_TENS if quick else TENS, seed) for h in HEADINGS}
    return Repetition(found, seas, again, RUNS, quick)


def _tens(heading: int, count: int, seed: int) -> Array:
    """Mean error of the mean of each ten runs, shape (count,); the first ten are those of the tables."""
    seas = [sailed(heading, np.random.default_rng([seed, heading, run])) for run in range(count * RUNS)]
    found = _searched(Setting.PAPER, heading, seas, seed, (Algorithm.IWHO,))[Setting.PAPER, heading, Algorithm.IWHO]
    means = found.points.reshape(count, RUNS, -1).mean(axis=1)
    return np.mean(np.abs(means / found.truth - 1.0), axis=1)


def _searched(
    setting: Setting, heading: int, seas: list[Data], seed: int, algorithms: tuple[Algorithm, ...] = tuple(Algorithm)
) -> dict[tuple[Setting, int, Algorithm], Searches]:
    boxes = _boxes(setting, seas, seed)
    memory = Memory.KEEP if setting is Setting.REMEMBERED else Memory.RE_EVALUATE
    variant = Variant.REFERENCE if setting is Setting.REFERENCE else Variant.PAPER
    judge = partial(_judged, setting)
    return {
        (setting, heading, algorithm): searched(seas, boxes, made, judge, seed)
        for algorithm, made in optimisers(ITERATIONS, memory, variant).items()
        if algorithm in algorithms
    }


def _boxes(setting: Setting, seas: list[Data], seed: int) -> list[Box]:
    truth = seas[0].truth
    if setting in (Setting.OFF_CENTRE, Setting.WHOLE_OFF_CENTRE):
        return [off_centre(truth, WIDE, np.random.default_rng([seed, 7, run])) for run in range(len(seas))]
    return [centred(truth, NARROW)] * len(seas)


def _judged(setting: Setting, data: Data, optimiser: Population) -> Fitness:
    if setting in (Setting.WHOLE, Setting.WHOLE_OFF_CENTRE):
        return whole_record(data, Angle.DEGREES)
    if setting in (Setting.CARRIED, Setting.CARRIED_RADIANS):
        return carried_sample(data, optimiser, Angle.DEGREES if setting is Setting.CARRIED else Angle.RADIANS)
    return one_sample(data, optimiser, Angle.DEGREES if setting is Setting.DEGREES else Angle.RADIANS)
