"""Whether the latest stretch tells other coefficients than what came before it.

Both tests are Hausman's (1978, Econometrica 46, eq. (2.3)): a difference of estimates against its covariance, which is
chi-squared where the ship has stayed the same. The covariances must be honest: noise as it is, colour counted.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import gammaincc

from seatrial.core.results.online import Change
from seatrial.core.values import Array, InputError

_NOTHING_LEARNT = 1e-6


@dataclass(frozen=True, eq=False)
class Told:
    """An estimate of k coefficients and its covariance."""

    value: Array
    covariance: Array


@dataclass(frozen=True)
class Moved:
    """A difference of estimates: chi-squared statistic, its degrees of freedom, p, and the largest single move.

    Attributes:
        most: index of the coefficient that moved most in standard errors of its own difference.
    """

    statistic: float
    freedom: int
    p: float
    most: int


def independent(before: Told, latest: Told) -> Moved:
    """Estimates from different data: the covariance of the difference is the sum of theirs."""
    return _against(latest.value - before.value, before.covariance + latest.covariance, before.covariance)


def nested(before: Told, after: Told) -> Moved:
    """`after` has the data of `before` and more, both efficient: the difference has covariance P_before - P_after.

    What only the added data say is compared with what was known: the same as `independent` of the two pieces.
    Directions about which the added data say nothing (a millionth of what was known) are left out.
    """
    return _against(after.value - before.value, before.covariance - after.covariance, before.covariance)


def _against(difference: Array, covariance: Array, scale: Array) -> Moved:
    """The Wald statistic in the directions that `covariance` spans; `scale` says what is small."""
    unit = np.sqrt(np.diagonal(scale))
    root = np.linalg.cholesky(scale / np.outer(unit, unit))
    inner = np.linalg.solve(root, np.linalg.solve(root, covariance / np.outer(unit, unit)).T)
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
    kept = values > _NOTHING_LEARNT
    along = vectors.T[kept] @ np.linalg.solve(root, difference / unit)
    statistic, freedom = float(np.sum(along**2 / values[kept])), int(kept.sum())
    p = float(gammaincc(0.5 * freedom, 0.5 * statistic)) if freedom else 1.0
    own = np.maximum(np.diagonal(covariance), _NOTHING_LEARNT * np.diagonal(scale))
    return Moved(statistic, freedom, p, int(np.argmax(np.abs(difference) / np.sqrt(own))))


@dataclass(eq=False)
class Watch:
    """Looks at a growing estimate once a stretch: the stretch against all before it.

    The j-th look may spend alpha / (j (j + 1)) of the false alarms, alpha in all however often it looks (Bonferroni's
    inequality; spending as Lan & DeMets 1983 have it).

    Attributes:
        names: of the coefficients; stretch: s between looks; alpha: chance of any false alarm, however long the stream.
        latest: what the last look found; told: the last one that told a change.
    """

    names: tuple[str, ...]
    stretch: float
    alpha: float = 0.05
    latest: Change | None = None
    told: Change | None = None
    _looks: int = 0
    _since: float = field(default=np.nan)
    _before: Told | None = None
    _former: Told | None = None

    def __post_init__(self) -> None:
        if not (self.stretch > 0.0 and 0.0 < self.alpha < 1.0):
            raise InputError(
                f"a watch for change needs a stretch of more than 0 s and an alpha between 0 and 1, got "
                f"{self.stretch:g} s and {self.alpha:g}"
            )

    def look(self, time: float, value: Array, covariance: Array) -> Change | None:
        """The estimate from all data up to `time` [s], nothing forgotten; what the last look found, or None before it.

        The first call, and the one after `reset`, only begins a stretch.
        """
        now = Told(np.array(value), np.array(covariance))
        if self._before is None:
            self._since, self._before = time, now
        elif time >= self._since + self.stretch:
            self._looks += 1
            moved = nested(self._before, now) if self._former is None else independent(self._former, now)
            self._former = None
            is_told = moved.p <= self.alpha / (self._looks * (self._looks + 1))
            self.latest = Change(self._since, moved.statistic, moved.freedom, moved.p, is_told, self.names[moved.most])
            if is_told:
                self.told = self.latest
            self._since, self._before = time, now
        return self.latest

    def reset(self) -> None:
        """Data are counted anew, some of them the same: the next call begins a stretch. What was spent is spent."""
        self._before = self._former = None

    def anew(self) -> None:
        """The estimate begins anew from nothing but later data: the second call from here compares it with the last."""
        self._former = self._before or self._former
        self._before = None
