"""Eq. (28) from the identified model's own state: what figures 5 to 7 suggest, where the state lags the ship's."""

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Population
from seatrial.physics.simulate import discretised_hold, one_sample_fitness
from seatrial_studies.swarm_search import STEP, Fitness, PitchUnit, SearchData, candidate_matrices


def model_state_objective(
    data: SearchData, optimiser: Population, pitch_unit: PitchUnit = PitchUnit.DEGREES
) -> Fitness:
    """Iteration k compares sample k alone, one step from where the best points so far have carried the model.

    Each sample is left with the best point of its own iteration, as a model that is identified while it runs; the truth
    itself then has no fitness of 0.
    """
    sigma, forcing, begun = np.array([1.0, pitch_unit.value]), data.forcing, data.states[0]
    carried = [np.array(begun)]

    def objective(points: Array) -> Array:
        k = min(optimiser.iteration, len(data.states) - 2)
        while len(carried) <= k:
            phi, psi = discretised_hold(*candidate_matrices(optimiser.best[0][None]), STEP)
            carried.append(phi[0] @ carried[-1] + psi[0] @ data.forces[len(carried) - 1])
        A, B = candidate_matrices(points)
        return np.sqrt(0.5 * one_sample_fitness(A, B, forcing, k, carried[k], data.measured[k + 1], sigma))

    return objective
