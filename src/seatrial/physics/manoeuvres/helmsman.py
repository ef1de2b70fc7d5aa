"""Helmsmen, and what they know of the ship they steer: compiled commands that work through a table.

A helmsman is a command(t, x, memory, u), called once at the start of each step; he writes u[DELTA] and leaves the other
inputs alone. He thinks in angles positive to starboard, whatever the model's own sign; the input he writes is the mean
of the rudder angle at the start and at the end of the step, because the integrator holds it over the step.

ISO 13643-3:2017 (zig-zag test, turning circle, pull-out, direct spiral of Dieudonne); IMO MSC/Circ.1053 (2002),
explanatory notes to MSC.137(76), section 2.1 (zigzag; turning circle of at least 540 deg of heading); pseudo-random
binary sequence: Soderstrom & Stoica 1989, section 5.3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from seatrial.core.values import Array
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS

# positions in the memory
PSI, R, DELTA, SIGN, SLEW, DT, APPROACH, COURSE, ANGLE, FINISHED, STAGE, STAGE_START, COUNT, TABLE = range(14)
NOT_FINISHED = -1.0
REGISTER_BITS, _ONES = 9, 5  # of the shift register: 511 switching times a period; ones at its start; chosen


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
        """Return the helmsman's initial memory, shape (TABLE + len(table),): `count` stages, described in `table`."""
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
    """Return whether the approach is over; the heading of that moment becomes the original course."""
    if memory[STAGE] == 0.0:
        if t < memory[APPROACH] - 0.5 * memory[DT]:
            return False
        memory[COURSE], memory[STAGE], memory[STAGE_START] = x[int(memory[PSI])], 1.0, t
    return True


@njit(**OPTIONS)
def heading_deviation(x, memory):
    """Return the heading off the course [rad] half a step ahead, so that executes are not late on average."""
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
    return np.round(angles, 14) + 0.0  # 14 decimals: rounding of the sums


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def turning(t, x, memory, u):
    """Hold the rudder over until the heading has changed by so much.

    Table: rudder order, heading change that ends the turn [rad, both positive to starboard]. A second stage puts the
    rudder amidships for as long as the turn has taken.
    """
    order = 0.0
    if is_past_approach(t, x, memory):
        if memory[STAGE] == 1.0:
            over = heading_deviation(x, memory) / memory[TABLE + 1] >= 1.0
        else:
            over = t - memory[STAGE_START] >= memory[STAGE_START] - memory[APPROACH]
        if over:
            next_stage(t, memory)
        order = memory[TABLE] if memory[STAGE] == 1.0 else 0.0
    turn_rudder(memory, order, u)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def zigzag(t, x, memory, u):
    """Reverse the rudder when the heading has deviated by the switching heading.

    Table: order and switching heading [rad, positive to starboard] of every execute.
    """
    order = 0.0
    if is_past_approach(t, x, memory):
        place = TABLE + 2 * (int(memory[STAGE]) - 1)
        switching = memory[place + 1]
        if heading_deviation(x, memory) * np.sign(switching) >= abs(switching):
            next_stage(t, memory)
        order = memory[TABLE + 2 * (int(memory[STAGE]) - 1)]
    turn_rudder(memory, order, u)


def zigzag_table(executes: list[tuple[float, float]], side: int) -> tuple[float, ...]:
    """Return orders and switching headings [rad] of executes given as (rudder, heading) [deg]; the first to `side`."""
    signs = [side * (1 - 2 * (k % 2)) for k in range(len(executes))]
    return tuple(s * float(np.radians(a)) for s, pair in zip(signs, executes, strict=True) for a in pair)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def timetable(t, x, memory, u):
    """Hold each order for the same time. Table: that time [s], the orders [rad, positive to starboard]."""
    order = 0.0
    if is_past_approach(t, x, memory):
        if t - memory[STAGE_START] >= memory[TABLE] - 0.5 * memory[DT]:
            next_stage(t, memory)
        order = memory[TABLE + int(memory[STAGE])]
    turn_rudder(memory, order, u)


def spiral_steps(largest: float, side: int) -> tuple[float, ...]:
    """Return rudder orders [rad] from `largest` [deg] through amidships to the other side and back (direct spiral)."""
    # deg, steps of the direct spiral, closer near amidships; chosen
    inner = [a for a in (25.0, 20.0, 15.0, 10.0, 5.0, 3.0, 1.0) if a < largest]
    down = [largest, *inner, 0.0, *(-a for a in reversed(inner)), -largest]
    return tuple(side * float(np.radians(a)) for a in (*down, *down[-2::-1]))


def binary_sequence(amplitude: float, seed: int) -> tuple[float, ...]:
    """Rudder orders [rad] of one period of a maximum length sequence, 2^9 - 1 switching times; the seed shifts it."""
    from scipy.signal import max_len_seq

    state = np.random.default_rng(seed).permutation([1] * _ONES + [0] * (REGISTER_BITS - _ONES))
    bits = max_len_seq(REGISTER_BITS, state=state)[0]
    return tuple(float(a) for a in np.radians(amplitude) * (2.0 * bits - 1.0))
