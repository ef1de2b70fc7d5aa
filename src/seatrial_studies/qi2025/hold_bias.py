"""What holding the wave force between samples costs: data from continuous waves, fitted with the hold and without."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem import OutputError, cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import heave_pitch_zoh
from seatrial_studies.output_error_fit import MOTION_NOISE, with_physics_start
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.seaway import SeawayScenario, ship, simulate_seaway_run

CONTINUOUS_WAVES = SeawayScenario(135, dt=0.1, motion_stride=5, has_fin=False, noise=(0.0, 0.0))


@dataclass(frozen=True, eq=False)
class HoldBias:
    """Relative errors (8,) without any noise, motions every 0.5 s, by what the model takes the wave force for.

    Attributes:
        held: constant from sample to sample; sampled: continuous, known every 0.5 s; fine: continuous, every 0.1 s.
    """

    held: Array
    sampled: Array
    fine: Array


def hold_bias(seed: int) -> dict[int, HoldBias]:
    """By heading, from waves that are continuous."""
    made = {}
    for heading in HEADINGS:
        voyage = replace(CONTINUOUS_WAVES, heading=heading)
        record = simulate_seaway_run(voyage, np.random.default_rng([seed, 13, heading])).record
        truth = ship(heading)
        true = np.array([truth.parameters[n].value for n in COEFFICIENTS])
        coarse = record.rows(slice(None, None, voyage.motion_stride))
        held = heave_pitch_zoh().with_parameters(truth.parameters)
        errors = []
        for model, used in ((held, coarse), (truth, coarse), (truth, record)):
            problem = OutputError(
                with_physics_start(model), cut_segments(model, [used], ("z", "theta"), None), MOTION_NOISE
            )
            found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states())
            errors.append(found.solution.point / true - 1.0)
        made[heading] = HoldBias(*errors)
    return made
