"""Runs as they might have come out: coefficients, offsets and process noise drawn from what the training leaves open.

How far the draws scatter about a prediction is the part of its error that can be foreseen.
"""

from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.simulate.channels import inputs_of
from seatrial.physics.simulate.linear import batch_class

# s for which a disturbance of the states is held constant, ours
_KICK_SECONDS = 0.5


@dataclass(frozen=True, eq=False)
class PredictionUncertainty:
    """What makes a run differ from its prediction, as far as the training runs show it.

    Attributes:
        coefficients: covariance of the free coefficients, shape (n, n).
        offsets: covariance, between sessions, of what each has of its own, shape (k, k).
        process: intensity of each state's process noise, SI over the root of a second, shape (nx,).
        degrees_of_freedom: of Student's t.
    """

    coefficients: Array
    offsets: Array
    process: Array
    degrees_of_freedom: float


def simulate_points(
    template: OutputError, model: Model, record: Record, start: Array, points: Array, nuisances: Array
) -> Array:
    """Return all observables along a record's inputs for many sets of unknowns, shape (m, rows, observables).

    template: the problem whose unknowns these are; start: initial states (m, nx); points: free coefficients (m, n);
    owns: a session's own unknowns (m, k). NaN after a divergence.
    """
    return _simulate(template, model, record.dt, inputs_of(model, record), start, points, nuisances)


def draw_runs(
    template: OutputError,
    model: Model,
    record: Record,
    start: Array,
    nuisances: Array,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
    count: int,
) -> Array:
    """Return `count` runs from the inputs of `record` about the model's values, (count, rows, observables).

    start: initial state (nx,), the same for all; own: the session's own unknowns (k,).
    """
    point = np.array([model.parameters[n].value for n in template.free])
    points = point + rng.standard_normal((count, len(point))) @ square_root(uncertainty.coefficients).T
    owns = nuisances + rng.standard_normal((count, len(nuisances))) @ square_root(uncertainty.offsets).T
    inputs, begin = inputs_of(model, record), np.tile(start, (count, 1))
    if not np.any(uncertainty.process):
        return _simulate(template, model, record.dt, inputs, begin, points, owns)
    steps = max(1, round(_KICK_SECONDS / record.dt))
    kick = uncertainty.process * np.sqrt(steps * record.dt)
    pieces = []
    for first in range(0, len(inputs) - 1, steps):
        piece = _simulate(template, model, record.dt, inputs[first : first + steps + 1], begin, points, owns)
        pieces.append(piece if first == 0 else piece[:, 1:])
        begin = piece[:, -1, : len(model.states)] + kick * rng.standard_normal((count, len(kick)))
    return np.concatenate(pieces, axis=1)


def square_root(covariance: Array) -> Array:
    """Return a square root of a covariance that may be singular, shape (n, n)."""
    if covariance.size == 0:
        return covariance
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _simulate(
    template: OutputError, model: Model, dt: float, inputs: Array, start: Array, points: Array, nuisances: Array
) -> Array:
    count, parameters = len(points), model.parameters
    split = len(template.session_parameters)
    values = np.tile(parameters.values, (count, 1))
    values[:, [parameters.index(n) for n in template.free]] = points
    values[:, [parameters.index(n) for n, _ in template.session_parameters]] = nuisances[:, :split]
    batch = batch_class(model)(
        model,
        np.tile(inputs, (count, 1)),
        np.arange(count + 1) * len(inputs),
        dt,
        model.observables,
        corrections=tuple(n.correction for n in template.nuisances),
        substeps=template.substeps,
    )
    y, _ = batch.simulate(0, count, start, values, np.ascontiguousarray(nuisances[:, split:]))
    return y.reshape(count, len(inputs), -1)
