"""A craft that keeps its place: a PID of position and heading in body axes, shared out over thrusters within limits.

    tau = -K_p R^T e - K_i R^T int(e) dt - K_d v,    e = eta - eta_d, v: R^T de/dt behind a filter

(Fossen 2021, Algorithm 15.2, nonlinear PID of dynamic positioning.) Forces follow by a generalised inverse; where a
thruster would exceed its limit all are reduced alike, so that the direction stays, and the integral waits. Given are
the pose to be kept and the forces X, Y, N from outside; answers are the thrusts and the share of the force that they
give.

The craft's model moves in water at rest: where that flows, the pose to be kept goes the other way.
"""

import math

from numba import njit

from seatrial.numerics.kernels.feedback import DISTURBED_INPUT, EVERY, LAW, STEP, answer, given, late, read
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, LEAN, kernel

# places in the law: three matrices of nine numbers, vectors of three (the last the places of the pose among the states)
KP, KI, KD, PAST, FORWARD, INTEGRAL, VELOCITY, LAST, POSE = 0, 9, 18, *range(27, 45, 3)
# share given, sample time [s], how many thrusters, rows of their tables; thrusters and tables stand behind
SHARE, SAMPLE, THRUSTERS, TABLE, ROWS = range(45, 50)
_SWAY, _YAW = 3, 6  # places of the rows of a matrix of nine numbers
# a thruster: two rows of the inverse, then what it is, its direction, and what it was ordered last
(
    AZIMUTH, COMMAND_INPUT, ANGLE_INPUT, ZERO, SPAN, LEAST, MOST, DIRECTION, COMMANDED, THRUST, TRAITS,
) = range(6, 17)  # fmt: skip
_TURNING = 1e-3  # share of the largest thrust below which an azimuth thruster is not turned; chosen
_FULL = 1.0 - 1e-12  # share of what was ordered that counts as all of it: rounding


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
def _allocate(memory, law, X, Y, N):
    """Share out a force: command, direction and thrust of each thruster, and the share of the force that is given."""
    n, size, share = int(memory[law + THRUSTERS]), int(memory[law + TABLE]), 1.0
    for i in range(n):
        row = law + ROWS + i * TRAITS
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
        row = law + ROWS + i * TRAITS
        thrust = share * (memory[row] * X + memory[row + 1] * Y + memory[row + 2] * N)
        if memory[row + AZIMUTH] == 1.0:
            across = share * (memory[row + 3] * X + memory[row + 4] * Y + memory[row + 5] * N)
            ahead = thrust
            thrust = math.sqrt(ahead * ahead + across * across)
            if thrust > _TURNING * memory[row + MOST]:
                turn = _wrapped(math.atan2(across, ahead) - memory[row + DIRECTION])
                memory[row + DIRECTION] += turn
        command = _share_at(memory, law + ROWS + n * TRAITS + 2 * i * size, size, thrust)
        memory[row + COMMANDED] = memory[row + ZERO] + memory[row + SPAN] * command
        memory[row + THRUST] = thrust
    memory[law + SHARE] = share


@njit(inline="always", **LEAN)
def _force(memory, law, row, x0, x1, x2, i0, i1, i2):
    """Return one row of -(K_p e + K_i int(e) + K_d v), errors and integrals in body axes."""
    gains, v = law + row, law + VELOCITY
    p = memory[gains + KP] * x0 + memory[gains + KP + 1] * x1 + memory[gains + KP + 2] * x2
    i = memory[gains + KI] * i0 + memory[gains + KI + 1] * i1 + memory[gains + KI + 2] * i2
    d = memory[gains + KD] * memory[v]
    d += memory[gains + KD + 1] * memory[v + 1] + memory[gains + KD + 2] * memory[v + 2]
    return -(p + i + d)


@njit(inline="always", **LEAN)
def _control(memory, law, north, east, psi, is_first):
    """Order the force for an error, and advance filter and integral."""
    last, v, past, forward, total = law + LAST, law + VELOCITY, law + PAST, law + FORWARD, law + INTEGRAL
    half = 0.5 * memory[law + SAMPLE]
    if is_first:
        memory[last], memory[last + 1], memory[last + 2], half = north, east, psi, 0.0
    last_north, last_east, last_psi = memory[last], memory[last + 1], memory[last + 2]
    c, s = math.cos(psi), math.sin(psi)
    moved_north, moved_east = north - last_north, east - last_east
    memory[v] *= memory[past]
    memory[v] += memory[forward] * (c * moved_north + s * moved_east)
    memory[v + 1] *= memory[past + 1]
    memory[v + 1] += memory[forward + 1] * (c * moved_east - s * moved_north)
    memory[v + 2] *= memory[past + 2]
    memory[v + 2] += memory[forward + 2] * (psi - last_psi)
    whole_north = memory[total] + half * (north + last_north)
    whole_east = memory[total + 1] + half * (east + last_east)
    whole_psi = memory[total + 2] + half * (psi + last_psi)
    e0, e1 = c * north + s * east, c * east - s * north
    i0, i1 = c * whole_north + s * whole_east, c * whole_east - s * whole_north
    X = _force(memory, law, 0, e0, e1, psi, i0, i1, whole_psi)
    Y = _force(memory, law, _SWAY, e0, e1, psi, i0, i1, whole_psi)
    N = _force(memory, law, _YAW, e0, e1, psi, i0, i1, whole_psi)
    _allocate(memory, law, X, Y, N)
    if memory[law + SHARE] >= _FULL:
        memory[total], memory[total + 1], memory[total + 2] = whole_north, whole_east, whole_psi
    memory[last], memory[last + 1], memory[last + 2] = north, east, psi


@kernel(COMMAND_SIGNATURE, **LEAN)
def station_keeper(_, x, memory, u):
    """Order the thrusters at every sample of the controller, late by its dead time; push by the forces from outside."""
    k, law, pushed = int(memory[STEP]), int(memory[LAW]), int(memory[DISTURBED_INPUT])
    n, pose = int(memory[law + THRUSTERS]), law + POSE
    if k % int(memory[EVERY]) == 0:
        north = x[int(memory[pose])] - given(memory, 0, k)
        east = x[int(memory[pose + 1])] - given(memory, 1, k)
        psi = read(memory, x[int(memory[pose + 2])], k) - given(memory, 2, k)
        _control(memory, law, north, east, _wrapped(psi), k == 0)
    for i in range(n):
        row = law + ROWS + i * TRAITS
        answer(memory, i, k, memory[row + THRUST])
        u[int(memory[row + COMMAND_INPUT])] = late(memory, 2 * i, k, memory[row + COMMANDED])
        if memory[row + AZIMUTH] == 1.0:
            u[int(memory[row + ANGLE_INPUT])] = late(memory, 2 * i + 1, k, memory[row + DIRECTION])
    answer(memory, n, k, memory[law + SHARE])
    for j in range(3):
        u[pushed + j] = given(memory, 3 + j, k)
    memory[STEP] = k + 1.0
