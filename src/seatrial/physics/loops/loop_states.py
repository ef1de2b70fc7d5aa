"""The states behind a block, a plant and a loop: for simulation and Lyapunov checks."""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.model import stored_model
from seatrial.core.values import Array, InputError
from seatrial.physics.loops.loop import Block, TransferLoop, controllable_form

# The states behind a loop, linear in the gains as the loop is: for simulation and Lyapunov checks.


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


# Linear models: of any matrices, and of a plant with its disturbance.

_NO_REST = 1e-12  # of the largest coefficient, below which a rest of a division is rounding


def linear_model(states: tuple[str, ...], inputs: tuple[str, ...], A: Array, B: Array, pattern: Array) -> Model:
    """Return x' = A x + B u as a model, A (n, n), B (n, inputs), the entries of both fixed parameters.

    pattern: which entries of A there are, (n, n). Models of the same names and pattern share their machine code.
    """
    key = ("linear model", *states, *inputs, pattern.tolist())
    model = stored_model(key, lambda: _written(states, inputs, pattern), (Path(__file__).parent,))
    entries = {f"A_{i}_{j}": float(A[i, j]) for i, j in np.argwhere(pattern)}
    return model.with_values(entries | {f"B_{i}_{j}": float(value) for (i, j), value in np.ndenumerate(B)})


def _written(states: tuple[str, ...], inputs: tuple[str, ...], pattern: Array) -> Model:
    """Return the model with all entries zero."""
    from seatrial.core.equations import Sheet

    sheet = Sheet(f"linear_{len(states)}", "assembled from matrices", "a plant or a ship, linear about its trim")
    x, u = sheet.states(" ".join(states)), [sheet.input(name) for name in inputs]
    for i, state in enumerate(x):
        rate = [sheet.parameter(f"A_{i}_{j}", 0.0, "", "state to rate") * x[j] for j in np.flatnonzero(pattern[i])]
        rate += [sheet.parameter(f"B_{i}_{j}", 0.0, "", "input to rate") * each for j, each in enumerate(u)]
        sheet.rate(state, sum(rate), "linear")
    return sheet.model()


def plant_model(loop: TransferLoop) -> Model:
    """Return plant and disturbance of a loop as a model whose first state is the output.

    Inputs are the actuator and the disturbance (``disturbance`` where the loop has no symbol of its own for it).
    Observable form over the common denominator (Kailath 1980, Linear Systems, section 2.1).

    Raises:
        InputError: plant or disturbance answers at once.
    """
    den, pushed, met = _over_common_denominator(loop.plant, loop.disturbance)
    n = len(den) - 1
    if max(len(pushed), len(met)) > n:
        raise InputError(f"the plant of loop '{loop.name}' answers at once; give the lag that every real one has")
    has_own_input = loop.disturbance_input not in ("", loop.actuator)
    inputs = (loop.actuator, loop.disturbance_input if has_own_input else "disturbance")
    A = np.diag(np.ones(max(n - 1, 0)), 1)
    A[:, 0] = -den[1:]
    B = np.array([np.concatenate([np.zeros(n - len(values)), values]) for values in (pushed, met)]).T
    pattern = np.diag(np.ones(max(n - 1, 0), dtype=bool), 1)
    pattern[:, 0] = True
    return linear_model((loop.output, *(f"x_{i}" for i in range(1, n))), inputs, A, B, pattern)


def _over_common_denominator(plant: Block, disturbance: Block) -> tuple[Array, Array, Array]:
    """Common denominator, leading 1, and both numerators over it; the larger where one denominator holds the other."""
    p, d = np.array(plant.den), np.array(disturbance.den)
    over_p, over_d = _quotient(p, d), _quotient(d, p)
    if over_p is not None:
        den, left, right = p, np.ones(1), over_p
    elif over_d is not None:
        den, left, right = d, over_d, np.ones(1)
    else:
        den, left, right = np.polymul(p, d), d, p
    top = den[0]
    return den / top, np.polymul(plant.num, left) / top, np.polymul(disturbance.num, right) / top


def _quotient(dividend: Array, divisor: Array) -> Array | None:
    """Return dividend / divisor where it leaves no rest."""
    if len(divisor) > len(dividend):
        return None
    quotient, rest = np.polydiv(dividend, divisor)
    if np.any(np.abs(rest) > _NO_REST * np.abs(dividend).max()):
        return None
    return np.atleast_1d(np.asarray(quotient, dtype=np.float64))
