"""The states behind a loop, linear in the gains as the loop is: for simulation and Lyapunov checks."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.loops.block import Block, controllable_form
from seatrial.physics.loops.loop import TransferLoop


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = (A_0 + sum gain_i A_i) x + b w, y = c x, a = (a_0 + sum gain_i a_i) x; first axis of a, A: 1 + g.

    Attributes:
        names: of the states, by block; A: (1 + g, n, n); b: (n,); c: (n,), the output; a: (1 + g, n), the actuator.
    """

    names: tuple[str, ...]
    A: Array
    b: Array
    c: Array
    a: Array

    def closed_loop_matrix(self, gains: Array) -> Array:
        """Return the matrix A at the gains, (n, n)."""
        return self.A[0] + np.tensordot(gains, self.A[1:], 1)

    def actuator_row(self, gains: Array) -> Array:
        """Return row that gives the actuator, (n,)."""
        return self.a[0] + gains @ self.a[1:]


def state_space(loop: TransferLoop) -> StateSpace:
    """States of plant, sensor, terms, filters and servo in a row; the disturbance's own where it shares no poles.

    Raises:
        InputError: plant or disturbance answers at once, so that an algebraic loop would have to be solved.
    """
    own = loop.disturbance.den != loop.plant.den
    terms = tuple(term.block for term in loop.terms)
    blocks = (loop.plant, *((loop.disturbance,) if own else ()), *loop.sensor, *terms, *loop.filters, *loop.servo)
    first = np.cumsum([0, *(block.order for block in blocks)])
    n, g = int(first[-1]), len(terms)
    A, b, c = np.zeros((1 + g, n, n)), np.zeros(n), np.zeros(n)
    where = [slice(int(i), int(j)) for i, j in pairwise(first)]
    place = iter(zip(where, blocks, strict=True))

    def through(signal: Array) -> Array:
        """Return the next block's answer to a signal, (1 + g, n) over the states."""
        at, block = next(place)
        own_A, own_b, own_c, d = controllable_form(block)
        A[0, at, at] += own_A
        A[:, at] += own_b[:, None] * signal[:, None, :]
        out = d * signal
        out[0, at] += own_c
        return out

    for what, block in (("plant", loop.plant), ("disturbance", loop.disturbance)):
        if len(block.num) == len(block.den):
            raise InputError(f"the {what} of loop '{loop.name}' answers at once; give the lag that every real one has")
    at, plant = next(place)
    plant_A, plant_b, plant_c = _observable_form(plant, None if own else loop.disturbance)
    A[0, at, at], c[at] = plant_A, plant_c
    if own:
        into, block = next(place)
        own_A, own_b, own_c, _ = controllable_form(block)
        A[0, into, into], b[into], c[into] = own_A, own_b, own_c
    else:
        b[at] = plant_b[:, 1]
    signal = np.zeros((1 + g, n))
    signal[0] = -c
    for _ in loop.sensor:
        signal = through(signal)
    ordered = np.zeros((1 + g, n))
    for i in range(g):
        ordered[1 + i] = through(signal)[0]
    for _ in (*loop.filters, *loop.servo):
        ordered = through(ordered)
    A[:, at] += plant_b[:, 0][:, None] * ordered[:, None, :]
    names = tuple(f"x_{i}_{_identifier(block.name)}" for i, block in enumerate(blocks) for _ in range(block.order))
    return StateSpace(tuple(f"{name}_{i}" for i, name in enumerate(names)), A, b, c, ordered)


def _observable_form(plant: Block, disturbance: Block | None) -> tuple[Array, Array, Array]:
    """Return A (n, n), b (n, 2) of actuator and disturbance, c (n,): observable form, so that both share the states."""
    den, n = np.array(plant.den) / plant.den[0], plant.order
    A = np.diag(np.ones(max(n - 1, 0)), 1)
    A[:, 0] = -den[1:]
    b = np.zeros((n, 2))
    for column, block in enumerate((plant, disturbance)):
        if block is not None:
            num = np.array(block.num) / plant.den[0]
            b[n - len(num) :, column] = num
    return A, b, np.eye(n)[0]


def _identifier(name: str) -> str:
    return "".join(character if character.isalnum() else "_" for character in name)
