"""A controller for other programs: as difference equations, and as python-control's objects."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.results.tuning import DiscreteBlock
from seatrial.core.values import InputError
from seatrial.physics.loops.autopilot import working_frequency
from seatrial.physics.loops.loop import Block, TransferLoop, in_series
from seatrial.physics.loops.performance import sensitivity_peak

if TYPE_CHECKING:
    from control import StateSpace, TransferFunction


# A controller as difference equations: every block by Tustin's rule at a sample time.

_SAMPLES_A_PERIOD = (
    30.0  # of the frequency at which the loop is frailest: the hold costs 6 degrees of phase there; chosen
)
_RINGING = 2.0 * (1.0 + 1e-9)  # pole times sample time beyond which Tustin's pole is negative, with rounding
_AT_ORIGIN = 1e-9  # rad/s, below which a pole integrates: rounding
_KEPT = 256  # difference equations kept in memory; chosen
_STEPS = (1.0, 2.0, 5.0)  # sample times are these times a power of ten


@lru_cache(maxsize=_KEPT)
def difference_equation(block: Block, sample_s: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return a block by Tustin's rule, s = 2 / T (z - 1) / (z + 1) (Astrom & Wittenmark 1997, section 8.3).

    b and a of y[k] = b_0 x[k] + b_1 x[k-1] + ... - a_1 y[k-1] - ...; a begins with 1. sample_s: T [s].

    Raises:
        InputError: T is not positive, or the block has a pole at 2 / T.
    """
    if not sample_s > 0.0:
        raise InputError(f"a sample time of {sample_s:g} s is not positive; give one in seconds")
    order = block.order
    num, den = (_substituted(side, order, 2.0 / sample_s) for side in (block.num, block.den))
    if den[0] == 0.0:
        raise InputError(f"block '{block.name}' has a pole at 2 / T for T = {sample_s:g} s; take another sample time")
    return tuple((num / den[0]).tolist()), tuple((den / den[0]).tolist())


def holding_terms(loop: TransferLoop) -> tuple[tuple[bool, ...], float]:
    """Return which terms keep their output while the actuator is at a limit, and the sign of their share of the order.

    Terms with a pole below the plant's working frequency wind up (Astrom & Hagglund 1995, PID Controllers, section
    3.5). Such a term keeps its last output at a sample where the order of the last one was beyond what the actuator
    could do and the new output would push it further.
    """
    try:
        slow = working_frequency(loop.plant)
    except InputError:
        slow = 0.0
    below = max(slow, _AT_ORIGIN)
    holds = tuple(bool(t.block.order) and float(np.abs(t.block.poles).min()) < below for t in loop.terms)
    return holds, float(np.prod([np.sign(block.gain) for block in (*loop.filters, *loop.servo)]))


def discrete_blocks(loop: TransferLoop) -> tuple[DiscreteBlock, ...]:
    """Return terms, then filters, of a sampled loop as the difference equations that run on board and in simulation."""
    T, (holds, sign) = loop.required_sampling.sample_s, holding_terms(loop)
    terms = (
        DiscreteBlock("term", term.block.name, term.gain, *difference_equation(term.block, T), int(sign) if held else 0)
        for term, held in zip(loop.terms, holds, strict=True)
    )
    filters = (DiscreteBlock("filter", one.name, "", *difference_equation(one, T), 0) for one in loop.filters)
    return (*terms, *filters)


def default_sample_time(loop: TransferLoop) -> float:
    """Return a sample time that samples the frailest frequency 30 times a period, and no block of the controller rings.

    The largest of 1, 2, 5 times a power of ten [s] at which both hold; see `rings`.
    """
    _, omega = sensitivity_peak(replace(loop, sampling=None))
    fastest = max((float(np.abs(block.poles).max(initial=0.0)) for block in _controller_blocks(loop)), default=0.0)
    longest = 2.0 * math.pi / omega / _SAMPLES_A_PERIOD
    return round_sample_time(min(longest, 2.0 / fastest) if fastest else longest)


def ringing_blocks(loop: TransferLoop, sample_s: float) -> tuple[str, ...]:
    """Return the blocks of the controller that ring: poles beyond 2 / T become negative ones of z by Tustin's rule."""
    return tuple(
        block.name for block in _controller_blocks(loop) if np.abs(block.poles).max(initial=0.0) * sample_s > _RINGING
    )


def _controller_blocks(loop: TransferLoop) -> tuple[Block, ...]:
    return (*(term.block for term in loop.terms), *loop.filters)


def round_sample_time(longest: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten up to `longest` [s]; zero up to none."""
    if not longest > 0.0:
        return 0.0
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


# Loops to python-control's objects and back.


def transfer_function(block: Block) -> "TransferFunction":
    """Return the block as python-control's transfer function."""
    import control

    return control.TransferFunction(np.array(block.num), np.array(block.den), name=block.name.replace(" ", "_"))


def block_from_system(system: "TransferFunction | StateSpace", name: str) -> Block:
    """Return a continuous system of one input and one output as a block.

    Raises:
        InputError: it is in discrete time, has several inputs or outputs, or is improper.
    """
    import control

    if system.isdtime(strict=True):
        raise InputError(f"system '{name}' is in discrete time; give the continuous one")
    if system.ninputs != 1 or system.noutputs != 1:
        raise InputError(f"system '{name}' has {system.ninputs} inputs and {system.noutputs} outputs; give one of each")
    made = system if isinstance(system, control.TransferFunction) else control.ss2tf(system)
    return Block(name, tuple(np.real(made.num[0][0])), tuple(np.real(made.den[0][0])))


def controller_transfer_function(loop: TransferLoop) -> "TransferFunction":
    """Return K(s) at the loop's gains, from the output to the actuator; the loop feeds back minus it."""
    import control

    parallel = control.TransferFunction([0.0], [1.0])
    for gain, term in zip(loop.gain_values, loop.terms, strict=True):
        parallel = parallel + float(gain) * transfer_function(term.block)
    return parallel * transfer_function(in_series("chain", (*loop.sensor, *loop.filters, *loop.servo)))


def open_loop_transfer_function(loop: TransferLoop) -> "TransferFunction":
    """Return L(s) at the loop's gains, from the common denominator; of a sampled loop L(z)."""
    import control

    n, d = loop.fraction(loop.gain_values)
    if loop.sampling is None:
        return control.TransferFunction(n, np.array(d))
    b, a = difference_equation(Block("open loop", tuple(n), tuple(d)), loop.sampling.sample_s)
    return control.TransferFunction(b, a, loop.sampling.sample_s)
