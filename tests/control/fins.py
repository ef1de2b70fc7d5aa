"""The published fin loop in its own sea, as tasks for tests."""

import math

import numpy as np

from seatrial.control.front import Effort
from seatrial.control.task import Seaway, Task
from seatrial.core.results.tuning import Restriction
from seatrial.physics.loops import HullFactor, Objective, Seen
from seatrial.physics.loops.fin import PUBLISHED_GAINS, Preamplifier, fin_loop
from seatrial.physics.loops.objective import off_target, variance
from seatrial.physics.sea.spectrum import ittc

KNOT = 0.514444
HULL = HullFactor(100.0, 10.5, 3.4)
VARIANCES = (
    variance("roll", "rad^2", Seen.OUTPUT),
    variance("fin", "rad^2", Seen.ACTUATOR),
    variance("fin rate", "rad^2/s^2", Seen.ACTUATOR, 1),
)
TARGET = off_target("fin", Seen.ACTUATOR, math.radians(1.0) ** 2 * 150.31, one_sided=False)
PAPERS = (VARIANCES[0], TARGET, VARIANCES[2])
PUBLISHED = np.array(list(PUBLISHED_GAINS.values()))
QUICK = Effort(population=60, generations=20, polished=12, rounds=4, neighbours=8000)
LIMITS = Restriction(2.0, 0.2, 0.2, math.radians(22.0), math.radians(25.0), math.radians(18.0))


def fin_task(
    preamplifier: Preamplifier = Preamplifier.WASHOUT,
    objectives: tuple[Objective, ...] = VARIANCES,
    restriction: Restriction = LIMITS,
    beta: float = math.pi / 2,
) -> Task:
    """18 kn, ITTC spectrum of 3.3 m, beam sea."""
    U = 18.0 * KNOT
    met = (Seaway(ittc(3.3), U, beta, HULL),)
    return Task("which gains?", "fins", "published", fin_loop(preamplifier), met, objectives, restriction, U)
