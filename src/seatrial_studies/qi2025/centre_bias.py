"""What a search owes to the middle of its box: unknowns written as shares of their range, zero at the truth or not."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise import Box, FitnessMemory, search
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import ITERATIONS, NARROW_HALF_WIDTH, optimisers
from seatrial_studies.swarm_search import PitchUnit, SearchData, one_sample_objective

RUNS = 3
# the truth a quarter of the box's width from its middle
OFF_CENTRE_SHIFT = 0.5


@dataclass(frozen=True, eq=False)
class CentreBias:
    """Mean relative errors over headings, runs and coefficients, the truth at zero and a quarter of the box aside."""

    truth_at_centre: dict[SearchAlgorithm, float]
    truth_off_centre: dict[SearchAlgorithm, float]


def centre_bias(seas: dict[int, list[SearchData]], seed: int) -> CentreBias:
    """The paper's setting with unknowns x = (value / truth - 1) / 0.1 - x0 in [-1, 1]: x0 = 0, or +-0.5 drawn for each.

    The fitness is the paper's; nothing but the place of the truth in the box differs.
    """
    met = [(h, run, seas[h][run]) for h in HEADINGS for run in range(RUNS)]
    at_zero, aside = (
        {
            a: float(np.mean([_mean_error(data, a, shift, [seed, 17, h, run]) for h, run, data in met]))
            for a in SearchAlgorithm
        }
        for shift in (0.0, OFF_CENTRE_SHIFT)
    )
    return CentreBias(at_zero, aside)


def _mean_error(data: SearchData, algorithm: SearchAlgorithm, shift: float, seed: list[int]) -> float:
    rng = np.random.default_rng(seed)
    middle = shift * rng.choice([-1.0, 1.0], len(data.truth))
    unit = Box(-np.ones(len(data.truth)), np.ones(len(data.truth)))
    optimiser = optimisers(ITERATIONS, FitnessMemory.RE_EVALUATE)[algorithm](unit, rng)
    judged = one_sample_objective(data, optimiser, PitchUnit.RADIANS)
    found = search(optimiser, lambda x: judged(data.truth * (1.0 + NARROW_HALF_WIDTH * (x - middle))))
    return float(np.mean(np.abs(NARROW_HALF_WIDTH * (found.point - middle))))
