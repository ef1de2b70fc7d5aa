"""Sessions as a population: what each has of its own (a rudder's zero, a current) is normal about a common mean.

Mean and variance between sessions maximise the marginal likelihood in Laplace's approximation: the records enter by
their stored normal equations, from which everything else is eliminated (Laird & Ware 1982, Biometrics 38, 963).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, Prior

_STEPS = 20
"""Steps of expectation and maximisation at a time, which the rounds of a fit repeat; chosen."""

_SETTLED = 1e-3
"""Relative change of a standard deviation at which the steps end sooner; chosen."""


@dataclass(frozen=True, eq=False)
class SessionPopulation:
    """What sessions have of their own, k kinds: normal about a mean that may change with a covariate of the session.

    Attributes:
        declared: of each kind, what is assumed before any record.
        mean: (k,), SI, of a session whose covariates are those of the average session.
        slope: (k,), SI, change of the mean for a covariate one standard deviation above the average.
        deviation: (k,), SI, between sessions.
        trend_covariance: of mean and slope, (2k, 2k).
        covariate_mean, covariate_deviation: (k,), over the sessions that were fitted; 0 where none is declared.
        is_centred: (k,), whether the mean is the declared one: a current of another day has no direction of its own.
        is_spread_fixed: (k,), whether the deviation is the declared one: estimated, it would take model error for a
            delay that changes from session to session.
    """

    declared: tuple[Prior, ...]
    mean: Array
    slope: Array
    deviation: Array
    trend_covariance: Array
    covariate_mean: Array
    covariate_deviation: Array
    is_centred: NDArray[np.bool_]
    is_spread_fixed: NDArray[np.bool_]

    @classmethod
    def as_declared(cls, declared: Sequence[Prior], covariates: Array, centred: int = 0) -> "SessionPopulation":
        """Return the population before anything is fitted: declared means and deviations, no slope.

        covariates: of each session and kind, (sessions, k); zero where a kind has none.
        centred: number of kinds, the first, whose mean stays the declared one.
        """
        mean, deviation = (np.array([getattr(p, n) for p in declared]) for n in ("mean", "standard_deviation"))
        k = len(declared)
        spread = np.std(covariates, axis=0)
        return cls(
            tuple(declared), mean, np.zeros(k), deviation, np.zeros((2 * k, 2 * k)), covariates.mean(axis=0), spread,
            np.arange(k) < centred, np.zeros(k, dtype=np.bool_),
        )  # fmt: skip

    def with_fixed_spread(self, is_fixed: Sequence[bool]) -> "SessionPopulation":
        """Return the population with the deviation of these kinds as declared for good."""
        return replace(self, is_spread_fixed=np.array(is_fixed, dtype=np.bool_))

    def with_kinds(self, declared: Sequence[Prior]) -> "SessionPopulation":
        """Return the population with further kinds behind its own, as declared, without covariates."""
        more = self.as_declared(declared, np.zeros((1, len(declared))))
        arrays = (
            "mean", "slope", "deviation", "covariate_mean", "covariate_deviation", "is_centred", "is_spread_fixed",
        )  # fmt: skip
        joined = {name: np.concatenate([getattr(self, name), getattr(more, name)]) for name in arrays}
        size = 2 * len(joined["mean"])  # the trend is estimated again with all kinds
        return replace(self, declared=(*self.declared, *declared), trend_covariance=np.zeros((size, size)), **joined)

    def standardised(self, covariates: Array) -> Array:
        """Return covariates (..., k) in standard deviations from the average session's, 0 where they never vary."""
        spread = self.covariate_deviation
        return np.where(spread > 0.0, covariates - self.covariate_mean, 0.0) / np.where(spread > 0.0, spread, 1.0)

    def means(self, covariates: Array) -> Array:
        """Return what sessions with these covariates are expected to have, both (..., k)."""
        return self.mean + self.slope * self.standardised(covariates)

    def of_new_session(self, offsets: Array, covariates: Array, new: Array) -> Array:
        """Return what a new session is expected to have by these sessions alone, (k,): their mean, moved by the slope.

        A mean that is the declared one stays so.

        offsets, covariates: of the sessions, (sessions, k); new: covariates of the new one, (k,).
        """
        moved = self.standardised(new) - self.standardised(covariates)
        return np.where(self.is_centred, self.means(new), np.mean(offsets + self.slope * moved, axis=0))

    @property
    def new_session_covariance(self) -> Array:
        """Covariance of what a new session has about its expected value, (k, k), averaged over covariates as fitted."""
        k = len(self.mean)
        blocks = self.trend_covariance
        slope = np.where(np.diag(self.covariate_deviation > 0.0), blocks[k:, k:], 0.0)
        return np.diag(self.deviation**2) + blocks[:k, :k] + slope

    def fitted(self, offsets: Array, precision: Array, covariates: Array) -> "SessionPopulation":
        """Return the population nearer to the greatest marginal likelihood, begun at this one.

        Args:
            offsets: at the optimum, (sessions, k).
            precision: of the offsets in that order, all other unknowns eliminated, this population's own included,
                (sessions k, sessions k).
            covariates: (sessions, k).
        """
        weight = np.tile(self.deviation**-2.0, len(offsets))
        records = _non_negative(precision - np.diag(weight))
        # at the optimum the gradient of the records' cost is the opposite of the population's
        pull = records @ offsets.ravel() + weight * (offsets - self.means(covariates)).ravel()
        now = self
        for _ in range(_STEPS):
            before, now = now, now._step(records, pull, self.standardised(covariates))
            if np.max(np.abs(np.log(now.deviation / before.deviation))) < _SETTLED:
                break
        return now

    def _step(self, records: Array, pull: Array, covariates: Array) -> "SessionPopulation":
        """Offsets, mean and slope given the deviation, then the deviation given their second moments."""
        sessions, k = covariates.shape
        varies = self.covariate_deviation > 0.0
        prior_mean, prior_deviation = (
            np.array([getattr(p, n) for p in self.declared]) for n in ("mean", "standard_deviation")
        )
        is_free = np.where(self.is_centred, 0.0, 1.0)
        trend = np.hstack([np.tile(np.diag(is_free), (sessions, 1)), np.vstack([np.diag(z) for z in covariates])])
        centre = np.tile(np.where(self.is_centred, prior_mean, 0.0), sessions)
        about = np.hstack([np.eye(sessions * k), -trend])
        weight = np.tile(self.deviation**-2.0, sessions)
        precision = about.T @ (weight[:, None] * about)
        precision[: sessions * k, : sessions * k] += records
        precision[sessions * k :, sessions * k :] += np.diag(np.tile(prior_deviation**-2.0, 2))
        covariance = np.linalg.inv(precision)
        right = np.concatenate([pull, prior_mean / prior_deviation**2, np.zeros(k)]) + about.T @ (weight * centre)
        point = covariance @ right
        squares = (about @ point - centre) ** 2 + np.sum((about @ covariance) * about, axis=1)
        deviation = np.array([
            _likeliest_deviation(float(s), sessions - 1 - int(v), float(d))
            for s, v, d in zip(squares.reshape(sessions, k).sum(axis=0), varies, prior_deviation, strict=True)
        ])  # fmt: skip
        deviation = np.where(self.is_spread_fixed, prior_deviation, deviation)
        mean, slope = point[sessions * k :].reshape(2, k)
        is_estimated = np.concatenate([is_free, np.ones(k)])
        return replace(
            self, mean=np.where(self.is_centred, prior_mean, mean), slope=np.where(varies, slope, 0.0),
            deviation=deviation,
            trend_covariance=covariance[sessions * k :, sessions * k :] * np.outer(is_estimated, is_estimated),
        )  # fmt: skip


def _non_negative(information: Array) -> Array:
    """Return the information of the records without directions of negative curvature, which rounding leaves.

    Where records show nothing of an offset, the difference of two equal numbers may be less than nothing, and the
    spread between sessions would grow without end.
    """
    values, vectors = np.linalg.eigh(0.5 * (information + information.T))
    return (vectors * np.maximum(values, 0.0)) @ vectors.T


def _likeliest_deviation(square_sum: float, freedom: int, declared: float) -> float:
    """Return the s > 0 that minimises freedom log(s) + square_sum / (2 s^2) + s / declared.

    The last term and one session more are the gamma prior of shape 2 and scale `declared`, which keeps s from zero and
    decides where sessions are few (Chung et al. 2013, Psychometrika 78, 685): one session leaves what is declared.
    """
    s = max(declared, float(np.sqrt(square_sum)))
    for _ in range(50):  # Newton's steps on a convex cubic from above its root, down to rounding; chosen
        s -= (s**3 / declared + freedom * s**2 - square_sum) / (3.0 * s**2 / declared + 2.0 * freedom * s)
    return s
