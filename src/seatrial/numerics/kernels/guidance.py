"""A craft that follows a track: line of sight orders the heading that a linear controller keeps.

The memory is that of `linear_controller` or `sampled_controller` with a block behind it: the head below, then the
cross-track error at every step (count). A sampled controller is given a new order at each sample. The order is held to
a rate, so that a corner is turned as fast as the craft can.
"""

import math

from seatrial.numerics.kernels.feedback import (
    COUNT,
    EVERY,
    SERIES,
    STEP,
    clamp,
    linear_controller,
)
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, LEAN, kernel
from seatrial.numerics.kernels.sampled import sampled_controller

# places in the memory
(
    NORTH, EAST, LOOKAHEAD, INTEGRAL_GAIN, INTEGRAL, ORDER, ORDER_STEP, LEG, CORNER, TURN, ACCEPTANCE,
    INTERVAL, NEW_LEG, TRACK_HEAD,
) = range(14)  # fmt: skip


@kernel(COMMAND_SIGNATURE, **LEAN)
def track_follower(t, x, memory, u):
    """Order the heading to a point of the track a lookahead distance ahead, and leave the rudder to the controller.

    psi_d = chi - atan((e + sigma q) / Delta), q' = Delta e / ((e + sigma q)^2 + Delta^2) (Borhaug, Pavlov & Pettersen
    2008, Proc. 47th IEEE CDC, 4984-4991, eqs. (5)-(6)); without sigma line of sight (Fossen 2011, Handbook of Marine
    Craft Hydrodynamics and Motion Control, eq. (10.73)). The first leg runs north; the next begins at CORNER, turned by
    TURN, and is taken within ACCEPTANCE of it along the track.
    """
    count, k, every, reference = int(memory[COUNT]), int(memory[STEP]), int(memory[EVERY]), int(memory[SERIES])
    block = reference + 4 * count + 3
    north, east = x[int(memory[block + NORTH])], x[int(memory[block + EAST])]
    if memory[block + LEG] == 0.0 and memory[block + CORNER] - north < memory[block + ACCEPTANCE]:
        memory[block + LEG], memory[block + NEW_LEG] = 1.0, k
    course, error = 0.0, east
    if memory[block + LEG] == 1.0:
        course = memory[block + TURN]
        # distance to starboard of the leg (Fossen 2011, eq. (10.58))
        error = -(north - memory[block + CORNER]) * math.sin(course) + east * math.cos(course)
    memory[block + TRACK_HEAD + k] = error
    if every > 1 and k % every != 0:
        sampled_controller(t, x, memory, u)
        return
    delta, total = memory[block + LOOKAHEAD], error + memory[block + INTEGRAL_GAIN] * memory[block + INTEGRAL]
    memory[block + INTEGRAL] += memory[block + INTERVAL] * delta * error / (total * total + delta * delta)
    before = memory[block + ORDER]
    order = before + clamp(course - math.atan(total / delta) - before, memory[block + ORDER_STEP])
    memory[block + ORDER] = order
    memory[reference + k] = order
    if every > 0:
        sampled_controller(t, x, memory, u)
        return
    memory[reference + k + 1] = order if k == 0 else 2.0 * order - before
    linear_controller(t, x, memory, u)
