"""A craft that keeps its place: a PID of position and heading in body axes, shared out over thrusters within limits.

    tau = -K_p R^T e - K_i R^T int(e) dt - K_d v,    e = eta - eta_d, v: R^T de/dt behind a filter

(Fossen 2021, Algorithm 15.2, nonlinear PID of dynamic positioning.) Forces follow by a generalised inverse; where a
thruster would exceed its limit all are reduced alike, so that the direction stays, and the integral waits. The memory
is a head, the parts that `parts` places one behind the other, and series of `COUNT` samples.

The craft's model moves in water at rest; DRIFT is how far the water has gone.
"""

import math

from numba import njit

from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, LEAN, kernel

# places in the memory
(
    THRUSTERS, COUNT, STEP, HOLD, DELAY, SAMPLE, TABLE, PSI, NORTH, EAST, FORCE_INPUT, RESOLUTION, HEAD,
) = range(13)  # fmt: skip
# three matrices of nine numbers behind the head
KP, KI, KD = HEAD, HEAD + 9, HEAD + 18
# then vectors of three
PAST, FORWARD, INTEGRAL, VELOCITY, LAST, ROWS = range(HEAD + 27, HEAD + 43, 3)
DISTURBANCES = 6
"""Series of what disturbs: water north and east, forces X, Y, N, and the error of a compass that is read in steps."""
_SWAY, _YAW = 3, 6  # places of the rows of a matrix of nine numbers
# a thruster: two rows of the inverse, then what it is
(
    AZIMUTH, COMMAND_INPUT, ANGLE_INPUT, ZERO, SPAN, LEAST, MOST, DIRECTION, TRAITS,
) = range(6, 15)  # fmt: skip
_TURNING = 1e-3  # share of the largest thrust below which an azimuth thruster is not turned; chosen
_FULL = 1.0 - 1e-12  # share of what was ordered that counts as all of it: rounding


@njit(inline="always", **LEAN)
def tables_start(n):
    """Return the place of the tables of n thrusters."""
    return ROWS + n * TRAITS


@njit(inline="always", **LEAN)
def series_start(n, size):
    """Return the place of the series: `DISTURBANCES`, then of each thruster command, angle, thrust.

    The last is the share of what the controller orders that the thrusters give.
    """
    return tables_start(n) + 2 * n * size


@njit(inline="always", **LEAN)
def _share_at(memory, start, size, thrust):
    """Return the share of full command that gives a thrust, by a table of rising thrusts."""
    low, high = 0, size - 1
    thrusts = start + size
    if thrust <= memory[thrusts]:
        return memory[start]
    if thrust >= memory[thrusts + high]:
        return memory[start + high]
    while high - low > 1:
        middle = (low + high) // 2
        if memory[thrusts + middle] <= thrust:
            low = middle
        else:
            high = middle
    gap = memory[thrusts + high] - memory[thrusts + low]
    part = (thrust - memory[thrusts + low]) / gap
    return memory[start + low] + part * (memory[start + high] - memory[start + low])


@njit(inline="always", **LEAN)
def _wrapped(angle):
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@njit(inline="always", **LEAN)
def _allocate(memory, X, Y, N, k):
    """Share out a force; write commands, angles and thrusts of sample k, return the share of it that is given."""
    n, count, size = int(memory[THRUSTERS]), int(memory[COUNT]), int(memory[TABLE])
    orders = series_start(n, size) + DISTURBANCES * count
    share = 1.0
    for i in range(n):
        row = ROWS + i * TRAITS
        ahead = memory[row] * X + memory[row + 1] * Y + memory[row + 2] * N
        if memory[row + AZIMUTH] == 1.0:
            across = memory[row + 3] * X + memory[row + 4] * Y + memory[row + 5] * N
            size_of = math.sqrt(ahead * ahead + across * across)
            if size_of > memory[row + MOST]:
                share = min(share, memory[row + MOST] / size_of)
        elif ahead > memory[row + MOST]:
            share = min(share, memory[row + MOST] / ahead)
        elif ahead < memory[row + LEAST]:
            share = min(share, memory[row + LEAST] / ahead)
    for i in range(n):
        row, series = ROWS + i * TRAITS, orders + 3 * i * count
        thrust = share * (memory[row] * X + memory[row + 1] * Y + memory[row + 2] * N)
        if memory[row + AZIMUTH] == 1.0:
            across = share * (memory[row + 3] * X + memory[row + 4] * Y + memory[row + 5] * N)
            ahead = thrust
            thrust = math.sqrt(ahead * ahead + across * across)
            if thrust > _TURNING * memory[row + MOST]:
                turn = _wrapped(math.atan2(across, ahead) - memory[row + DIRECTION])
                memory[row + DIRECTION] += turn
        command = _share_at(memory, tables_start(n) + 2 * i * size, size, thrust)
        memory[series + k] = memory[row + ZERO] + memory[row + SPAN] * command
        memory[series + count + k] = memory[row + DIRECTION]
        memory[series + 2 * count + k] = thrust
    memory[orders + 3 * n * count + k] = share
    return share


