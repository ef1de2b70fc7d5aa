"""Settings of the published genetic algorithm: a table of the loop file, a value in Python."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from seatrial.data.trial.amounts import STRICT_FIELDS, raises_input_error
from seatrial.numerics.optimise import GeneticSettings, Normaliser

Probability = Annotated[float, Field(ge=0, le=1)]


class SearchedObjectives(StrEnum):
    """What the genetic algorithm makes small.

    PRINTED: variances of output and actuator rate, and (actuator variance - target)^2 (Yu et al. 2014, eqs. (2)-(4)),
        the target being the variance at which the allowed share of amplitudes exceeds the actuator's limit.
    ONE_SIDED: the same, an actuator quieter than the target counting as met.
    OWN: the objectives of the task (`minimise` of a loop file).
    """

    PRINTED = "printed"
    ONE_SIDED = "one-sided"
    OWN = "minimise"


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class GeneticTuning:
    """`[genetic]`: settings of `--method genetic` (Yu et al. 2014, section 3); the defaults are published.

    Attributes:
        population: individuals of a generation; generations: how many of them, the first included.
        crossover: probability Pc that a pair of parents crosses over; mutation: probability Pm that a bit flips.
        bits: length of each gain's code; not printed: 17 is the fewest that hold the published gains.
        largest_weight: the random integers of the weights run from 1 to this; not printed.
        normaliser: what objectives are divided by: "max" or "best" of the first generation.
        objectives: what is made small.
        seeds: searches, the first of which gives the gains and the others show how far its answer scatters.
    """

    population: Annotated[int, Field(ge=5, le=10_000)] = 50
    generations: Annotated[int, Field(ge=1, le=10_000)] = 200
    crossover: Probability = 0.8  # Pc, as published
    mutation: Probability = 0.01  # Pm, as published
    bits: Annotated[int, Field(ge=2, le=52)] = 17
    largest_weight: Annotated[int, Field(ge=1)] = 100
    normaliser: Normaliser = Normaliser.MAX
    objectives: SearchedObjectives = SearchedObjectives.PRINTED
    seeds: Annotated[int, Field(ge=1, le=1000)] = 12

    def algorithm_settings(self, objective_count: int) -> GeneticSettings:
        """Return the settings of the algorithm for so many objectives.

        Raises:
            SearchError: fewer individuals than it needs for these.
        """
        return GeneticSettings(
            population=self.population,
            generations=self.generations,
            objectives=objective_count,
            Pc=self.crossover,
            Pm=self.mutation,
            bits=self.bits,
            largest_weight=self.largest_weight,
            normaliser=self.normaliser,
        )
