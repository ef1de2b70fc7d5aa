"""Integration with a command in the loop, held over its step; and the command of a linear controller with an actuator.

`linear_controller` is a command(t, x, memory, u), called once at the start of each step of `steer`. The error runs
straight between samples; its value at the end of the step, on which the actuator depends only through all lags of the
controller, is extrapolated by a parabola and put right at the next call. The input held over the step is
(2 a_{k+1} + 5 a_k - a_{k-1}) / 6 of the actuator's effect a: its mean over the step, sharpened by -dt^2 / 6 a'' for
what the straight line and the hold take off.

Memory: the head below (from EVERY on it is that of `sampled_controller`, but for SERIES, where the reference begins),
then `laws` twice (free, and with the slow states held), the slow order's rate, the controller's
states and as many places of scratch, the reference (count + 1), the disturbance held over each step (count), what is
fed forward to the order (count + 1), and room for the actuator's angles (count + 1).
"""

import numpy as np
from numba import njit

from seatrial.numerics.kernels.integrate import DIVERGED, rk4_step
from seatrial.numerics.kernels.kernel import (
    COMMAND,
    COMMAND_SIGNATURE,
    F8,
    FUNCTION,
    I8,
    LEAN,
    MATRIX,
    OPTIONS,
    VECTOR,
    kernel,
)

# places in the memory
(
    CONTROLLER_ORDER, COUNT, OUTPUT, ACTUATOR, DISTURBED_INPUT, TRIM, EFFECT, LIMIT, SLEW, STALL, LOSS, STEP, ANGLE,
    EFFECTIVE_ANGLE, SATURATION_EXCESS, ANTI_WINDUP, OUTPUT_LAST, OUTPUT_BEFORE_LAST, ERROR_LAST, SERIES, EVERY,
    SENSOR, SENSOR_ORDER, SERVO, SERVO_ORDER, BLOCKS, TERM_COUNT, FILTER_COUNT, QUEUE, QUEUE_SIZE, NOISE, RESOLUTION,
    SAMPLE_SLEW, HELD_ORDER, ORDER_EXCESS, LAST_ORDER, READING_ERROR, HEAD_SIZE,
) = range(38)  # fmt: skip

_WORK_ROWS = 6  # scratch of a step: x, y and the four stages of `rk4_step`


@kernel(I8(FUNCTION, COMMAND, VECTOR, VECTOR, VECTOR, VECTOR, F8, MATRIX, MATRIX, MATRIX), **LEAN)
def _steer(f, command, x0, u, p, memory, dt, x_out, u_out, work):
    nx = x0.size
    x, y, k1, k2, k3, k4 = work[0], work[1], work[2], work[3], work[4], work[5]
    for i in range(nx):
        x[i] = x0[i]
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


def steer(f, command, x0, u_start, p, memory, dt, x_out, u_out):
    """Integrate with a command in the loop; return the step at which it diverged, or -1.

    x_out, u_out: states and the input held from that sample on, one row a step.
    """
    return _steer(f, command, x0, u_start.copy(), p, memory, dt, x_out, u_out, np.empty((_WORK_ROWS, len(x0))))


@njit(inline="always", **OPTIONS)
def controller_size(n):
    """Return the places of one law: E by columns (n, n), g0 (n), g1 (n), the order a step ahead: row (n), r0, r1."""
    return n * n + 3 * n + 2


@njit(inline="always", **OPTIONS)
def clamp(value, bound):
    """Return the value, cut to +- bound."""
    return min(max(value, -bound), bound)


@njit(**OPTIONS)
def effective_angle(angle, stall, loss):
    """Return the angle that would lift as much without stall: beyond it, `loss` is lost for each unit, down to 0."""
    size = abs(angle)
    if size <= stall:
        return angle
    left = max(stall - loss * (size - stall), 0.0)
    return left if angle > 0.0 else -left


@njit(inline="always", **OPTIONS)
def _advance(memory, law, states, n, last_error, error):
    """Advance the controller's states over the step that ends now, column by column: views become vectors."""
    g0, g1 = law + n * n, law + n * n + n
    before, now = memory[states : states + n], memory[states + n : states + 2 * n]
    for i in range(n):
        now[i] = memory[g0 + i] * last_error + memory[g1 + i] * error
    for j in range(n):
        value = before[j]
        column = memory[law + j * n : law + j * n + n]
        for i in range(n):
            now[i] += column[i] * value
    for i in range(n):
        before[i] = now[i]


@njit(inline="always", **OPTIONS)
def _row_times_states(memory, start, states, n):
    total = 0.0
    for i in range(n):
        total += memory[start + i] * memory[states + i]
    return total


@kernel(COMMAND_SIGNATURE, **LEAN)
def linear_controller(_, x, memory, u):
    """Set order, angle and effect; slow states are held while a limit bites and they would drive further into it."""
    n, count, k = int(memory[CONTROLLER_ORDER]), int(memory[COUNT]), int(memory[STEP])
    size = controller_size(n)
    slow = HEAD_SIZE + 2 * size
    states = slow + n + 1
    reference = int(memory[SERIES])
    disturbance = reference + count + 1
    fed_forward = disturbance + count
    angles = fed_forward + count + 1
    y = x[int(memory[OUTPUT])]
    error = memory[reference + k] - y
    ahead = y
    if k > 0:
        _advance(memory, HEAD_SIZE + int(memory[ANTI_WINDUP]) * size, states, n, memory[ERROR_LAST], error)
        ahead = 2.0 * y - memory[OUTPUT_LAST]
    if k > 1:
        ahead += y - 2.0 * memory[OUTPUT_LAST] + memory[OUTPUT_BEFORE_LAST]
    excess = memory[SATURATION_EXCESS]
    drift = _row_times_states(memory, slow, states, n) + memory[slow + n] * error
    memory[ANTI_WINDUP] = 1.0 if excess * drift > 0.0 else 0.0
    law = HEAD_SIZE + int(memory[ANTI_WINDUP]) * size
    row = law + n * n + 2 * n
    coming = memory[reference + k + 1] - ahead
    order = _row_times_states(memory, row, states, n) + memory[row + n] * error + memory[row + n + 1] * coming
    order += memory[fed_forward + k + 1]
    angle = memory[ANGLE]
    # clamped once more: the sum may round beyond the limit
    new = clamp(angle + clamp(clamp(order, memory[LIMIT]) - angle, memory[SLEW]), memory[LIMIT])
    is_free = abs(order) <= memory[LIMIT] and abs(order - angle) <= memory[SLEW]
    memory[SATURATION_EXCESS] = 0.0 if is_free else order - new
    stall, loss = memory[STALL], memory[LOSS]
    lift = effective_angle(new, stall, loss)
    # the mean over the step, sharpened: the formula at the head of this file
    mean = (2.0 * lift + 5.0 * effective_angle(angle, stall, loss) - memory[EFFECTIVE_ANGLE]) / 6.0
    memory[EFFECTIVE_ANGLE] = effective_angle(angle, stall, loss)
    place, disturbed = int(memory[ACTUATOR]), int(memory[DISTURBED_INPUT])
    u[place] = memory[TRIM] + memory[EFFECT] * mean
    if disturbed == place:
        u[place] += memory[disturbance + k]
    elif disturbed >= 0:
        u[disturbed] = memory[disturbance + k]
    memory[ERROR_LAST], memory[OUTPUT_BEFORE_LAST], memory[OUTPUT_LAST] = error, memory[OUTPUT_LAST], y
    memory[ANGLE] = new
    memory[angles + k + 1] = new
    memory[STEP] = k + 1.0
