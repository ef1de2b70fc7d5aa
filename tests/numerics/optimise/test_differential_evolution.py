"""Trials of differential evolution, each traced back to the vectors it was made from."""

from itertools import permutations

import numpy as np
from tests.numerics.optimise.landscapes import BOX, SQUARE

from seatrial.numerics.optimise import DifferentialEvolution, EvolutionSettings


def test_every_trial_is_made_from_three_other_vectors_and_stays_half_way_to_the_wall() -> None:
    evolution = DifferentialEvolution(BOX, np.random.default_rng(3), EvolutionSettings(6, F=0.9, CR=0.6))
    x = evolution.ask()
    evolution.tell(SQUARE(x))
    walled = 0
    for i, trial in enumerate(evolution.ask()):
        taken = trial != x[i]
        assert taken.any()
        made = []
        for a, b, c in permutations([k for k in range(6) if k != i], 3):
            mutant = x[a] + 0.9 * (x[b] - x[c])
            low, high = mutant < BOX.lower, mutant > BOX.upper
            mutant = np.where(low, (x[i] + BOX.lower) / 2, np.where(high, (x[i] + BOX.upper) / 2, mutant))
            if np.allclose(trial[taken], mutant[taken], rtol=1e-13):
                made.append(np.sum((low | high) & taken))
        assert len(made) == 1
        walled += made[0]
    assert walled > 0


def test_without_crossover_one_component_changes() -> None:
    evolution = DifferentialEvolution(BOX, np.random.default_rng(3), EvolutionSettings(20, CR=0.0))
    x = evolution.ask()
    evolution.tell(SQUARE(x))
    assert np.sum(evolution.ask() != x, axis=1).tolist() == [1] * 20
