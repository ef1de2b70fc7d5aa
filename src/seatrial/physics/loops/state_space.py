"""State-space forms: of a block, and of a plant with its disturbance as a linear model."""

from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.manifest import stored_model
from seatrial.core.values import Array, InputError
from seatrial.physics.loops.block import Block
from seatrial.physics.loops.loop import TransferLoop

_NO_REST = 1e-12  # of the largest coefficient, below which a rest of a division is rounding


def plant_model(loop: TransferLoop) -> Model:
    """Return plant and disturbance of a loop as a model whose first state is the output.

    Inputs are the actuator and the disturbance (``disturbance`` where the loop has no symbol of its own for it).
    Observable form over the common denominator; coefficients are fixed parameters, so that plants of one order share
    their machine code.

    Raises:
        InputError: plant or disturbance answers at once.
    """
    den, pushed, met = _over_common_denominator(loop.plant, loop.disturbance)
    n = len(den) - 1
    if max(len(pushed), len(met)) > n:
        raise InputError(f"the plant of loop '{loop.name}' answers at once; give the lag that every real one has")
    has_own_input = loop.disturbance_input not in ("", loop.actuator)
    inputs = (loop.actuator, loop.disturbance_input if has_own_input else "disturbance")
    meanings = ("denominator", loop.plant.name, loop.disturbance.name)
    key = ("linear plant", n, loop.output, *inputs, *meanings)
    model = stored_model(key, lambda: _observable_model(n, loop.output, inputs, meanings), (Path(__file__).parent,))
    full = [np.concatenate([np.zeros(n - len(values)), values]) for values in (den[1:], pushed, met)]
    rows = zip("abd", full, strict=True)
    return model.with_values({f"{letter}_{i}": float(v) for letter, row in rows for i, v in enumerate(row)})


def _observable_model(n: int, output: str, inputs: tuple[str, str], meanings: tuple[str, str, str]) -> Model:
    """Return the model of order n with all coefficients zero; meanings: of the coefficients a, b and d."""
    from seatrial.core.equations import Sheet

    sheet = Sheet(f"linear_plant_{n}", "assembled from the loop's blocks", "a plant known by its transfer functions")
    x = sheet.states(" ".join([output, *(f"x_{i}" for i in range(1, n))]))
    u, w = (sheet.input(name) for name in inputs)
    rows = []
    for letter, meaning in zip("abd", meanings, strict=True):
        rows.append([sheet.parameter(f"{letter}_{i}", 0.0, "", meaning) for i in range(n)])
    for i, (state, a, b, d) in enumerate(zip(x, *rows, strict=True)):
        sheet.rate(state, (x[i + 1] if i + 1 < n else 0) - a * x[0] + b * u + d * w, "observable form")
    return sheet.model()


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
