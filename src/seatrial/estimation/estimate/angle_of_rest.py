"""What slow forces leave open of the angle of rest of roll decays: wind, people who move, a hawser.

They heel the ship from run to run and within a run, far below the rhythm of its roll, where the residuals of few decays
do not show their strength. The estimate with one run left out moves by as much as the forces differ, whatever their
memory: jackknife (Hinkley 1977), with n runs Student's t of n - 1 degrees of freedom. Of one run the two slowest
cosines of its influence (Hampel 1974) stand for that (Mueller 2007, J. Econometrics 141, 1331): forces slower than the
run stay unknown.
"""

from dataclasses import replace

import numpy as np

from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise_interval import inverse_variances, without_initial_state
from seatrial.estimation.estimate.resampling import run_scores
from seatrial.estimation.information.covariance import Interval, inverse

ANGLE_OF_REST = "phi_0"
"""Parameter of a roll model for the angle at which the ship comes to rest [rad]."""

COSINES = 2
"""Cosines over a single run that measure slow forces: with one more, memories of a third of a run escape; chosen."""


def with_slow_forces(interval: Interval, estimate: PointEstimate, residuals: Array) -> Interval:
    """Return the interval with that of the angle of rest as wide as the runs' slow forces make it, never narrower.

    Meant for few decays whose residuals (rows, ny) are not white; without a free angle of rest it stays as it is.
    """
    if ANGLE_OF_REST not in estimate.problem.free:
        return interval
    place = estimate.problem.free.index(ANGLE_OF_REST)
    runs = len(estimate.problem.data.runs)
    if runs > 1:
        by_runs = run_scores(estimate).interval("")
        deviation, freedom = float(by_runs.standard_error[place]), by_runs.degrees_of_freedom
    else:
        deviation, freedom = _within_run(_influence(estimate, residuals, place)), float(COSINES)
    quantiles = (two_sided_quantile(STORED_LEVEL, f) for f in (freedom, interval.degrees_of_freedom))
    needed = deviation * next(quantiles) / next(quantiles)  # that gives this half width with the interval's own freedom
    covariance = interval.covariance.copy()
    covariance[place, place] = max(covariance[place, place], needed**2)
    how = f"one-step jackknife over {runs} runs" if runs > 1 else "the slow changes of its only run"
    return replace(interval, covariance=covariance, meaning=f"{interval.meaning}; {ANGLE_OF_REST} by {how}")


def _influence(estimate: PointEstimate, residuals: Array, place: int) -> Array:
    """Return what every sample of the only run adds to the error of a coefficient, rad, (rows,)."""
    problem = estimate.problem
    row = inverse(estimate.optimum.normal.without_local()[1])[place]
    slopes = problem.slopes(estimate.common_parameters, estimate.optimum.local)
    eliminated = without_initial_state(slopes, len(row), inverse_variances(problem))
    return np.einsum("tyk,k,ty->t", eliminated, row, np.nan_to_num(residuals))


def _within_run(part: Array) -> float:
    """Return the standard deviation of the sum of these, (rows,), from the slowest cosines over the run.

    Each cosine's coefficient has the variance of the sum where the parts change more slowly than the cosines.
    """
    phase = np.pi * (np.arange(len(part)) + 0.5) / len(part)
    sums = [np.sqrt(2.0) * part @ np.cos(k * phase) for k in range(1, COSINES + 1)]
    return float(np.sqrt(np.mean(np.square(sums))))
