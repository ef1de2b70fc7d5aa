"""The state at the start of a window or run, estimated from its first seconds, and what it may be instead."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.estimation.information.autocorrelation import autocorrelation, variance_inflation
from seatrial.estimation.predict.draws import StartStates
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import compared_outputs, segments_between
from seatrial.numerics.optimise import levenberg_marquardt

EVALUATIONS = 40
"""Of the search for what a run's first seconds show; chosen: a few are enough."""
_LEAST_FREEDOM = 0.5  # share of effective samples that initial states leave free, at least; chosen


def start_states(
    template: OutputError, model: Model, windows: Windows, nuisances: Array, seconds: float
) -> StartStates:
    """Return the state at the start of each window, the model held.

    By output error from the first `seconds`; as measured where they are 0, and in windows that the model leaves from
    there within them. What follows the commands alone (thrusters) follows those of the whole run.

    Args:
        template: the problem whose outputs, noise and nuisances are used.
        nuisances: of each run, (runs, k).

    Raises:
        InputError: an input is missing, or time steps differ.
    """
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    outputs = template.data.outputs if seconds > 0.0 else compared_outputs(model, windows.records)
    beginnings = windows.beginnings(seconds)
    sessions = [str(i) for i in range(len(windows.records))]
    data = segments_between(held, windows.records, outputs, beginnings.bounds, sessions)
    problem = replace(template, model=held, data=data, pinned=nuisances.ravel(), inflation=None)
    local = problem.measured_initial_states()
    place = np.array([model.states.index(s) for s in problem.starts], dtype=np.int64)
    by_offsets = np.zeros((len(local), len(model.states), nuisances.shape[1]))
    covariance = np.zeros((len(local), len(model.states), len(model.states)))
    if seconds > 0.0 and len(lasting := _lasting(problem, local)):
        part = replace(problem, data=data.selected(lasting)) if len(lasting) < len(local) else problem
        estimated = levenberg_marquardt(part, nuisances.ravel(), local[lasting], evaluations=EVALUATIONS).local
        local[lasting] = estimated
        by_offsets[np.ix_(lasting, place)], covariance[np.ix_(lasting, place, place)] = _alternatives(part, estimated)
    return StartStates(problem.unpack(nuisances.ravel(), local)[0], by_offsets, covariance)


def _lasting(problem: OutputError, local: Array) -> Index:
    """Return the segments in which the model, begun there, does not diverge."""
    assert problem.pinned is not None
    y = problem.simulated_outputs(problem.pinned, local)
    return np.flatnonzero([np.isfinite(y[a:b]).all() for a, b in pairwise(problem.data.offsets)])


def _alternatives(problem: OutputError, local: Array) -> tuple[Array, Array]:
    """Derivatives of estimated initial states by offsets, (segments, m, k), and their covariance, (segments, m, m).

    At the optimum the gradient by the initial state stays zero: dx/do = -H_xx^-1 H_xo. The residuals of all segments
    give the noise of each channel and its colour: the covariance is H_xx^-1 J'WRWJ H_xx^-1 (Huber 1967).
    """
    assert problem.pinned is not None
    residuals = problem.simulated_outputs(problem.pinned, local) - problem.data.measured
    pieces = [residuals[a:b] for a, b in pairwise(problem.data.offsets)]
    lags = max(len(piece) for piece in pieces) - 1
    colour = np.array([
        variance_inflation(autocorrelation([piece[:, c] for piece in pieces], lags)) for c in range(residuals.shape[1])
    ])  # fmt: skip
    effective = np.maximum(np.isfinite(residuals).sum(axis=0), 1) / colour
    freedom = np.maximum(1.0 - local.size / len(colour) / effective, _LEAST_FREEDOM)
    variance = np.sum(np.nan_to_num(residuals) ** 2, axis=0) / (effective * freedom)
    noise = np.sqrt(np.maximum(variance, np.finfo(float).tiny))
    blocks = problem.segment_normals(problem.pinned, local)
    scatter = replace(problem, noise=problem.noise**2 / noise).segment_normals(problem.pinned, local)
    n = blocks.shared
    bread = np.linalg.pinv(blocks.hessians[:, n:, n:], hermitian=True)
    return -bread @ blocks.hessians[:, n:, :n], bread @ scatter.hessians[:, n:, n:] @ bread
