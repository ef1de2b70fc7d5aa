"""What holding the wave force between samples costs: data from continuous waves, fitted with the hold and without."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.heave_pitch import COEFFICIENTS, heave_pitch_held
from seatrial.physics.models.qi2025 import HEADINGS
from seatrial_studies.own_fit import NOISE, started
from seatrial_studies.seaway import Voyage, sailed, ship

CONTINUOUS = Voyage(135, dt=0.1, every=5, has_fin=False, noise=(0.0, 0.0))


@dataclass(frozen=True, eq=False)
class HoldBias:
    """Relative errors (8,) without any noise, motions every .5 s, by what the model takes the wave force for.

    Attributes:
        held: constant from sample to sample; sampled: continuous, known every .5 s; fine: continuous, every .1 s.
    """

    held: Array
    sampled: Array
    fine: Array


def hold_bias(seed: int) -> dict[int, HoldBias]:
    """By heading, from waves that are continuous."""
    made = {}
    for heading in HEADINGS:
        voyage = replace(CONTINUOUS, heading=heading)
        record = sailed(voyage, np.random.default_rng([seed, 13, heading])).record
        truth = ship(heading)
        true = np.array([truth.parameters[n].value for n in COEFFICIENTS])
        coarse = record.rows(slice(None, None, voyage.every))
        held = heave_pitch_held().with_parameters(truth.parameters)
        errors = []
        for model, used in ((held, coarse), (truth, coarse), (truth, record)):
            problem = OutputError(started(model), cut(model, [used], ("z", "theta"), None), NOISE)
            found = levenberg_marquardt(problem, problem.start(), problem.measured_starts())
            errors.append(found.solution.point / true - 1.0)
        made[heading] = HoldBias(*errors)
    return made
