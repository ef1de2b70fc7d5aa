"""What a search owes to the middle of its box: unknowns written as shares of their range, zero at the truth or not."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise import Box, Memory, search
from seatrial.physics.models.qi2025 import HEADINGS
from seatrial_studies.qi2025.published import Algorithm
from seatrial_studies.qi2025.repetition import ITERATIONS, NARROW, optimisers
from seatrial_studies.swarm_search import Angle, Data, one_sample

RUNS = 3
# the truth a quarter of the box's width from its middle
ASIDE = 0.5


@dataclass(frozen=True, eq=False)
class CentreBias:
    """Mean relative errors over headings, runs and coefficients, the truth at zero and a quarter of the box aside."""

    at_zero: dict[Algorithm, float]
    aside: dict[Algorithm, float]


def centre_bias(seas: dict[int, list[Data]], seed: int) -> CentreBias:
    """The paper's setting with unknowns x = (value / truth - 1) / .1 - x0 in [-1, 1]: x0 = 0, or +-.5 drawn for each.

    The fitness is the paper's; nothing but the place of the truth in the box differs.
    """
    met = [(h, run, seas[h][run]) for h in HEADINGS for run in range(RUNS)]
    at_zero, aside = (
        {a: float(np.mean([_error(data, a, shift, [seed, 17, h, run]) for h, run, data in met])) for a in Algorithm}
        for shift in (0.0, ASIDE)
    )
    return CentreBias(at_zero, aside)


def _error(data: Data, algorithm: Algorithm, shift: float, seed: list[int]) -> float:
    rng = np.random.default_rng(seed)
    middle = shift * rng.choice([-1.0, 1.0], len(data.truth))
    unit = Box(-np.ones(len(data.truth)), np.ones(len(data.truth)))
    optimiser = optimisers(ITERATIONS, Memory.RE_EVALUATE)[algorithm](unit, rng)
    judged = one_sample(data, optimiser, Angle.RADIANS)
    found = search(optimiser, lambda x: judged(data.truth * (1.0 + NARROW * (x - middle))))
    return float(np.mean(np.abs(NARROW * (found.point - middle))))
