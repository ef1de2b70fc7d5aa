"""Which interval is defensible for this fit, and the interval itself."""

from dataclasses import replace

import numpy as np

from seatrial.identify.estimate import Estimate
from seatrial.identify.settings import WHITE_INFLATION
from seatrial.information.covariance import (
    Interval,
    from_information,
    inverse,
    one_step_jackknife,
    sandwich,
    with_prior,
)

_RUNS_FOR_JACKKNIFE = 4
_BLOCKS_FOR_SANDWICH = 10


def intervals(made: Estimate, inflation: np.ndarray) -> Interval:
    """Information matrix where residuals are white; else one-step jackknife over runs, or a sandwich over segments.

    With few runs and few segments the information matrix is left, of the effective number of samples (the problem's
    `inflation`).
    """
    problem, normal = made.problem, made.optimum.normal
    hessian = normal.reduced()[1]
    if np.max(inflation) <= WHITE_INFLATION:
        return from_information(hessian)
    blocks = problem.blocks(made.shared, made.optimum.local)

    def reduced(chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return problem.assembled(blocks, made.shared, chosen, with_prior=False).reduced()

    runs = [np.flatnonzero(problem.data.run == r) for r in range(len(problem.data.runs))]
    if len(runs) >= _RUNS_FOR_JACKKNIFE:
        parts = [reduced(chosen) for chosen in runs]
        left_out = one_step_jackknife(hessian, np.array([g for g, _ in parts]), np.array([h for _, h in parts]))
        return _offsets_by_information(with_prior(left_out, hessian, problem.priors[1]), hessian, len(problem.free))
    if problem.data.count >= _BLOCKS_FOR_SANDWICH:
        scores = np.array([reduced(np.array([s]))[0] for s in range(problem.data.count)])
        return with_prior(sandwich(hessian, scores), hessian, problem.priors[1])
    meaning = "information matrix, correlated samples counted as their effective number"
    return replace(from_information(hessian), meaning=meaning)


def _offsets_by_information(interval: Interval, hessian: np.ndarray, coefficients: int) -> Interval:
    """Errors of a session's own unknowns from the information matrix: a run left out says nothing about its offset."""
    covariance = interval.covariance.copy()
    covariance[coefficients:, :] = covariance[:, coefficients:] = 0.0
    covariance[coefficients:, coefficients:] = inverse(hessian)[coefficients:, coefficients:]
    return replace(interval, covariance=covariance)
