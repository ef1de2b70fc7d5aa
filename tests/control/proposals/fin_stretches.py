"""A schedule for the example's fins and simulated stretches, for tests of proposals."""

import math
from functools import cache
from itertools import product

import numpy as np
from benchmarks.proposals import EXAMPLE, Weather, stretch
from tests.control.loop_files import in_continuous_time

from seatrial import api
from seatrial.control.proposals import Stretch
from seatrial.control.schedule import GainSchedule, gain_schedule, schedule_conditions
from seatrial.control.task import ScheduleGrid, TuningTask
from seatrial.core.results.tuning import OperatingPoint
from seatrial.estimation.sea import altered_loop
from seatrial.physics.loops.structures import PUBLISHED_GAINS

TASK = in_continuous_time(api.load_loop(EXAMPLE))
SPEEDS, HEADINGS, HEIGHTS = (7.0, 9.26, 11.5), (0.4, math.pi / 2, 2.7), (1.0, 3.0, 6.0)
SHIP = np.log([1.1, 1.03, 0.9])


@cache
def points(task: TuningTask = TASK) -> tuple[OperatingPoint, ...]:
    """Gains that are linear in every condition, with the Ms that the loop has."""
    made = []
    for U, beta, height in product(SPEEDS, HEADINGS, HEIGHTS):
        gains = {"KP": 25.0 - 1.5 * U, "KI": 40.0 - 3.0 * height, "KD": 40.0 + 4.0 * beta}
        grid = ScheduleGrid((U,), (beta,), (height,))
        judged = schedule_conditions(task, grid)[0].evaluator.evaluate(np.array([list(gains.values())]))
        made.append(OperatingPoint(U, beta, height, gains, 0.4, float(judged.Ms[0]), 0.1, {}, is_feasible=True))
    return tuple(made)


def fin_schedule() -> GainSchedule:
    """The schedule of these points."""
    return gain_schedule(points(), TASK.loop.gains.names)


def fin_stretch(seed: int, weather: Weather) -> Stretch:
    """Twenty minutes of a ship whose fins do a tenth more than the model says, with the published gains on."""
    loop = altered_loop(TASK.loop_at(weather.U), SHIP)
    on = np.array([PUBLISHED_GAINS[name] for name in loop.gains.names])
    return stretch(TASK, loop.with_gains(on), weather, np.random.default_rng(seed))


QUARTERING = Weather(9.26, math.radians(60.0), math.log(3.0), math.log(0.02), 0.0)
