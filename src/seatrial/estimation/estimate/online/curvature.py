"""Whether a fit is good enough for a filter to take over: how far its model bends within one standard error.

A filter never looks back: what is curved at the scale of the first errors stays in its estimate for good. The measure
is the relative curvature of Bates & Watts 1980 (J. R. Stat. Soc. B 42, eq. (2.5)), parameter effects and intrinsic
together, along the principal axes of the coefficients' covariance.
"""

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations

LINEAR_ENOUGH = 0.15
"""Below it a filter ended within 0.15 standard errors of the batch in all of 90 streams of heave and pitch, handed over
after 10 to 60 s; at 0.8 it was off by up to one, at 1.6 by up to three (waterjet zigzags)."""


def curvature(problem: OutputError, common_parameters: Array, initial_states: Array, normal: NormalEquations) -> float:
    """Return the largest curvature over the principal axes: second difference of outputs, one standard error each way.

    In units of what the same step changes to first order, which is one standard deviation of noise; infinite where the
    coefficients are not all identifiable or a ship within their errors blows up. Initial states go along with the
    coefficients. Costs two simulations for each unknown.
    """
    information = normal.without_local()[1]
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))  # above zero, for a division
    scaled = information / np.outer(scale, scale)
    if not np.all(np.isfinite(scaled)):
        return np.inf
    values, vectors = np.linalg.eigh(scaled)
    if values[0] < 1e-13:  # rounding of a singular matrix; chosen
        return np.inf
    axes = (vectors / np.sqrt(values)).T / scale
    follow = -np.linalg.pinv(normal.local_hessian, hermitian=True) @ np.swapaxes(normal.cross, 1, 2)
    weight = np.where(np.isfinite(problem.data.measured), 1.0 / problem.noise, 0.0)
    if problem.inflation is not None:
        weight = weight / np.sqrt(problem.inflation)
    here = problem.simulated_outputs(common_parameters, initial_states)
    largest = 0.0
    for axis in axes:
        step = follow @ axis
        with np.errstate(over="ignore", invalid="ignore"):
            both = problem.simulated_outputs(
                common_parameters + axis, initial_states + step
            ) + problem.simulated_outputs(common_parameters - axis, initial_states - step)
            bend = float(np.linalg.norm(weight * (0.5 * both - here)))
        if not np.isfinite(bend):
            return np.inf
        largest = max(largest, bend)
    return largest