@njit(inline="always", **LEAN)
def _force(memory, row, x0, x1, x2, i0, i1, i2):
    """Return one row of -(K_p e + K_i int(e) + K_d v), errors and integrals in body axes."""
    p = memory[KP + row] * x0 + memory[KP + row + 1] * x1 + memory[KP + row + 2] * x2
    i = memory[KI + row] * i0 + memory[KI + row + 1] * i1 + memory[KI + row + 2] * i2
    d = memory[KD + row] * memory[VELOCITY]
    d += memory[KD + row + 1] * memory[VELOCITY + 1] + memory[KD + row + 2] * memory[VELOCITY + 2]
    return -(p + i + d)


@njit(inline="always", **LEAN)
def _control(memory, north, east, psi, k):
    """Order the force for an error, and advance filter and integral."""
    last_north, last_east, last_psi = memory[LAST], memory[LAST + 1], memory[LAST + 2]
    if k == 0:
        last_north, last_east, last_psi = north, east, psi
    c, s = math.cos(psi), math.sin(psi)
    moved_north, moved_east = north - last_north, east - last_east
    memory[VELOCITY] *= memory[PAST]
    memory[VELOCITY] += memory[FORWARD] * (c * moved_north + s * moved_east)
    memory[VELOCITY + 1] *= memory[PAST + 1]
    memory[VELOCITY + 1] += memory[FORWARD + 1] * (c * moved_east - s * moved_north)
    memory[VELOCITY + 2] *= memory[PAST + 2]
    memory[VELOCITY + 2] += memory[FORWARD + 2] * (psi - last_psi)
    half = 0.5 * memory[SAMPLE]
    added_north, added_east, added_psi = half * (north + last_north), half * (east + last_east), half * (psi + last_psi)
    if k == 0:
        added_north, added_east, added_psi = 0.0, 0.0, 0.0
    whole_north, whole_east = memory[INTEGRAL] + added_north, memory[INTEGRAL + 1] + added_east
    whole_psi = memory[INTEGRAL + 2] + added_psi
    e0, e1 = c * north + s * east, c * east - s * north
    i0, i1 = c * whole_north + s * whole_east, c * whole_east - s * whole_north
    X = _force(memory, 0, e0, e1, psi, i0, i1, whole_psi)
    Y = _force(memory, _SWAY, e0, e1, psi, i0, i1, whole_psi)
    N = _force(memory, _YAW, e0, e1, psi, i0, i1, whole_psi)
    if _allocate(memory, X, Y, N, k) >= _FULL:
        memory[INTEGRAL], memory[INTEGRAL + 1], memory[INTEGRAL + 2] = whole_north, whole_east, whole_psi
    memory[LAST], memory[LAST + 1], memory[LAST + 2] = north, east, psi


@kernel(COMMAND_SIGNATURE, **LEAN)
def station_keeper(_, x, memory, u):
    """Order the thrusters at every sample of the controller, late by its dead time; push by the forces from outside."""
    n, count, k = int(memory[THRUSTERS]), int(memory[COUNT]), int(memory[STEP])
    size = int(memory[TABLE])
    series = series_start(n, size)
    orders = series + DISTURBANCES * count
    if k % int(memory[HOLD]) == 0:
        north = x[int(memory[NORTH])] + memory[series + k]
        east = x[int(memory[EAST])] + memory[series + count + k]
        psi = x[int(memory[PSI])] + memory[series + 5 * count + k]
        if memory[RESOLUTION] > 0.0:
            psi = memory[RESOLUTION] * math.floor(psi / memory[RESOLUTION] + 0.5)
        _control(memory, north, east, _wrapped(psi), k)
    else:
        for i in range(3 * n + 1):
            memory[orders + i * count + k] = memory[orders + i * count + k - 1]
    late = k - int(memory[DELAY])
    for i in range(n):
        row, start = ROWS + i * TRAITS, orders + 3 * i * count
        u[int(memory[row + COMMAND_INPUT])] = memory[start + late] if late >= 0 else memory[row + ZERO]
        if memory[row + AZIMUTH] == 1.0 and late >= 0:
            u[int(memory[row + ANGLE_INPUT])] = memory[start + count + late]
    for j in range(3):
        u[int(memory[FORCE_INPUT]) + j] = memory[series + (2 + j) * count + k]
    memory[STEP] = k + 1.0
