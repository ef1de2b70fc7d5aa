"""A controller as difference equations: every block by Tustin's rule at a sample time."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import InputError
from seatrial.physics.loops.block import Block
from seatrial.physics.loops.loop import TransferLoop
from seatrial.physics.loops.margins import sensitivity_peak

_SAMPLES_A_PERIOD = (
    60.0  # of the frequency at which the loop is frailest: the hold then costs 3 degrees of phase; chosen
)
_STEPS = (1.0, 2.0, 5.0)  # sample times are these times a power of ten


@dataclass(frozen=True)
class DifferenceEquation:
    """y[k] = b_0 x[k] + b_1 x[k-1] + ... - a_1 y[k-1] - ...; `a` begins with 1."""

    b: tuple[float, ...]
    a: tuple[float, ...]


def difference_equation(block: Block, sample_s: float) -> DifferenceEquation:
    """Return a block by Tustin's rule, s = 2 / T (z - 1) / (z + 1) (Astrom & Wittenmark 1997, section 8.3).

    sample_s: T [s].

    Raises:
        InputError: T is not positive, or the block has a pole at 2 / T.
    """
    if not sample_s > 0.0:
        raise InputError(f"a sample time of {sample_s:g} s is not positive; give one in seconds")
    order = block.order
    num, den = (_substituted(side, order, 2.0 / sample_s) for side in (block.num, block.den))
    if den[0] == 0.0:
        raise InputError(f"block '{block.name}' has a pole at 2 / T for T = {sample_s:g} s; take another sample time")
    return DifferenceEquation(tuple((num / den[0]).tolist()), tuple((den / den[0]).tolist()))


def default_sample_time(loop: TransferLoop) -> float:
    """Return the largest of 1, 2, 5 times a power of ten [s] that samples the frailest frequency 60 times a period."""
    _, omega = sensitivity_peak(loop)
    return round_sample_time(2.0 * math.pi / omega / _SAMPLES_A_PERIOD)


def round_sample_time(longest: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten up to `longest` [s]."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in _STEPS if step * power <= longest)


def _substituted(coefficients: tuple[float, ...], order: int, speed: float) -> np.ndarray:
    """Return the polynomial in z of sum c_i (speed (z - 1))^i (z + 1)^(order - i), highest power first."""
    total = np.zeros(order + 1)
    for i, c in enumerate(reversed(coefficients)):
        factors = [np.array([speed, -speed])] * i + [np.array([1.0, 1.0])] * (order - i)
        made = np.array([c])
        for factor in factors:
            made = np.polymul(made, factor)
        total[order + 1 - len(made) :] += made
    return total
