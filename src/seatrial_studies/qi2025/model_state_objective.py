"""Eq. (28) from the identified model's own state: what figures 5 to 7 suggest, where the state lags the ship's."""

from seatrial.estimation.search import Fitness, one_sample_fitness
from seatrial.numerics.optimise import Population
from seatrial_studies.swarm_search import PitchUnit, SearchData, candidates_for


def model_state_objective(
    data: SearchData, optimiser: Population, pitch_unit: PitchUnit = PitchUnit.DEGREES
) -> Fitness:
    """Iteration k compares sample k alone, one step from where the best points so far have carried the model.

    Each sample is left with the best point of its own iteration, as a model that is identified while it runs; the truth
    itself then has no fitness of 0.
    """
    return one_sample_fitness(candidates_for(data, pitch_unit), optimiser)
