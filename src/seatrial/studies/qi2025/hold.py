"""What holding the wave force between samples costs: data from continuous waves, fitted with the hold and without."""

from dataclasses import replace

import numpy as np

from seatrial.models.heave_pitch import COEFFICIENTS, heave_pitch_held
from seatrial.models.qi2025 import HEADINGS
from seatrial.optimise import levenberg_marquardt
from seatrial.problem.output_error import OutputError
from seatrial.problem.segments import cut
from seatrial.studies.own_fit import NOISE, started
from seatrial.studies.seaway import Voyage, sailed, ship
from seatrial.values import Array

CONTINUOUS = Voyage(135, dt=0.1, every=5, has_fin=False, noise=(0.0, 0.0))


def hold_bias(seed: int) -> dict[int, tuple[Array, Array]]:
    """Errors without any noise of data from continuous waves at .5 s, by heading: held between samples, and exact."""
    made = {}
    for heading in HEADINGS:
        voyage = replace(CONTINUOUS, heading=heading)
        record = sailed(voyage, np.random.default_rng([seed, 13, heading])).record
        truth = ship(heading)
        true = np.array([truth.parameters[n].value for n in COEFFICIENTS])
        coarse = record.rows(slice(None, None, voyage.every))
        held = heave_pitch_held().with_parameters(truth.parameters)
        errors = []
        for model, used in ((held, coarse), (truth, record)):
            problem = OutputError(started(model), cut(model, [used], ("z", "theta"), None), NOISE)
            found = levenberg_marquardt(problem, problem.start(), problem.measured_starts())
            errors.append(found.solution.point / true - 1.0)
        made[heading] = (errors[0], errors[1])
    return made
