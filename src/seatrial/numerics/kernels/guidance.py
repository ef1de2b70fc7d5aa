"""A craft that follows a track: line of sight orders the heading that a linear controller keeps.

The memory is that of `linear_controller` with a block behind it: the head below, then the cross-track error at every
sample (count). The order is held to a rate, so that a corner is turned as fast as the craft can.
"""

import math

from numba import njit

from seatrial.numerics.kernels.feedback import (
    CONTROLLER_ORDER,
    COUNT,
    STEP,
    clamp,
    linear_controller,
    series_start,
)
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, LEAN

(
    NORTH, EAST, LOOKAHEAD, INTEGRAL_GAIN, INTEGRAL, ORDER, ORDER_STEP, LEG, CORNER, TURN, ACCEPTANCE,
    INTERVAL, NEW_LEG, TRACK_HEAD,
) = range(14)  # fmt: skip


@njit(inline="always", **LEAN)
def track_start(n, count):
    """Return the place of the block behind a controller of n states and `count` samples."""
    return series_start(n) + 4 * count + 3


@kernel(COMMAND_SIGNATURE, **LEAN)
def track_follower(t, x, memory, u):
    """Order the heading to a point of the track a lookahead distance ahead, and leave the rudder to the controller.

    psi_d = chi - atan((e + sigma q) / Delta), q' = Delta e / ((e + sigma q)^2 + Delta^2) (Borhaug, Pavlov & Pettersen
    2008, Proc. 47th IEEE CDC, 4984-4991, eqs. (5)-(6)); without sigma line of sight (Fossen 2011, Handbook of Marine
    Craft Hydrodynamics and Motion Control, eq. (10.73)). The first leg runs north; the next begins at CORNER, turned by
    TURN, and is taken within ACCEPTANCE of it along the track.
    """
    n, count, k = int(memory[CONTROLLER_ORDER]), int(memory[COUNT]), int(memory[STEP])
    reference, block = series_start(n), track_start(n, count)
    north, east = x[int(memory[block + NORTH])], x[int(memory[block + EAST])]
    if memory[block + LEG] == 0.0 and memory[block + CORNER] - north < memory[block + ACCEPTANCE]:
        memory[block + LEG], memory[block + NEW_LEG] = 1.0, k
    course, error = 0.0, east
    if memory[block + LEG] == 1.0:
        course = memory[block + TURN]
        # distance to starboard of the leg (Fossen 2011, eq. (10.58))
        error = -(north - memory[block + CORNER]) * math.sin(course) + east * math.cos(course)
    delta, total = memory[block + LOOKAHEAD], error + memory[block + INTEGRAL_GAIN] * memory[block + INTEGRAL]
    memory[block + INTEGRAL] += memory[block + INTERVAL] * delta * error / (total * total + delta * delta)
    before = memory[block + ORDER]
    order = before + clamp(course - math.atan(total / delta) - before, memory[block + ORDER_STEP])
    memory[block + ORDER] = order
    memory[reference + k] = order
    memory[reference + k + 1] = order if k == 0 else 2.0 * order - before
    memory[block + TRACK_HEAD + k] = error
    linear_controller(t, x, memory, u)
