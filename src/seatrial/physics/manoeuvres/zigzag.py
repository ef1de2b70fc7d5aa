"""The zigzag helmsman: reverse the rudder when the heading has deviated by the switching heading.

ISO 13643-3:2017, zig-zag test; IMO MSC/Circ.1053 (2002), explanatory notes to MSC.137(76), section 2.1.
"""

import numpy as np

from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS
from seatrial.physics.manoeuvres.steering import (
    STAGE,
    TABLE,
    heading_deviation,
    is_past_approach,
    next_stage,
    turn_rudder,
)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def helmsman(t, x, memory, u):
    """Table: order and switching heading [rad, positive to starboard] of every execute."""
    order = 0.0
    if is_past_approach(t, x, memory):
        place = TABLE + 2 * (int(memory[STAGE]) - 1)
        switching = memory[place + 1]
        if heading_deviation(x, memory) * np.sign(switching) >= abs(switching):
            next_stage(t, memory)
        order = memory[TABLE + 2 * (int(memory[STAGE]) - 1)]
    turn_rudder(memory, order, u)


def table(executes: list[tuple[float, float]], side: int) -> tuple[float, ...]:
    """Orders and switching headings [rad] of executes given as (rudder, heading) [deg]; the first to `side`."""
    signs = [side * (1 - 2 * (k % 2)) for k in range(len(executes))]
    return tuple(s * float(np.radians(a)) for s, pair in zip(signs, executes, strict=True) for a in pair)
