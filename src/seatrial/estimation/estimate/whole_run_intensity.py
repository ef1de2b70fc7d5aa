"""How strong the process noise is that whole runs show, where its memory hides it from one step to the next.

Slow forces with a memory of seconds hardly show from sample to sample, and drive a lightly damped roll in its own
rhythm all the same: the white noise of their effect there is found from the size of what output error leaves of whole
runs. Expected is, with the residuals r = (I - P) e of errors e of covariance S, P the projection upon what was fitted,

    E(r' W r) = tr(W S) - tr(P S) + that of the sensors     (Seber & Lee 2003, theorem 1.5 and section 3.3).
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import NoiseEvidence, ProcessNoise
from seatrial.estimation.estimate.process_noise_interval import (
    driven_variance,
    inverse_variances,
    without_initial_state,
)

_ROUNDING = 1e-12  # of the largest singular value, below which one is none; chosen


def with_whole_run_intensity(process_noise: ProcessNoise, estimate: PointEstimate, residuals: Array) -> ProcessNoise:
    """Return the process noise at least as strong as the residuals (rows, ny) of an estimate over whole runs show."""
    trust = inverse_variances(estimate.problem)
    sensors = float(np.sum(trust * np.array(list(process_noise.measurement_noise.values())) ** 2))
    found = float(np.sum(trust * np.nan_to_num(residuals) ** 2)) - sensors
    problem, point = process_noise.problem, process_noise.optimum.solution.point.copy()
    driven = slice(problem.runs.size, problem.runs.size + len(problem.process))
    if not np.any(point[driven]):  # SI; any size: it is scaled
        point[driven] = 1.0
    begun = _with_point(process_noise, point)
    share = found / max(_expected(begun, estimate), np.finfo(float).tiny)
    scaled = point.copy()
    scaled[driven] *= share
    by_runs = _with_point(process_noise, np.maximum(scaled, process_noise.optimum.solution.point))
    return replace(by_runs, evidence=NoiseEvidence.WHOLE_RUNS)


def _with_point(process_noise: ProcessNoise, point: Array) -> ProcessNoise:
    optimum = process_noise.optimum
    return replace(process_noise, optimum=replace(optimum, solution=replace(optimum.solution, point=point)))


def _expected(process_noise: ProcessNoise, estimate: PointEstimate) -> float:
    """The weighted sum of squares that the noise in the states leaves of whole runs after the fit."""
    problem = estimate.problem
    slopes, trust = problem.slopes(estimate.common_parameters, estimate.optimum.local), inverse_variances(problem)
    intensity = np.array([process_noise.process_intensities.get(s, 0.0) for s in problem.model.states])
    variance = intensity**2 * problem.data.dt
    count = len(estimate.common_parameters)
    information, score, total = np.zeros((count, count)), np.zeros((count, count)), 0.0
    for run, (a, b) in enumerate(pairwise(problem.data.offsets)):
        columns = problem.columns_of(int(problem.data.session[run]))
        moved, observation = process_noise.problem.transitions(run, estimate.common_parameters, estimate.optimum.local)
        own = without_initial_state(slopes[a:b], len(columns), trust[a:b])
        own_score = driven_variance(own.transpose(0, 2, 1) @ observation, moved, variance)
        information[np.ix_(columns, columns)] += np.einsum("tyk,tyl->kl", own, slopes[a:b, :, : len(columns)])
        score[np.ix_(columns, columns)] += own_score
        begun = slopes[a:b, :, len(columns) :]
        weighted = begun * trust[a:b, :, None]
        by_start = driven_variance(weighted.transpose(0, 2, 1) @ observation, moved, variance)
        total += _driven_spread(observation, moved, variance, trust[a:b])
        total -= _trace_of_ratio(np.einsum("tyk,tyl->kl", weighted, begun), by_start)
    return total - _trace_of_ratio(information, score)


def _trace_of_ratio(normal: Array, score: Array) -> float:
    """The trace of normal^-1 score, where normal may be singular."""
    return float(np.trace(np.linalg.lstsq(normal, score, rcond=_ROUNDING)[0]))


def _driven_spread(observation: Array, transitions: Array, variance: Array, weights: Array) -> float:
    """The weighted sum of the variances of all outputs, x driven by white noise as in `driven_variance`."""
    half = 0.5 * np.diag(variance)
    spread, total = np.zeros_like(half), 0.0
    for t in range(1, len(weights)):
        spread = transitions[t - 1] @ (spread + half) @ transitions[t - 1].T + half
        total += float(weights[t] @ np.einsum("yi,ij,yj->y", observation[t], spread, observation[t]))
    return total
