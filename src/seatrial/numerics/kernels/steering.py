"""Integration with a command in the loop: a helmsman, a slew limit; what it orders is held over its step."""

import numpy as np

from seatrial.numerics.kernels.integrate import DIVERGED, rk4_step
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND, F8, FUNCTION, I8, MATRIX, OPTIONS, VECTOR


@kernel(I8(FUNCTION, COMMAND, VECTOR, VECTOR, VECTOR, VECTOR, F8, MATRIX, MATRIX), **OPTIONS)
def steer(f, command, x0, u_start, p, memory, dt, x_out, u_out):
    """Integrate with a command in the loop; returns the step at which it diverged, or -1.

    x_out, u_out: states and the input held from that sample on, one row a step.
    """
    nx = x0.size
    x, y = x0.copy(), np.empty(nx)
    k1, k2, k3, k4 = np.empty(nx), np.empty(nx), np.empty(nx), np.empty(nx)
    u = u_start.copy()
    size = 0.0
    for row in range(x_out.shape[0]):
        t = row * dt
        command(t, x, memory, u)
        for i in range(nx):
            x_out[row, i] = x[i]
        for j in range(u.size):
            u_out[row, j] = u[j]
        if not size < DIVERGED:
            return row
        size = rk4_step(f, t, x, u, u, u, p, dt, k1, k2, k3, k4, y)
    return -1
