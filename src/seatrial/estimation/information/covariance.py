"""Covariance of estimates: from the information matrix, from runs left out, or from blocks.

White-noise errors are valid only for white residuals; the other two stay valid under model error and coloured noise.
"""

from dataclasses import dataclass

import numpy as np

from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array

_LEAST_SHARE = 0.01
"""Of the information on a direction, that the other runs must hold to stand for one: ten times the error; chosen"""


@dataclass(frozen=True, eq=False)
class Interval:
    """Covariance of the shared unknowns, degrees of freedom of Student's t, and what it means in words."""

    covariance: Array
    degrees_of_freedom: float
    meaning: str

    @property
    def standard_error(self) -> Array:
        """Square roots of the diagonal."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def half_width(self) -> Array:
        """Half widths of the 95 % intervals."""
        return two_sided_quantile(STORED_LEVEL, self.degrees_of_freedom) * self.standard_error


def inverse(hessian: Array) -> Array:
    """Inverse of a symmetric positive matrix in its own scales; singular directions get a huge variance, not zero."""
    root = _whitening(hessian)
    return root @ root.T


def _whitening(hessian: Array) -> Array:
    """W with W' H W = 1, in which H's inverse is W W'; of singular directions huge, not infinite."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-100))  # above zero, for a division
    values, vectors = np.linalg.eigh(hessian * scale[:, None] * scale[None, :])
    values = np.maximum(values, 1e-14 * values[-1])  # rounding of double precision; chosen
    return scale[:, None] * vectors / np.sqrt(values)


def from_information(hessian: Array) -> Interval:
    """Inverse of the Fisher information: the Cramer-Rao bound (Rao 1945), for white residuals."""
    return Interval(inverse(hessian), np.inf, "information matrix, every sample counted as independent")


def jackknife_steps(hessian: Array, run_gradients: Array, run_hessians: Array) -> Array:
    """One Gauss-Newton step from the joint optimum for each run left out, theta_(-i) - theta = (H - H_i)^-1 g_i.

    From the stored normal equations (Hinkley 1977): run_gradients (n, k), run_hessians (n, k, k); returns (n, k). In
    the eigenvectors of H_i by H the step is g/(1 - l), l the share of the information that the run holds. Where it
    holds all but `_LEAST_SHARE`, the other runs do not identify the direction, and g/(1 - l) is 0/0: the step is then
    of the size that gives `jackknife` the variance of the information matrix, the limit for l to 1 of the variance that
    is unbiased for any l (HC2; MacKinnon and White 1985, J. Econometrics 29, 305, eq. 6).
    """
    count, whitening = len(run_gradients), _whitening(hessian)
    steps = np.empty_like(run_gradients)
    for i, (gradient, run_hessian) in enumerate(zip(run_gradients, run_hessians, strict=True)):
        shares, vectors = np.linalg.eigh(whitening.T @ run_hessian @ whitening)
        directions = whitening @ vectors
        push, left = directions.T @ gradient, 1.0 - shares
        alone = left < _LEAST_SHARE
        size = np.where(alone, np.copysign(count / (count - 1.0), push), push / np.where(alone, 1.0, left))
        steps[i] = directions @ size
    return steps


def jackknife(points: Array, meaning: str) -> Interval:
    """Covariance from estimates with one run left out each, (n, k): (n - 1)/n sum of outer products about their mean.

    Tukey 1958, Ann. Math. Stat. 29, 614.
    """
    count = len(points)
    centred = points - points.mean(axis=0)
    return Interval((count - 1) / count * centred.T @ centred, count - 1, meaning)


def bootstrap(points: Array, runs: int, meaning: str) -> Interval:
    """Covariance of estimates from runs drawn with replacement, points (n, k) (Efron 1979, Ann. Stat. 7, 1).

    The variance of a mean of `runs` drawn values is too small by (runs - 1)/runs, which is put right.
    """
    centred = points - points.mean(axis=0)
    covariance = runs / (runs - 1) * centred.T @ centred / (len(points) - 1)
    return Interval(covariance, runs - 1, meaning)


def sandwich(hessian: Array, block_gradients: Array) -> Interval:
    """H^-1 (sum g g') H^-1 over blocks longer than the residuals' memory (Huber 1967; White 1982)."""
    count = len(block_gradients)
    bread = inverse(hessian)
    factor = count / max(count - 1, 1)
    covariance = bread @ (factor * block_gradients.T @ block_gradients) @ bread
    return Interval(covariance, max(count - 1, 1), f"sandwich over {count} blocks")


def with_prior(interval: Interval, hessian: Array, precision: Array) -> Interval:
    """Add what priors and other data may be wrong by: H^-1 P H^-1, P (k, k) the variance of their score.

    Leaving runs out never moves a prior, so without this a coefficient held by its prior would seem certain.
    """
    bread = inverse(hessian)
    covariance = interval.covariance + bread @ precision @ bread
    return Interval(covariance, interval.degrees_of_freedom, f"{interval.meaning}, with the priors' own uncertainty")
