"""Sine and cosine of one angle together, inlined into the generated code: two for less than the price of one call."""

import math

from numba import types

from seatrial.numerics.kernels.kernel import F8, OPTIONS, kernel

_TWO_OVER_PI = 2.0 / math.pi
# pi/2 in three parts, the first two of 33 bits, so that k times them is exact (Cody & Waite 1980, chapter 8)
HALF_PI = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
_HALF_PI_1, _HALF_PI_2, _HALF_PI_3 = HALF_PI

# coefficients of the Taylor series of the sine to the 17th power and the cosine to the 18th: rounding at pi/4
SINE_SERIES = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(1, 9))
COSINE_SERIES = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(1, 10))
_S, _C = SINE_SERIES, COSINE_SERIES


@kernel(types.UniTuple(F8, 2)(F8), **OPTIONS)
def sincos(angle: float) -> tuple[float, float]:
    """Return (sin, cos) within 1e-16 for |angle| < 1e5 rad; Taylor polynomials on |r| <= pi/4, by Estrin's scheme."""
    k = math.floor(angle * _TWO_OVER_PI + 0.5)
    r = ((angle - k * _HALF_PI_1) - k * _HALF_PI_2) - k * _HALF_PI_3
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    low = (_S[0] + z * _S[1]) + z2 * (_S[2] + z * _S[3])
    s = r + r * z * (low + z4 * ((_S[4] + z * _S[5]) + z2 * (_S[6] + z * _S[7])))
    low = (_C[0] + z * _C[1]) + z2 * (_C[2] + z * _C[3])
    c = 1.0 + z * (low + z4 * ((_C[4] + z * _C[5]) + z2 * (_C[6] + z * (_C[7] + z * _C[8]))))
    quadrant = k - 4.0 * math.floor(0.25 * k)
    swapped = quadrant == 1.0 or quadrant == 3.0
    first = c if swapped else s
    second = s if swapped else c
    return first if quadrant < 2.0 else -first, second if quadrant == 0.0 or quadrant == 3.0 else -second
