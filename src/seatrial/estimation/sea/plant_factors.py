"""A loop whose ship differs from the model: by the actuator's effect, the natural frequency, and the damping."""

from dataclasses import replace
from functools import reduce

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, TransferLoop

PLANT_FACTORS = ("gain", "frequency", "damping")
"""What may differ, as logarithms of factors; zeros leave a loop as it is."""


def altered_loop(loop: TransferLoop, factors: Array) -> TransferLoop:
    """Return the loop with the plant's gain, and the natural frequencies and damping of plant and disturbance, changed.

    factors: (3,), logarithms, in the order of `PLANT_FACTORS`. Gains at rest are kept but for the first factor.
    """
    gain, frequency, damping = np.exp(factors).tolist()
    plant = _altered_block(loop.plant, frequency, damping).scaled(gain)
    return replace(loop, plant=plant, disturbance=_altered_block(loop.disturbance, frequency, damping))


def altered_responses(block: Block, omega: Array, factors: Array) -> Complex:
    """Return the responses at omega (k,) [rad/s] of a block altered by each row of factors (m, 2), (m, k).

    factors: logarithms, of natural frequency and damping, as of `altered_loop`.
    """
    frequency, damping = np.exp(factors).T[:, :, None]
    s = 1j * omega / frequency
    poles = damping * block.poles.real + 1j * block.poles.imag
    if not len(poles.T):
        return np.polyval(block.num, s) / block.den[-1]
    factor = reduce(np.multiply, (1.0 - s * (1.0 / pole) for pole in poles.T[:, :, None]))
    return np.polyval(block.num, s) / (block.den[-1] * factor)


def _altered_block(block: Block, frequency: float, damping: float) -> Block:
    """Return H(s / frequency) with the real parts of its poles times `damping`, the same at s = 0."""
    poles = frequency * (damping * block.poles.real + 1j * block.poles.imag)
    stretched = np.array(block.num) / frequency ** np.arange(len(block.num) - 1, -1, -1)
    den = np.real(np.poly(poles))
    num = stretched * (den[-1] / block.den[-1])
    return replace(block, num=tuple(num.tolist()), den=tuple(den.tolist()))
