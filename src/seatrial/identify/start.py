"""A start without a guess: the weak form of the equations, its spread re-estimated."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.equations import Model
from seatrial.identify.states import hidden_states, measured_states
from seatrial.optimise import levenberg_marquardt
from seatrial.regress.weak import WeakForm
from seatrial.simulate.channels import inputs_of
from seatrial.values import Array, Record


def weak_start(model: Model, records: Sequence[Record], seconds: float, rounds: int = 3) -> Array:
    """Free parameters from the weak form over all records, shape (free,); priors pull as far as the data leave room.

    Equations of states that stay constant in a record (positions nobody measured) are left out. A model with hidden
    states starts at its own values.
    """
    point = np.array([p.value for p in model.parameters.free])
    if hidden_states(model, records):
        return point
    states = tuple(measured_states(model, r) for r in records)
    inputs = tuple(inputs_of(model, r) for r in records)
    problem = WeakForm(model, states, inputs, records[0].dt, seconds, np.ones(len(model.states)))
    point = np.clip(point, problem.lower, problem.upper)
    known = np.all([np.ptp(x, axis=0) > 0 for x in states], axis=0)
    floor = 1e-9 * np.max(np.abs(np.concatenate(states)), axis=0)
    for _ in range(rounds):
        residual = problem.linearised(point)[0]
        spread = np.maximum(np.sqrt(np.mean(residual**2, axis=0)), floor)
        problem = replace(problem, spread=np.where(known, spread, np.inf))
        point = levenberg_marquardt(problem, point, np.zeros((0, 0)), evaluations=30).solution.point
    return point
