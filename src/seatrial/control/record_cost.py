"""What a controller costs when it is judged by a simulated record in place of a spectrum: a measurement, no verdict."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.core.results.tuning import RECORD_SECONDS, RECORD_STEP
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop, state_space
from seatrial.physics.simulate.closed_loop import loop_record

_REPEATS = 3  # of which the fastest counts; chosen


@dataclass(frozen=True)
class RecordCost:
    """CPU time [s] of one record of 1000 s at 0.1 s: by a compiled scalar loop, and by scipy.signal.lsim."""

    compiled: float
    lsim: float


def record_cost(loop: TransferLoop, gains: Array, seed: int) -> RecordCost:
    """Measure records of one loop with the gains (g,) in white noise: each one holds its input exactly."""
    from scipy.signal import lsim

    states = state_space(loop)
    disturbance = np.random.default_rng(seed).standard_normal(round(RECORD_SECONDS / RECORD_STEP) + 1)
    system = (states.closed_loop_matrix(gains), states.b[:, None], states.c[None], np.zeros((1, 1)))
    times = RECORD_STEP * np.arange(len(disturbance))
    return RecordCost(
        _least_cpu_time(lambda: loop_record(states, gains, disturbance, RECORD_STEP)),
        _least_cpu_time(lambda: lsim(system, disturbance, times, interp=False)),
    )


def _least_cpu_time(run: Callable[[], object]) -> float:
    seconds = []
    for _ in range(_REPEATS):
        began = time.process_time()
        run()
        seconds.append(time.process_time() - began)
    return min(seconds)
