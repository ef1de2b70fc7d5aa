"""Integration with a command in the loop: a controller that samples, and a track followed."""

import math

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
from seatrial.numerics.kernels.linear import advance

# Integration with a command in the loop, held over its step.

# places in the memory: what every controller that samples has, then those of one that moves an actuator
(
    COUNT, STEP, EVERY, LAW, QUEUE, QUEUE_SIZE, NOISE, RESOLUTION, SERIES, ANSWERS, DISTURBED_INPUT, TRACK, OUTPUT,
    ACTUATOR, TRIM, EFFECT, LIMIT, SLEW, STALL, LOSS, ANGLE, SENSOR, SENSOR_ORDER, SERVO, SERVO_ORDER, TERM_COUNT,
    FILTER_COUNT, SAMPLE_SLEW, HELD_ORDER, ORDER_EXCESS, LAST_ORDER, READING_ERROR, HEAD_SIZE,
) = range(33)  # fmt: skip

_WORK_ROWS = 6  # scratch of a step: x, y and the four stages of `rk4_step`


@kernel(
    I8(FUNCTION, COMMAND, VECTOR, VECTOR, VECTOR, VECTOR, F8, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX), **LEAN
)
def _steer(f, command, x0, u, p, memory, dt, e, g0, g1, x_out, u_out, work):
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
        for j in range(u_out.shape[1]):
            u_out[row, j] = u[j]
        if not size < DIVERGED:
            return row
        size = advance(e, g0, g1, x, u, u, y) if e.size > 0 else rk4_step(f, t, x, u, u, u, p, dt, k1, k2, k3, k4, y)
    return -1


_NOT_LINEAR = (np.empty((0, 0)),) * 3


def steer(f, command, x0, u_start, p, memory, dt, x_out, u_out, exact=_NOT_LINEAR):
    """Integrate with a command in the loop; return the step at which it diverged, or -1.

    x_out, u_out: states and the input held from that sample on, one row a step. exact: of an affine model e (nx, nx),
    g0, g1 (nx, nu + 1) over a step, the constant 1 as the last input; then no step of Runge and Kutta is taken.
    """
    work = np.empty((_WORK_ROWS, len(x0)))
    return _steer(f, command, x0, np.append(u_start, 1.0), p, memory, dt, *exact, x_out, u_out, work)


@njit(inline="always", **OPTIONS)
def given(memory, row, k):
    """Return what is given to the loop at a step: its references and what disturbs it, a row each."""
    return memory[int(memory[SERIES]) + row * int(memory[COUNT]) + k]


@njit(inline="always", **OPTIONS)
def answer(memory, row, k, value):
    """Write what the loop answers at a step, in the row of that answer; there is one step more than is given."""
    memory[int(memory[ANSWERS]) + row * (int(memory[COUNT]) + 1) + k] = value


