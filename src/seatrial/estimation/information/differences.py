"""Differences of two estimates with independent errors: intervals, joint intervals, and one test of all together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot
from statistics import NormalDist

import numpy as np
from scipy.special import chdtrc

from seatrial.core.results.comparison import Difference, JointTest
from seatrial.core.values import Array

_ROUNDING = 1e-12  # relative, within which two values are one: a few roundings of double precision
LEVEL = 0.95
"""Probability of intervals."""


@dataclass(frozen=True)
class QuantityInterval:
    """A quantity with its 95 % interval; None: not determined."""

    name: str
    unit: str
    value: float | None
    lower: float | None = None
    upper: float | None = None


def differences(first: Sequence[QuantityInterval], second: Sequence[QuantityInterval]) -> tuple[Difference, ...]:
    """Return second minus first of quantities in the same order, and which are significant jointly.

    The interval is recovered from both (MOVER; Zou & Donner 2008, Statistics in Medicine 27, 1693, section 2): where
    both are symmetric its half width is the root of the sum of their squares. Joint intervals are wider by the ratio of
    normal quantiles for as many rows as there are (Bonferroni).
    """
    rows = [_difference(a, b) for a, b in zip(first, second, strict=True)]
    count = max(sum(row.lower is not None for row in rows), 1)
    normal, tail = NormalDist(), 0.5 * (1.0 - LEVEL)
    widening = normal.inv_cdf(1.0 - tail / count) / normal.inv_cdf(1.0 - tail)
    return tuple(replace(row, is_significant=_is_significant(row, widening)) for row in rows)


def _difference(a: QuantityInterval, b: QuantityInterval) -> Difference:
    apart = None if a.value is None or b.value is None else b.value - a.value
    if apart is not None and abs(apart) <= _ROUNDING * max(abs(a.value or 0.0), abs(b.value or 0.0)):
        apart = 0.0
    row = Difference(a.name, a.unit, a.value, b.value, apart)
    if apart is None or a.lower is None or a.upper is None or b.lower is None or b.upper is None:
        return row
    assert a.value is not None and b.value is not None
    lower = apart - hypot(b.value - b.lower, a.upper - a.value)
    return replace(row, lower=lower, upper=apart + hypot(b.upper - b.value, a.value - a.lower))


def _is_significant(row: Difference, widening: float) -> bool | None:
    if row.difference is None or row.lower is None or row.upper is None:
        return None
    lower = row.difference - widening * (row.difference - row.lower)
    upper = row.difference + widening * (row.upper - row.difference)
    return lower > 0.0 or upper < 0.0


def joint_test(difference: Array, covariance: Array) -> JointTest | None:
    """Return the Wald test that all differences (k,) are zero; covariance (k, k): the sum of both fits'.

    Directions that neither fit determines (not finite, or no variance) are left out; None where none remains.
    """
    if not len(difference) or not np.isfinite(covariance).all():
        return None
    scale = np.sqrt(np.diag(covariance))
    if not np.all(scale > 0.0):
        return None
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    kept = values > _LEAST_EIGENVALUE * values[-1]
    statistic = float(np.sum((vectors[:, kept].T @ (difference / scale)) ** 2 / values[kept]))
    count = int(kept.sum())
    return JointTest(statistic, count, float(chdtrc(count, statistic)))


_LEAST_EIGENVALUE = 1e-9
"""Eigenvalue of the correlations over the largest below which a direction is rounding; chosen."""
