"""Test whether the latest stretch of a record gives other coefficients than the data before it.

Both tests are Hausman's (1978, Econometrica 46, eq. (2.3)): a difference of estimates against its covariance, which is
chi-squared where the ship has stayed the same. The covariances must be honest: noise as it is, colour counted.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import gammaincc

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array, InputError

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
