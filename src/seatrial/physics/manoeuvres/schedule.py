"""The helmsman who follows a timetable: every rudder angle is held for the same time. Spiral and binary sequences.

Direct (Dieudonne) spiral: ISO 13643-3:2017; pseudo-random binary sequence: Soderstrom & Stoica 1989, section 5.3.
"""

import numpy as np

from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS
from seatrial.physics.manoeuvres.steering import (
    DT,
    STAGE,
    STAGE_START,
    TABLE,
    is_past_approach,
    next_stage,
    turn_rudder,
)

REGISTER_BITS = 9  # of the shift register: 511 switching times a period; chosen


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def helmsman(t, x, memory, u):
    """Table: holding time [s], then the rudder orders [rad, positive to starboard]."""
    order = 0.0
    if is_past_approach(t, x, memory):
        if t - memory[STAGE_START] >= memory[TABLE] - 0.5 * memory[DT]:
            next_stage(t, memory)
        order = memory[TABLE + int(memory[STAGE])]
    turn_rudder(memory, order, u)


def spiral_steps(largest: float, side: int) -> tuple[float, ...]:
    """Rudder orders [rad] from `largest` [deg] through amidships to the other side and back (direct spiral)."""
    # deg, steps of the direct spiral, closer near amidships; chosen
    inner = [a for a in (25.0, 20.0, 15.0, 10.0, 5.0, 3.0, 1.0) if a < largest]
    down = [largest, *inner, 0.0, *(-a for a in reversed(inner)), -largest]
    return tuple(side * float(np.radians(a)) for a in (*down, *down[-2::-1]))


def binary_sequence(amplitude: float, seed: int) -> tuple[float, ...]:
    """Rudder orders [rad] of one period of a maximum length sequence, 2^9 - 1 switching times; the seed shifts it."""
    from scipy.signal import max_len_seq

    state = np.random.default_rng(seed).permutation([1] * 5 + [0] * (REGISTER_BITS - 5))
    bits = max_len_seq(REGISTER_BITS, state=state)[0]
    return tuple(float(a) for a in np.radians(amplitude) * (2.0 * bits - 1.0))
