"""The published fin loop in its own sea, as tasks for tests."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from seatrial.control.front import Effort
from seatrial.control.task import Seaway, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.physics.loops import HullFactor, LoopSignal, Objective, Sampling
from seatrial.physics.loops.objective import squared_deviation, variance
from seatrial.physics.loops.structures import PUBLISHED_GAINS, Preamplifier, fin_loop
from seatrial.physics.sea.spectrum import ittc

KNOT = 0.514444
HULL = HullFactor(100.0, 10.5, 3.4)
VARIANCES = (
    variance("roll", "rad^2", LoopSignal.OUTPUT),
    variance("fin", "rad^2", LoopSignal.ACTUATOR),
    variance("fin rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
)
TARGET = squared_deviation("fin", LoopSignal.ACTUATOR, math.radians(1.0) ** 2 * 150.31, one_sided=False)
PAPER_OBJECTIVES = (VARIANCES[0], TARGET, VARIANCES[2])
PUBLISHED = np.array(list(PUBLISHED_GAINS.values()))
QUICK = Effort(refined=12, fill_rounds=4, neighbours=8000)
LIMITS = ControllerConstraints(2.0, 0.2, 0.2, math.radians(22.0), math.radians(25.0), math.radians(18.0))


def fin_task(
    preamplifier: Preamplifier = Preamplifier.WASHOUT,
    objectives: tuple[Objective, ...] = VARIANCES,
    restriction: ControllerConstraints = LIMITS,
    beta: float = math.pi / 2,
) -> TuningTask:
    """18 kn, ITTC spectrum of 3.3 m, beam sea."""
    U = 18.0 * KNOT
    met = (Seaway(ittc(3.3), U, beta, HULL),)
    return TuningTask("which gains?", "fins", "published", fin_loop(preamplifier), met, objectives, restriction, U)


def sampled_fin_task(preamplifier: Preamplifier = Preamplifier.WASHOUT, **settings: Any) -> TuningTask:
    """The same as it runs in time: `fin_task` with samples every 0.05 s."""
    task = fin_task(preamplifier, **settings)
    return replace(task, loop=replace(task.loop, sampling=Sampling(0.05)))
