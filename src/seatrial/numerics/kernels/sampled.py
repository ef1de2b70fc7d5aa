"""The command of a controller that samples: difference equations, an order that is held and acts late, and limits.

`sampled_controller` is a command(t, x, memory, u), called once at the start of each step of `steer`; every so many
steps the controller samples the output, misread by noise and by its resolution until the next sample, through the
sensor. Between samples the order stands, waits in a queue for the dead time, and moves the servo,
exactly for an input that is held; the actuator follows within its limits, and its mean over the step acts.

Memory: the head of `feedback`, then, at the places it names, sensor (E by columns, g0, g1, c, d, states, scratch, last
error), servo (E by columns, g, c, d, states, scratch), terms and filters, the queue of orders, and the series of
`feedback`; the noise of each sample stands behind the queue. A block: order, gain, the sign of its share of the order
where it holds (else 0), its last output, b, a, states.
"""

import math

from numba import njit

from seatrial.numerics.kernels.feedback import (
    ACTUATOR,
    ANGLE,
    BLOCKS,
    COUNT,
    DISTURBED_INPUT,
    EFFECT,
    EVERY,
    FILTER_COUNT,
    HELD_ORDER,
    LAST_ORDER,
    LIMIT,
    LOSS,
    NOISE,
    ORDER_EXCESS,
    OUTPUT,
    QUEUE,
    QUEUE_SIZE,
    READING_ERROR,
    RESOLUTION,
    SAMPLE_SLEW,
    SENSOR,
    SENSOR_ORDER,
    SERIES,
    SERVO,
    SERVO_ORDER,
    SLEW,
    STALL,
    STEP,
    TERM_COUNT,
    TRIM,
    clamp,
    effective_angle,
)
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, LEAN, OPTIONS, kernel

# places of a block in the memory: order, gain, sign of what it holds, last output, and where its numbers begin
BLOCK_ORDER, BLOCK_GAIN, BLOCK_HOLDS, BLOCK_LAST, BLOCK_HEAD = range(5)


@njit(**OPTIONS)
def _sense(memory, error):
    """Move the sensor on by an error that ran straight since the last step, and what was misread then and stood."""
    n, at = int(memory[SENSOR_ORDER]), int(memory[SENSOR])
    g0 = at + n * n
    g1, c = g0 + n, g0 + 2 * n
    states, scratch = c + n + 1, c + 2 * n + 1
    last, misread = scratch + n, memory[READING_ERROR]
    if memory[STEP] > 0.0:
        for i in range(n):
            total = memory[g0 + i] * (memory[last] + misread) + memory[g1 + i] * (error + misread)
            for j in range(n):
                total += memory[at + j * n + i] * memory[states + j]
            memory[scratch + i] = total
        for i in range(n):
            memory[states + i] = memory[scratch + i]
    memory[last] = error


@njit(**OPTIONS)
def _sensed(memory, error):
    """Return what the sensor shows of an error."""
    n = int(memory[SENSOR_ORDER])
    c = int(memory[SENSOR]) + n * n + 2 * n
    seen = memory[c + n] * error
    for i in range(n):
        seen += memory[c + i] * memory[c + n + 1 + i]
    return seen


@njit(**OPTIONS)
def _misread(memory, output, noise):
    """Return by how much a sample of the output is read too small."""
    read, unit = output + noise, memory[RESOLUTION]
    if unit > 0.0:
        read = unit * math.floor(read / unit + 0.5)
    return output - read


@njit(**OPTIONS)
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


@njit(**OPTIONS)
def _ordered(memory, error, fed_forward):
    """Return the order of a sample: terms in parallel, filters in a row, what is fed forward."""
    excess, order, at = memory[ORDER_EXCESS], 0.0, int(memory[BLOCKS])
    for _ in range(int(memory[TERM_COUNT])):
        gain = memory[at + BLOCK_GAIN]
        order += gain * _through(memory, at, error, excess * gain)
        at += BLOCK_HEAD + 3 * int(memory[at + BLOCK_ORDER]) + 2
    for _ in range(int(memory[FILTER_COUNT])):
        order = _through(memory, at, order, 0.0)
        at += BLOCK_HEAD + 3 * int(memory[at + BLOCK_ORDER]) + 2
    order += fed_forward
    held = memory[HELD_ORDER]
    held = clamp(held + clamp(clamp(order, memory[LIMIT]) - held, memory[SAMPLE_SLEW]), memory[LIMIT])
    memory[HELD_ORDER] = held
    return order, order - held


@njit(**OPTIONS)
def _served(memory, order):
    """Return what the servo would do without limits at the start and the end of a step in which an order stands."""
    n, at = int(memory[SERVO_ORDER]), int(memory[SERVO])
    g = at + n * n
    c = g + n
    states, scratch = c + n + 1, c + 2 * n + 1
    before = now = memory[c + n] * order
    for i in range(n):
        before += memory[c + i] * memory[states + i]
        total = memory[g + i] * order
        for j in range(n):
            total += memory[at + j * n + i] * memory[states + j]
        memory[scratch + i] = total
    for i in range(n):
        memory[states + i] = memory[scratch + i]
        now += memory[c + i] * memory[states + i]
    return before, now


@kernel(COMMAND_SIGNATURE, **LEAN)
def sampled_controller(_, x, memory, u):
    """Sample where it is time, let the order wait, and move the actuator within its limits."""
    count, k, every = int(memory[COUNT]), int(memory[STEP]), int(memory[EVERY])
    reference = int(memory[SERIES])
    disturbance = reference + count + 1
    fed_forward = disturbance + count
    angles = fed_forward + count + 1
    output = x[int(memory[OUTPUT])]
    error = memory[reference + k] - output
    _sense(memory, error)
    if k % every == 0:
        misread = _misread(memory, output, memory[int(memory[NOISE]) + k // every])
        memory[READING_ERROR] = misread
        memory[LAST_ORDER], excess = _ordered(memory, _sensed(memory, error + misread), memory[fed_forward + k])
        memory[ORDER_EXCESS] = excess
    queue, size = int(memory[QUEUE]), int(memory[QUEUE_SIZE])
    late = memory[LAST_ORDER]
    if size > 0:
        late = memory[queue + k % size]
        memory[queue + k % size] = memory[LAST_ORDER]
    begun, wanted = _served(memory, late)
    begun, wanted = clamp(begun, memory[LIMIT]), clamp(wanted, memory[LIMIT])
    angle, slew = memory[ANGLE], memory[SLEW]
    new = clamp(angle + clamp(wanted - angle, slew), memory[LIMIT])
    # a triangle is lost where the actuator first has to catch up with an order that jumped
    gap = begun - angle
    mean = 0.5 * (begun + new) - 0.5 * gap * min(abs(gap) / slew, 1.0) if new == wanted else 0.5 * (angle + new)
    lift = effective_angle(mean, memory[STALL], memory[LOSS])
    place, disturbed = int(memory[ACTUATOR]), int(memory[DISTURBED_INPUT])
    u[place] = memory[TRIM] + memory[EFFECT] * lift
    if disturbed == place:
        u[place] += memory[disturbance + k]
    elif disturbed >= 0:
        u[disturbed] = memory[disturbance + k]
    memory[ANGLE] = new
    memory[angles + k + 1] = new
    memory[STEP] = k + 1.0
