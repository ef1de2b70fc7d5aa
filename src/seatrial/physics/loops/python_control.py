"""Loops to python-control's objects and back."""

from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import InputError
from seatrial.physics.loops.discrete import difference_equation
from seatrial.physics.loops.loop import Block, TransferLoop, in_series

if TYPE_CHECKING:
    from control import StateSpace, TransferFunction


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

    d, n = loop.polynomials
    if loop.sampling is None:
        return control.TransferFunction(loop.gain_values @ n, np.array(d))
    b, a = difference_equation(Block("open loop", tuple(loop.gain_values @ n), tuple(d)), loop.sampling.sample_s)
    return control.TransferFunction(b, a, loop.sampling.sample_s)
