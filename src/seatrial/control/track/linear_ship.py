"""The linear ship behind heading and track as a model: the plant of linear theory, so that only limits are new."""

from pathlib import Path

import numpy as np

from seatrial.control.ship.trimmed_ship import linearise
from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.equations.model import stored_model
from seatrial.core.values import Array

DISTURBANCE = "disturbance"
_LEFT_OUT = ("x0",)  # along the track: nothing follows from it


def linear_ship(ship: TrimmedShip, disturbed: str) -> Model:
    """Return x' = A x + b u + e w about the trim, without the position along the track; u, w in the notation's signs.

    Inputs are the actuator and ``disturbance``, which acts on the rate of the state `disturbed`, or like the actuator
    where it has the actuator's name. Matrices are fixed parameters, so that ships share their machine code.
    """
    linear, names = linearise(ship), ship.model.states
    kept = [i for i, name in enumerate(names) if name not in _LEFT_OUT]
    A, column = linear.A[np.ix_(kept, kept)], ship.model.input_names.index(ship.actuator)
    sign = -1.0 if ship.model.inputs[column].is_reversed else 1.0
    b = sign * linear.B[kept, column]
    e = b if disturbed == ship.actuator else np.array([1.0 if names[i] == disturbed else 0.0 for i in kept])
    states = tuple(names[i] for i in kept)
    model = stored_model(
        ("linear ship", *states, ship.actuator), lambda: _model(states, ship.actuator), (Path(__file__),)
    )
    return model.with_values(_values(A, b, e))


def _values(A: Array, b: Array, e: Array) -> dict[str, float]:
    n = len(b)
    values = {f"A_{i}_{j}": float(A[i, j]) for i in range(n) for j in range(n)}
    return values | {f"{name}_{i}": float(row[i]) for name, row in (("b", b), ("e", e)) for i in range(n)}


def _model(states: tuple[str, ...], actuator: str) -> Model:
    """Return the model with all entries zero."""
    from seatrial.core.equations import Sheet

    n = len(states)
    sheet = Sheet(f"linear_ship_{n}", "linearised about a trim", "a ship about its straight run")
    x, u, w = sheet.states(" ".join(states)), sheet.input(actuator), sheet.input(DISTURBANCE)
    A = [[sheet.parameter(f"A_{i}_{j}", 0.0, "", "state to rate") for j in range(n)] for i in range(n)]
    b = [sheet.parameter(f"b_{i}", 0.0, "", "actuator to rate") for i in range(n)]
    e = [sheet.parameter(f"e_{i}", 0.0, "", "disturbance to rate") for i in range(n)]
    for i, state in enumerate(x):
        sheet.rate(state, sum(A[i][j] * x[j] for j in range(n)) + b[i] * u + e[i] * w, "linearised about the trim")
    return sheet.model()
