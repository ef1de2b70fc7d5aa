"""The helmsman of turning circle and pull-out: hold the rudder over until the heading has changed by so much.

ISO 13643-3:2017 (turning circle, pull-out); IMO MSC/Circ.1053 (2002): at least 540 deg of heading.
"""

from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS
from seatrial.physics.manoeuvres.steering import (
    APPROACH,
    STAGE,
    STAGE_START,
    TABLE,
    heading_deviation,
    is_past_approach,
    next_stage,
    turn_rudder,
)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def helmsman(t, x, memory, u):
    """Table: rudder order, heading change that ends the turn [rad, both positive to starboard].

    A second stage puts the rudder amidships for as long as the turn has taken.
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
