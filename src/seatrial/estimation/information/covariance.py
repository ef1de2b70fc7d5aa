"""Covariance of estimates: from the information matrix, from runs left out, or from blocks.

White-noise errors are valid only for white residuals; the other two stay valid under model error and coloured noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True, eq=False)
class RunScores:
    """What each of n runs says at the joint optimum of k shared unknowns, from the stored normal equations.

    In the eigenvectors of a run's information by that of all, `shares` are those of the information that it holds.

    Attributes:
        pushes: gradient of the run, (n, k).
        shares: from 0 to 1, (n, k).
        directions: in columns, (n, k, k).
    """

    pushes: Array
    shares: Array
    directions: Array

    @classmethod
    def from_normals(cls, hessian: Array, run_gradients: Array, run_hessians: Array) -> "RunScores":
        """Return those of runs with gradients (n, k) and Hessians (n, k, k), of which `hessian` (k, k) is the sum."""
        whitening = _whitening(hessian)
        shares, vectors = np.linalg.eigh(whitening.T @ run_hessians @ whitening)
        directions = whitening @ vectors
        return cls(np.einsum("ikd,ik->id", directions, run_gradients), shares, directions)

    @property
    def others_share(self) -> Array:
        """Shares that the other runs hold; one where they do not identify the direction."""
        return np.where(self.is_alone, 1.0, 1.0 - self.shares)

    @property
    def is_alone(self) -> NDArray[np.bool_]:
        """Whether the run holds all but `_LEAST_SHARE`, so that g/(1 - l) would divide rounding by rounding."""
        return 1.0 - self.shares < _LEAST_SHARE

    @property
    def left_out_steps(self) -> Array:
        """One Gauss-Newton step from the joint optimum for each run left out, theta_(-i) - theta = (H - H_i)^-1 g_i.

        (n, k), Hinkley 1977; where a run is alone, by as much as the other runs scatter.
        """
        count = len(self.pushes)
        size = np.where(self.is_alone, np.copysign(count / (count - 1.0), self.pushes), self.pushes / self.others_share)
        return np.einsum("ikd,id->ik", self.directions, size)

    def interval(self, meaning: str) -> Interval:
        """Return the covariance that is unbiased whatever share of the information a run holds.

        Sum of s s' with s = g/sqrt(1 - l) in the eigenvectors (CR2 of Bell and McCaffrey 2002, Survey Methodology 28,
        169; HC2 of MacKinnon and White 1985, J. Econometrics 29, 305, eq. 6, where a run is a sample). The
        jackknife's g/(1 - l) is the same where all runs hold as much, and too wide by 1/(1 - l) where one holds most.
        Where a run is alone, the information matrix's, the limit for l to 1.
        """
        size = np.where(self.is_alone, np.copysign(1.0, self.pushes), self.pushes / np.sqrt(self.others_share))
        parts = np.einsum("ikd,id->ik", self.directions, size)
        return Interval(parts.T @ parts, len(parts) - 1, meaning)


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


def with_prior(interval: Interval, hessian: Array, score_variance: Array) -> Interval:
    """Add what priors and other data may be wrong by: H^-1 P H^-1, P (k, k) the variance of their score.

    Leaving runs out never moves a prior, so without this a coefficient held by its prior would seem certain.
    """
    bread = inverse(hessian)
    covariance = interval.covariance + bread @ score_variance @ bread
    return Interval(covariance, interval.degrees_of_freedom, f"{interval.meaning}, with the priors' own uncertainty")


def excess_spread(values: Array, errors: Array) -> tuple[float, float]:
    """Return the probability of such a scatter by the errors alone, and the standard deviation beyond them.

    Q of Cochran 1954 (Biometrics 10, 101-129), and the moment estimate of DerSimonian & Laird 1986 (Controlled Clinical
    Trials 7, 177-188, eq. 8). values, errors: (n,), those that are not finite left out.
    """
    from scipy.special import chdtrc

    usable = np.isfinite(values) & np.isfinite(errors) & (errors > 0.0)
    value, weight = values[usable], errors[usable] ** -2.0
    if len(value) < 2:
        return 1.0, 0.0
    q = float(weight @ (value - weight @ value / weight.sum()) ** 2)
    freedom = len(value) - 1
    excess = (q - freedom) / float(weight.sum() - weight @ weight / weight.sum())
    return float(chdtrc(freedom, q)), float(np.sqrt(max(excess, 0.0)))