@njit(inline="always", **OPTIONS)
def read(memory, value, k):
    """Return a value as the sample of a step reads it: with that sample's noise, in steps."""
    noisy, unit = value + memory[int(memory[NOISE]) + k // int(memory[EVERY])], memory[RESOLUTION]
    return unit * math.floor(noisy / unit + 0.5) if unit > 0.0 else noisy


@njit(inline="always", **OPTIONS)
def late(memory, place, k, order):
    """Return the order that acts in a step and let the present one wait for the dead time; place: of the order."""
    size = int(memory[QUEUE_SIZE])
    if size == 0:
        return order
    slot = int(memory[QUEUE]) + place * size + k % size
    acting = memory[slot]
    memory[slot] = order
    return acting


@njit(inline="always", **OPTIONS)
def law_size(n):
    """Return the places of a law: E by columns (n, n), g0 (n), g1 (n), c (n), d; its states (n) stand behind it."""
    return n * n + 3 * n + 1


@njit(inline="always", **OPTIONS)
def clamp(value, bound):
    """Return the value, cut to +- bound."""
    return min(max(value, -bound), bound)


@njit(inline="always", **OPTIONS)
def _followed(value, order, limit, slew):
    """Return where a value goes in a step after its order: to the order itself where the limits let it.

    A sum that rounds beside the order would look as if a limit had held it.
    """
    if abs(order) <= limit and abs(order - value) <= slew:
        return order
    return clamp(value + clamp(clamp(order, limit) - value, slew), limit)


@njit(inline="always", **OPTIONS)
def effective_angle(angle, stall, loss):
    """Return the angle that would lift as much without stall: beyond it, `loss` is lost for each unit, down to 0."""
    size = abs(angle)
    if size <= stall:
        return angle
    left = max(stall - loss * (size - stall), 0.0)
    return left if angle > 0.0 else -left


@njit(inline="always", **OPTIONS)
def _advance(memory, law, states, n, last_error, error):
    """Advance the states of a law over the step that ends now, column by column: views become vectors."""
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


# The command of a controller that samples: difference equations, an order that is held and acts late, and limits.

REFERENCE, DISTURBANCE, FED_FORWARD = range(3)
"""Rows of what is given; the answer is the actuator's angle."""
# places of a block in the memory: order, gain, sign of what it holds, last output, and where its numbers begin
BLOCK_ORDER, BLOCK_GAIN, BLOCK_HOLDS, BLOCK_LAST, BLOCK_HEAD = range(5)


@njit(inline="always", **OPTIONS)
def _sense(memory, error):
    """Move the sensor on by an error that ran straight since the last step, and what was misread then and stood."""
    n, at = int(memory[SENSOR_ORDER]), int(memory[SENSOR])
    states, misread = at + law_size(n), memory[READING_ERROR]
    last = states + 2 * n
    if memory[STEP] > 0.0:
        _advance(memory, at, states, n, memory[last] + misread, error + misread)
    memory[last] = error


@njit(inline="always", **OPTIONS)
def _answer(memory, law, n, value):
    """Return what a law shows of a value now: c x + d value."""
    c = law + n * n + 2 * n
    return memory[c + n] * value + _row_times_states(memory, c, law + law_size(n), n)


@njit(inline="always", **OPTIONS)
def _through(memory, block, x, push):
    """Return the answer of a block's difference equation; one that holds keeps its last where it would push further.

    push: excess of the last order over what the actuator could do, times the gain.
    """
    n = int(memory[block + BLOCK_ORDER])
    b = block + BLOCK_HEAD
    a, states = b + n + 1, b + 2 * n + 2
    y = memory[b] * x
    if n > 0:
        y += memory[states]
    if memory[block + BLOCK_HOLDS] * push * (y - memory[block + BLOCK_LAST]) > 0.0:
        y = memory[block + BLOCK_LAST]
    memory[block + BLOCK_LAST] = y
    for i in range(n):
        following = memory[states + i + 1] if i + 1 < n else 0.0
        memory[states + i] = following + memory[b + i + 1] * x - memory[a + i + 1] * y
    return y


@njit(inline="always", **OPTIONS)
def _ordered(memory, error, fed_forward):
    """Return the order of a sample: terms in parallel, filters in a row, what is fed forward."""
    excess, order, at = memory[ORDER_EXCESS], 0.0, int(memory[LAW])
    for _ in range(int(memory[TERM_COUNT])):
        gain = memory[at + BLOCK_GAIN]
        order += gain * _through(memory, at, error, excess * gain)
        at += BLOCK_HEAD + 3 * int(memory[at + BLOCK_ORDER]) + 2
    for _ in range(int(memory[FILTER_COUNT])):
        order = _through(memory, at, order, 0.0)
        at += BLOCK_HEAD + 3 * int(memory[at + BLOCK_ORDER]) + 2
    order += fed_forward
    held = _followed(memory[HELD_ORDER], order, memory[LIMIT], memory[SAMPLE_SLEW])
    memory[HELD_ORDER] = held
    return order, order - held


@njit(inline="always", **OPTIONS)
def _served(memory, order):
    """Return what the servo would do without limits at the start and the end of a step in which an order stands."""
    n, at = int(memory[SERVO_ORDER]), int(memory[SERVO])
    before = _answer(memory, at, n, order)
    _advance(memory, at, at + law_size(n), n, order, order)
    return before, _answer(memory, at, n, order)


@kernel(COMMAND_SIGNATURE, **LEAN)
def sampled_controller(_, x, memory, u):
    """Sample where it is time, let the order wait, and move the actuator within its limits."""
    k = int(memory[STEP])
    output, disturbance = x[int(memory[OUTPUT])], given(memory, DISTURBANCE, k)
    error = given(memory, REFERENCE, k) - output
    _sense(memory, error)
    if k % int(memory[EVERY]) == 0:
        misread = output - read(memory, output, k)
        memory[READING_ERROR] = misread
        seen = _answer(memory, int(memory[SENSOR]), int(memory[SENSOR_ORDER]), error + misread)
        memory[LAST_ORDER], memory[ORDER_EXCESS] = _ordered(memory, seen, given(memory, FED_FORWARD, k))
    begun, wanted = _served(memory, late(memory, 0, k, memory[LAST_ORDER]))
    begun, wanted = clamp(begun, memory[LIMIT]), clamp(wanted, memory[LIMIT])
    angle, slew = memory[ANGLE], memory[SLEW]
    new = _followed(angle, wanted, memory[LIMIT], slew)
    # a triangle is lost where the actuator first has to catch up with an order that jumped
    gap = begun - angle
    mean = 0.5 * (begun + new) - 0.5 * gap * min(abs(gap) / slew, 1.0) if new == wanted else 0.5 * (angle + new)
    lift = effective_angle(mean, memory[STALL], memory[LOSS])
    place, disturbed = int(memory[ACTUATOR]), int(memory[DISTURBED_INPUT])
    u[place] = memory[TRIM] + memory[EFFECT] * lift
    if disturbed == place:
        u[place] += disturbance
    elif disturbed >= 0:
        u[disturbed] = disturbance
    memory[ANGLE] = new
    answer(memory, 0, k + 1, new)
    memory[STEP] = k + 1.0


# A craft that follows a track: line of sight orders the heading that a controller keeps.

# places in the memory
(
    NORTH, EAST, LOOKAHEAD, INTEGRAL_GAIN, INTEGRAL, ORDER, ORDER_STEP, LEG, CORNER, TURN, ACCEPTANCE,
    INTERVAL, TRACK_HEAD,
) = range(13)  # fmt: skip


@kernel(COMMAND_SIGNATURE, **LEAN)
def track_follower(t, x, memory, u):
    """Order the heading to a point of the track a lookahead distance ahead, and leave the rudder to the controller.

    psi_d = chi - atan((e + sigma q) / Delta), q' = Delta e / ((e + sigma q)^2 + Delta^2) (Borhaug, Pavlov & Pettersen
    2008, Proc. 47th IEEE CDC, 4984-4991, eqs. (5)-(6)); without sigma line of sight (Fossen 2011, Handbook of Marine
    Craft Hydrodynamics and Motion Control, eq. (10.73)). The first leg runs north; the next begins at CORNER, turned by
    TURN, and is taken within ACCEPTANCE of it along the track.
    """
    k, block = int(memory[STEP]), int(memory[TRACK])
    north, east = x[int(memory[block + NORTH])], x[int(memory[block + EAST])]
    if memory[block + LEG] == 0.0 and memory[block + CORNER] - north < memory[block + ACCEPTANCE]:
        memory[block + LEG] = 1.0
    course, error = 0.0, east
    if memory[block + LEG] == 1.0:
        course = memory[block + TURN]
        # distance to starboard of the leg (Fossen 2011, eq. (10.58))
        error = -(north - memory[block + CORNER]) * math.sin(course) + east * math.cos(course)
    answer(memory, 1, k, error)
    answer(memory, 2, k, memory[block + LEG])
    if k % int(memory[EVERY]) != 0:
        sampled_controller(t, x, memory, u)
        return
    delta, total = memory[block + LOOKAHEAD], error + memory[block + INTEGRAL_GAIN] * memory[block + INTEGRAL]
    memory[block + INTEGRAL] += memory[block + INTERVAL] * delta * error / (total * total + delta * delta)
    before = memory[block + ORDER]
    order = before + clamp(course - math.atan(total / delta) - before, memory[block + ORDER_STEP])
    memory[block + ORDER] = order
    memory[int(memory[SERIES]) + k] = order
    sampled_controller(t, x, memory, u)
