"""A ship of which only transfer functions are known: the plant of a loop as a linear model of its own."""

from pathlib import Path

import numpy as np

from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.equations.model import stored_model
from seatrial.core.values import Array, InputError
from seatrial.physics.loops import TransferLoop


def plant_as_model(loop: TransferLoop) -> TrimmedShip:
    """The plant in observable form (Kailath 1980, Linear Systems, section 2.1), at rest: its first state is the output.

    Raises:
        InputError: the plant answers at once.
    """
    plant = loop.plant
    if len(plant.num) == len(plant.den):
        raise InputError(f"the plant of loop '{loop.name}' answers at once; give the lag that every real one has")
    den, n = np.array(plant.den) / plant.den[0], plant.order
    num = np.concatenate([np.zeros(n - len(plant.num)), np.array(plant.num) / plant.den[0]])
    key = ("plant as model", loop.actuator, loop.output, plant.source, den.tolist(), num.tolist())
    model = stored_model(key, lambda: _written(loop, den, num), (Path(__file__).parent,))
    return TrimmedShip(model, np.zeros(n), np.zeros(1), loop.actuator, loop.output)


def _written(loop: TransferLoop, den: Array, num: Array) -> Model:
    import sympy as sp

    from seatrial.core.equations import Sheet

    n = loop.plant.order
    sheet = Sheet(f"{loop.actuator} to {loop.output}", loop.plant.source or "as given", "a plant, linear")
    states = sheet.states(" ".join([loop.output, *(f"{loop.output}_{i}" for i in range(1, n))]))
    actuator = sheet.input(loop.actuator)
    for i, state in enumerate(states):
        following = states[i + 1] if i + 1 < n else sp.Integer(0)
        sheet.rate(state, following - float(den[i + 1]) * states[0] + float(num[i]) * actuator, "observable form")
    return sheet.model()
