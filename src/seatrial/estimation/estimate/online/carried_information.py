"""Information that outlives its records: a prior on the coefficients, and the test whether they have changed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from scipy.special import gammaincc

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array, Index, InputError
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import Contribution

# Information of discarded records on the coefficients, as a Gaussian prior at the point of linearisation.


@dataclass(frozen=True, eq=False)
class MarginalPrior:
    """Gauss-Newton's model of all discarded data, an `Addend`: gradient' d + 1/2 d' information d, d = theta - point.

    Attributes:
        indices: positions of the coefficients among all model parameters, (k,); point: (k,); information: (k, k).
        gradient: (k,), of the data at the point, where the gradient of the priors is its opposite.
    """

    indices: Index
    point: Array
    information: Array
    gradient: Array

    def cost(self, values: Array) -> float:
        """As `Addend.cost`."""
        off = values[self.indices] - self.point
        return float(self.gradient @ off + 0.5 * off @ self.information @ off)

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """As `Addend.normal`."""
        off = values[self.indices] - self.point
        own = [list(self.indices).index(i) if i in self.indices else -1 for i in free]
        known = np.array([i >= 0 for i in own])
        gradient, hessian = np.zeros(len(own)), np.zeros((len(own), len(own)))
        rows = np.array([i for i in own if i >= 0], dtype=np.int64)
        gradient[known] = (self.gradient + self.information @ off)[rows]
        hessian[np.ix_(known, known)] = self.information[np.ix_(rows, rows)]
        return Contribution(self.cost(values), gradient, hessian)

    def discounted(self, share: float) -> Self:
        """Return the prior with that share of its information: older data count less (exponential forgetting)."""
        return replace(self, information=share * self.information, gradient=share * self.gradient)

    def inflation(self, hessian: Array, covariance: Array) -> float:
        """Return how many times the coefficients' covariance (k, k) exceeds that of white residuals, one at least.

        hessian: as for `marginalise`. Well determined directions weigh most.
        """
        k = len(self.point)
        white = float(np.trace(self.information @ inverse(hessian)[:k, :k]))
        held = float(np.trace(self.information @ covariance))
        return max(held / white, 1.0) if white > 0.0 and np.isfinite(held) else 1.0


def marginalise(indices: Index, point: Array, hessian: Array, mean: Array, weight: Array) -> MarginalPrior:
    """Return the information of the data at the optimum `point` (k,) of data and priors together.

    hessian: of coefficients, then nuisances if any, (n, n), priors included; the nuisances are eliminated.
    mean, weight: of the coefficients' priors, (k,); these stay with the problem and are taken out.
    """
    k = len(point)
    own, tie, rest = hessian[:k, :k], hessian[:k, k:], hessian[k:, k:]
    known = own - tie @ inverse(rest) @ tie.T if len(rest) else own
    return MarginalPrior(indices, point, known - np.diag(weight), -weight * (point - mean))


# Test whether the latest stretch of a record gives other coefficients than the data before it.

_MIN_INFORMATION_SHARE = 1e-6  # share of a direction's variance, below which new data added nothing: rounding


@dataclass(frozen=True, eq=False)
class GaussianEstimate:
    """An estimate of k coefficients and its covariance."""

    value: Array
    covariance: Array


@dataclass(frozen=True)
class ChangeStatistic:
    """A difference of estimates: chi-squared statistic, its degrees of freedom, p, and the largest single move.

    Attributes:
        most_changed: index of the coefficient that moved most in standard errors of its own difference.
    """

    statistic: float
    degrees_of_freedom: int
    p: float
    most_changed: int


def independent_change(before: GaussianEstimate, latest: GaussianEstimate) -> ChangeStatistic:
    """Estimates from different data: the covariance of the difference is the sum of theirs."""
    return _wald_test(latest.value - before.value, before.covariance + latest.covariance, before.covariance)


def nested_change(before: GaussianEstimate, after: GaussianEstimate) -> ChangeStatistic:
    """`after` has the data of `before` and more, both efficient: the difference has covariance P_before - P_after.

    What only the added data say is compared with what was known: the same as `independent` of the two pieces.
    Directions about which the added data say nothing (a millionth of what was known) are left out.
    """
    return _wald_test(after.value - before.value, before.covariance - after.covariance, before.covariance)


def _wald_test(difference: Array, covariance: Array, scale: Array) -> ChangeStatistic:
    """The Wald statistic in the directions that `covariance` spans; `scale` says what is small."""
    unit = np.sqrt(np.diagonal(scale))
    root = np.linalg.cholesky(scale / np.outer(unit, unit))
    inner = np.linalg.solve(root, np.linalg.solve(root, covariance / np.outer(unit, unit)).T)
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
    kept = values > _MIN_INFORMATION_SHARE
    along = vectors.T[kept] @ np.linalg.solve(root, difference / unit)
    statistic, freedom = float(np.sum(along**2 / values[kept])), int(kept.sum())
    p = float(gammaincc(0.5 * freedom, 0.5 * statistic)) if freedom else 1.0
    own = np.maximum(np.diagonal(covariance), _MIN_INFORMATION_SHARE * np.diagonal(scale))
    return ChangeStatistic(statistic, freedom, p, int(np.argmax(np.abs(difference) / np.sqrt(own))))


@dataclass(eq=False)
class ChangeDetector:
    """Test a growing estimate once an interval: the latest interval against all data before it.

    The j-th test may spend alpha / (j (j + 1)) of the false alarms, alpha in all however often it tests (Bonferroni's
    inequality; spending as Lan & DeMets 1983 have it).

    Attributes:
        names: of the coefficients; interval: s between tests; alpha: probability of any false alarm in the stream.
        latest: result of the last test; detected: the last result that was significant.
    """

    names: tuple[str, ...]
    interval: float
    alpha: float = 0.05
    latest: CoefficientChange | None = None
    detected: CoefficientChange | None = None
    _test_count: int = 0
    _since: float = field(default=np.nan)
    _reference: GaussianEstimate | None = None
    _before_restart: GaussianEstimate | None = None

    def __post_init__(self) -> None:
        if not (self.interval > 0.0 and 0.0 < self.alpha < 1.0):
            raise InputError(
                f"a watch for change needs a stretch of more than 0 s and an alpha between 0 and 1, got "
                f"{self.interval:g} s and {self.alpha:g}"
            )

    def update(self, time: float, value: Array, covariance: Array) -> CoefficientChange | None:
        """The estimate from all data up to `time` [s], nothing forgotten; what the last look found, or None before it.

        The first call, and the one after `reset`, only begins a stretch.
        """
        now = GaussianEstimate(np.array(value), np.array(covariance))
        if self._reference is None:
            self._since, self._reference = time, now
        elif time >= self._since + self.interval:
            self._test_count += 1
            moved = (
                nested_change(self._reference, now)
                if self._before_restart is None
                else independent_change(self._before_restart, now)
            )
            self._before_restart = None
            is_told = moved.p <= self.alpha / (self._test_count * (self._test_count + 1))
            self.latest = CoefficientChange(
                self._since, moved.statistic, moved.degrees_of_freedom, moved.p, is_told, self.names[moved.most_changed]
            )
            if is_told:
                self.detected = self.latest
            self._since, self._reference = time, now
        return self.latest

    @property
    def reported(self) -> CoefficientChange | None:
        """The last significant change, else the result of the last test."""
        return self.detected or self.latest

    def reset(self) -> None:
        """Data are counted anew, some of them the same: the next call begins a stretch. What was spent is spent."""
        self._reference = self._before_restart = None

    def restart(self) -> None:
        """The estimate begins anew from nothing but later data: the second call from here compares it with the last."""
        self._before_restart = self._reference or self._before_restart
        self._reference = None
