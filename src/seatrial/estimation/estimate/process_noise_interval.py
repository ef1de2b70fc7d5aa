"""What an output-error estimate over whole runs is worth where white noise in the states disturbs them.

Output error weighs a run as if its residuals were white. What process noise adds to them is carried through the
linearised motion, so that they are correlated for as long as the ship remembers; the covariance of the estimate is then
H^-1 (sum J' W S W J) H^-1 with the covariance S of such residuals (Huber 1967; White 1982; Maine & Iliff 1985,
section 5.3). Without process noise it is the information matrix.
"""

from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import NoiseEvidence, ProcessNoise
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.estimation.problem.output_error import OutputError

MEANING = {
    NoiseEvidence.ONE_STEP: "covariance of the output-error estimate under the process noise that makes one-step "
    "residuals white, carried through the motion",
    NoiseEvidence.WHOLE_RUNS: "covariance of the output-error estimate under process noise at least as strong as the "
    "residuals of whole runs show, carried through the motion",
}
"""What the interval is, by what shows how strong its process noise is."""


def process_noise_interval(estimate: PointEstimate, process_noise: ProcessNoise) -> Interval:
    """Interval of the shared unknowns of an estimate over whole runs under noise in the states that suits it."""
    problem, hessian = estimate.problem, estimate.optimum.normal.without_local()[1]
    score = problem.prior_score_variance(estimate.common_parameters)
    slopes = problem.slopes(estimate.common_parameters, estimate.optimum.local)
    trust = inverse_variances(problem)
    deviation = np.array(list(process_noise.measurement_noise.values()))
    intensity = np.array([process_noise.process_intensities.get(s, 0.0) for s in problem.model.states])
    for run, (a, b) in enumerate(pairwise(problem.data.offsets)):
        columns = problem.columns_of(int(problem.data.session[run]))
        own = without_initial_state(slopes[a:b], len(columns), trust[a:b])
        moved, observation = process_noise.problem.transitions(run, estimate.common_parameters, estimate.optimum.local)
        carried = own.transpose(0, 2, 1)
        white = np.einsum("tky,y,tly->kl", carried, deviation**2, carried)
        score[np.ix_(columns, columns)] += white + driven_variance(
            carried @ observation, moved, intensity**2 * problem.data.dt
        )
    bread = inverse(hessian)
    return Interval(bread @ score @ bread, np.inf, MEANING[process_noise.evidence])


def inverse_variances(problem: OutputError) -> Array:
    """Return what each sample weighs, (rows, ny): nothing where it is missing."""
    variance = problem.noise**2 if problem.inflation is None else problem.noise**2 * problem.inflation
    return np.where(np.isfinite(problem.data.measured), 1.0 / variance, 0.0)


def without_initial_state(slopes: Array, count: int, weights: Array) -> Array:
    """Return weighted slopes W J, (rows, ny, count), of the first columns, the others (initial state) eliminated."""
    weighted = slopes * weights[:, :, None]
    normal = np.einsum("tyk,tyl->kl", weighted, slopes)
    # rounding of a singular matrix; chosen
    solved = np.linalg.lstsq(normal[count:, count:], normal[count:, :count], rcond=1e-12)[0]
    return weighted[:, :, :count] - weighted[:, :, count:] @ solved


def driven_variance(score: Array, transitions: Array, variance: Array) -> Array:
    """Return the variance (k, k) of sum_t score_t x_t, x driven by white noise, half before and half after each step.

    score (rows, k, nx), moved (rows - 1, nx, nx) transition matrices, variance (nx,) of the noise in one step.
    """
    total, ahead = np.zeros((score.shape[1], score.shape[1])), np.zeros(score.shape[1:])
    for t in range(len(score) - 1, 0, -1):
        after = ahead + score[t]
        ahead = after @ transitions[t - 1]
        total += 0.5 * ((after * variance) @ after.T + (ahead * variance) @ ahead.T)
    return total
