"""Closed forms of roll about an axis that stays: how long a swing lasts, what damps it, how high the metacentre stands.

phi'' + b_1 phi' + b_2 phi'|phi'| + b_3 phi'^3 + c_1 phi + c_3 phi^3 + c_5 phi^5 = 0, phi [rad] from the angle of rest.
"""

from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import G

_POINTS = 32  # points of the trapezoidal rule on a period; chosen


def swing_period(restoring: Array, amplitude: Array) -> tuple[Array, Array]:
    """Period [s] of an undamped swing of these amplitudes [rad], (n,), and its derivatives by c_1, c_3, c_5, (n, 3).

    restoring: c_1, c_3, c_5. By energy, phi = a sin(theta): T = int_0^2pi dtheta / sqrt(g),
    g = c_1 + c_3 a^2 (1 + s^2) / 2 + c_5 a^4 (1 + s^2 + s^4) / 3, s = sin(theta) (Nayfeh & Mook 1979, section 2.1),
    without any error that matters: the trapezoidal rule on a period. NaN where the swing does not come back.
    """
    s2 = np.sin((np.arange(_POINTS) + 0.5) * np.pi / _POINTS) ** 2
    a2 = amplitude[:, None] ** 2
    terms = np.stack([np.ones_like(a2 * s2), a2 * (1.0 + s2) / 2.0, a2**2 * (1.0 + s2 + s2**2) / 3.0], axis=-1)
    g = terms @ restoring
    g = np.where(g > 0.0, g, np.nan)
    step = 2.0 * np.pi / _POINTS
    return step * np.sum(g**-0.5, axis=1), -0.5 * step * np.sum(terms * (g**-1.5)[:, :, None], axis=1)


def equivalent_damping(damping: Array, restoring: Array, amplitude: Array) -> tuple[Array, Array]:
    """Linear damping [1/s] that takes as much energy in a swing, (n,), and derivatives by b_1 b_2 b_3 c_1 c_3 c_5.

    b_e = b_1 + 8 / (3 pi) w a b_2 + 3/4 w^2 a^2 b_3, w the frequency of a swing of amplitude a (Himeno 1981, Report
    239, University of Michigan; ITTC 7.5-02-07-04.5).
    """
    period, by_restoring = swing_period(restoring, amplitude)
    omega = 2.0 * np.pi / period
    # energy of a sine in b_2 and b_3: 8 / (3 pi) and 3/4, as above
    linear, square = 8.0 / (3.0 * np.pi) * amplitude, 0.75 * amplitude**2
    features = np.stack([np.ones_like(omega), linear * omega, square * omega**2], axis=1)
    by_omega = linear * damping[1] + 2.0 * square * omega * damping[2]
    return features @ damping, np.hstack([features, (-by_omega * omega / period)[:, None] * by_restoring])


def metacentric_height(c_1: float, gyradius: float) -> float:
    """Return GM [m] = c_1 k^2 / g, k [m] the radius of gyration in roll with the added inertia in it."""
    return c_1 * gyradius**2 / G


def gyradius_of(c_1: float, metacentric_height: float) -> float:
    """Return the radius of gyration [m] in roll with added inertia, k = sqrt(g GM / c_1), GM [m]."""
    return float(np.sqrt(G * metacentric_height / c_1))


def observed_swings(roll: Array, dt: float) -> tuple[Array, Array, Array]:
    """Amplitude [rad], logarithmic damping 2 ln(a_i / a_i+2) / T [1/s] and period T [s] of each swing of a decay.

    roll (n,): from the angle of rest; a_i is the i-th extreme, of either side.
    """
    time, size = swing_extremes(roll, dt)
    if len(size) < 3:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    period = time[2:] - time[:-2]
    return np.sqrt(size[:-2] * size[2:]), 2.0 * np.log(size[:-2] / size[2:]) / period, period


def swing_extremes(roll: Array, dt: float) -> tuple[Array, Array]:
    """Time from the first sample [s] and size [rad] of the extremes to either side, by parabolas.

    roll (n,): from the angle of rest. Each parabola goes through three samples. Only what lies between two crossings of
    the angle of rest counts.
    """
    crossings = np.flatnonzero(roll[1:] * roll[:-1] < 0.0) + 1
    tops, sizes = [], []
    for a, b in pairwise(crossings.tolist()):
        k = a + int(np.argmax(np.abs(roll[a:b])))
        if 0 < k < len(roll) - 1:
            before, top, right = np.abs(roll[k - 1 : k + 2])
            bend = before - 2.0 * top + right
            shift = 0.5 * (before - right) / bend if bend < 0.0 else 0.0
            tops.append((k + shift) * dt)
            sizes.append(top - 0.25 * (before - right) * shift)
    return np.array(tops), np.array(sizes)
