"""What a helmsman knows of the ship he steers, and the memory in which he keeps it.

A helmsman is a compiled command(t, x, memory, u), called once at the start of each step; he writes u[DELTA] and leaves
the other inputs alone. He thinks in angles positive to starboard, whatever the model's own sign; the input he writes
is the mean of the rudder angle at the start and at the end of the step, because the integrator holds it over the step.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from seatrial.core.values import Array
from seatrial.numerics.kernels.types import OPTIONS

# positions in the memory
PSI, R, DELTA, SIGN, SLEW, DT, APPROACH, COURSE, ANGLE, FINISHED, STAGE, STAGE_START, COUNT, TABLE = range(14)
NOT_FINISHED = -1.0


@dataclass(frozen=True)
class Steering:
    """Where a helmsman finds heading and rudder in a model, and how fast the rudder moves.

    Attributes:
        psi, r: places of heading and yaw rate among the states; r is -1 where there is none.
        delta: place of the rudder among the inputs.
        sign: +1 where a positive input turns to starboard, -1 where it turns to port.
        slew_rate: rad/s.
        dt: step of the simulation [s].
        approach: s before the first execute.
        characteristic_time: L/U0 [s], the time in which the ship travels its length.
    """

    psi: int
    r: int
    delta: int
    sign: float
    slew_rate: float
    dt: float
    approach: float
    characteristic_time: float

    def memory(self, count: int, table: Sequence[float]) -> Array:
        """The helmsman's initial memory, shape (TABLE + len(table),): `count` stages, described in `table`."""
        head = np.zeros(TABLE)
        head[[PSI, R, DELTA, SIGN, SLEW]] = self.psi, self.r, self.delta, self.sign, self.slew_rate * self.dt
        head[[DT, APPROACH, FINISHED, COUNT]] = self.dt, self.approach, NOT_FINISHED, count
        return np.concatenate([head, np.asarray(table, dtype=np.float64)])


@njit(**OPTIONS)
def turn_rudder(memory, order, u):
    """Move the rudder towards `order` [rad, positive to starboard] by at most one step of the slew rate."""
    before = memory[ANGLE]
    step = min(max(order - before, -memory[SLEW]), memory[SLEW])
    memory[ANGLE] = before + step
    u[int(memory[DELTA])] = memory[SIGN] * (before + 0.5 * step)


@njit(**OPTIONS)
def is_past_approach(t, x, memory):
    """Whether the approach is over; the heading of that moment becomes the original course."""
    if memory[STAGE] == 0.0:
        if t < memory[APPROACH] - 0.5 * memory[DT]:
            return False
        memory[COURSE], memory[STAGE], memory[STAGE_START] = x[int(memory[PSI])], 1.0, t
    return True


@njit(**OPTIONS)
def heading_deviation(x, memory):
    """Heading off the original course [rad] half a step ahead, so that executes at samples are not late on average."""
    place = int(memory[R])
    lead = 0.5 * memory[DT] * x[place] if place >= 0 else 0.0
    return x[int(memory[PSI])] + lead - memory[COURSE]


@njit(**OPTIONS)
def next_stage(t, memory):
    """Go to the next stage; after the last one note the time and stay."""
    if memory[FINISHED] >= 0.0:
        return
    if memory[STAGE] >= memory[COUNT]:
        memory[FINISHED] = t
    else:
        memory[STAGE] += 1.0
        memory[STAGE_START] = t


def rudder_angles(step_means: Array) -> Array:
    """Rudder angle at the samples, shape (n,), from the step means a helmsman wrote, shape (n,); amidships at first."""
    signs = np.where(np.arange(len(step_means)) % 2, 1.0, -1.0)
    angles = np.zeros(len(step_means))
    angles[1:] = np.cumsum(2.0 * signs[:-1] * step_means[:-1]) * signs[:-1]
    return np.round(angles, 14) + 0.0
