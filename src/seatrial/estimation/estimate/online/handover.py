"""From a fit to a filter: what an output-error fit knows at its last sample, and the filter that goes on from there."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.online.gaussian_state import GaussianState
from seatrial.estimation.estimate.online.recursive import DivergenceGuard, Forgetting, RecursiveFilter
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import batch_class


def gaussian_state_from_fit(
    problem: OutputError, common_parameters: Array, initial_states: Array, normal: NormalEquations
) -> GaussianState:
    """Return the state of an output-error fit at the last sample; `normal` are its normal equations at the optimum.

    Corrections of inputs and a current count as the fit left them; their uncertainty is in the coefficients'.

    Raises:
        InputError: the records do not identify every coefficient.
    """
    model, data, k = problem.model, problem.data, len(problem.free)
    information = normal.without_local()[1]
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))  # above zero, for a division
    scaled = information / np.outer(scale, scale)
    # rounding of a singular matrix; chosen
    if not np.all(np.isfinite(scaled)) or np.linalg.eigvalsh(scaled)[0] < 1e-13:
        raise InputError("the records so far do not identify every coefficient; keep the window until they do")
    covariance = (np.linalg.inv(scaled) / np.outer(scale, scale))[:k, :k]
    first, last = data.offsets[-2:]
    start, values, corrections = problem.unpack(common_parameters, initial_states)
    batch = batch_class(model)(
        model, np.ascontiguousarray(data.inputs[first:last]), np.array([0, last - first]), data.dt, model.states,
        problem.free, tuple(n.correction for n in problem.nuisances), problem.starts, problem.substeps,
    )  # fmt: skip
    y, slopes, _ = batch.differentiate(0, 1, start[-1:], values[-1:], corrections[-1:])
    by_start = slopes[-1, :, len(batch.parameters) + len(batch.corrections) :]
    of_start = np.linalg.pinv(normal.local_hessian[-1], hermitian=True)
    moved = -of_start @ normal.cross[-1, :k].T
    spread = by_start @ of_start @ by_start.T
    return GaussianState(
        common_parameters[:k].copy(),
        0.5 * (covariance + covariance.T),
        y[-1],
        slopes[-1, :, :k] + by_start @ moved,
        0.5 * (spread + spread.T),
    )


def filter_from_fit(
    problem: OutputError,
    common_parameters: Array,
    initial_states: Array,
    normal: NormalEquations,
    *,
    forgetting: Forgetting | None = None,
    guard: DivergenceGuard | None = None,
) -> RecursiveFilter:
    """Return the filter that continues after the fit's last sample; `normal` as for `gaussian_state_from_fit`.

    Its noise is the fit's, coloured channels counted as the fit counts them; an innovation is cut where the fit's loss
    is (`DivergenceGuard` where that is square). See `curvature` for whether the fit is good enough.

    Raises:
        InputError: the records do not identify every coefficient, or the fit corrects inputs or has a current, which a
            filter does not carry on.
    """
    if problem.unknowns_per_session:
        names = [n for n, _ in problem.session_parameters] + [n.correction.name for n in problem.nuisances]
        raise InputError(f"a filter cannot go on with {', '.join(names)} estimated for each run; keep the window")
    colour = np.ones(len(problem.noise)) if problem.inflation is None else problem.inflation
    guard = guard or DivergenceGuard()
    if np.isfinite(problem.huber):
        guard = replace(guard, huber_limit=problem.huber)
    first, last = problem.data.offsets[-2:]
    return RecursiveFilter(
        problem.model,
        problem.free,
        problem.data.outputs,
        problem.noise * np.sqrt(colour),
        problem.data.dt,
        gaussian_state_from_fit(problem, common_parameters, initial_states, normal),
        recent_inputs=problem.data.inputs[first:last],
        substeps=problem.substeps,
        forgetting=forgetting,
        guard=guard,
    )
