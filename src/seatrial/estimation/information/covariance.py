"""Covariance of estimates: from the information matrix, from runs left out, or from blocks; read by directions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from seatrial.core.results import Collinearity, Direction
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.comparison import Difference, JointTest
from seatrial.core.values import Array, Index

# Covariance of estimates: from the information matrix, from runs left out, or from blocks.

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


# Fisher information read direction by direction: what the records determine well, vaguely, or not at all.

_MOST_NAMED, _SHARE = 5, 0.25  # parameters named in a text; share of the largest component worth naming; chosen
_NARROWED = 0.9  # ratio of deviations below which prior knowledge counts as narrowing; chosen
# relative standard deviations that bound the classes; chosen
_WELL_DETERMINED, _POORLY_DETERMINED, _UNDETERMINED = 0.1, 1.0, 10.0
_NO_INFORMATION = 1e-24  # of the largest eigenvalue, below which one counts as zero: rounding squared


def relative_information(information: Array, sizes: Array) -> Array:
    """Information of relative changes, shape (n, n); sizes (n,) are the parameters' characteristic sizes."""
    return information * sizes[:, None] * sizes[None, :]


def directions(
    information: Array, names: Sequence[str], sizes: Array, precision: Array | None = None,
    covariance: Array | None = None,
) -> tuple[Direction, ...]:  # fmt: skip
    """Return all eigen-directions, the least determined first, each with the standard deviation along it and its words.

    Args:
        information: of the data alone, shape (n, n), other unknowns eliminated.
        precision: what is known besides (priors, force points), which the words mention where it narrows a direction
            that the data leave open.
        covariance: behind the intervals, (n, n); where it is wider along a direction than the information has it, as
            under model error, that is its standard deviation.
    """
    scaled = relative_information(information, sizes)
    values, vectors = np.linalg.eigh(scaled)
    least = _NO_INFORMATION * max(float(values[-1]), 1e-300)  # above zero, for a division
    deviations = [float(1.0 / np.sqrt(value)) if value > least else np.inf for value in values]
    if covariance is not None:
        relative = covariance / np.outer(sizes, sizes)
        wider = [float(np.sqrt(max(v @ relative @ v, 0.0))) for v in vectors.T]
        deviations = [max(own, wide) for own, wide in zip(deviations, wider, strict=True)]
    held = deviations
    if precision is not None and np.any(precision):
        posterior = inverse(scaled + relative_information(precision, sizes))
        held = [float(np.sqrt(v @ posterior @ v)) for v in vectors.T]
    order = np.argsort(-np.array(deviations), kind="stable")
    return tuple(_direction(vectors[:, k], deviations[k], held[k], names) for k in order)


def _direction(vector: Array, deviation: float, posterior_deviation: float, names: Sequence[str]) -> Direction:
    order = np.argsort(-np.abs(vector), kind="stable")
    signed = vector * np.sign(vector[order[0]])
    combination = {names[int(i)]: float(signed[i]) for i in order}
    text = direction_text(combination, deviation)
    if deviation > _WELL_DETERMINED and posterior_deviation < _NARROWED * deviation:
        text += f"; what is known besides the records holds it to {_percent(posterior_deviation)}"
    return Direction(combination, deviation, text)


def signed_terms(changes: Mapping[str, float], form: str = "+.2f") -> str:
    """Parameters with their relative changes, e.g. ``+0.91 X_rr -0.34 X_vv``."""
    return " ".join(f"{change:{form}} {name}" for name, change in changes.items())


def _percent(deviation: float) -> str:
    return f"{float(f'{100 * deviation:.2g}'):g} %" if deviation < _UNDETERMINED else "any amount"


def direction_text(combination: Mapping[str, float], deviation: float) -> str:
    """A direction in words: who moves with whom, and how well that is known."""
    large = [n for n, c in combination.items() if abs(c) >= _SHARE * max(map(abs, combination.values()))][:_MOST_NAMED]
    known = _percent(deviation)
    if len(large) == 1:
        (name,) = large
        if deviation <= _WELL_DETERMINED:
            return f"{name} is determined to {known}"
        if deviation <= _POORLY_DETERMINED:
            return f"{name} is determined vaguely, to {known}"
        return f"{name} is not determined: it may be wrong by {known}"
    terms = signed_terms({n: combination[n] for n in large})
    if deviation <= _WELL_DETERMINED:
        return f"the combination {terms} (relative changes) is determined to {known}"
    if deviation <= _POORLY_DETERMINED:
        return f"along {terms} (relative changes) the records leave {known} open: these trade against each other"
    return f"along {terms} (relative changes) the records determine nothing: these may be wrong together by {known}"


def effective_parameters(information: Array, precision: Array, along: Sequence[Direction]) -> float:
    """Return the number of parameters that the data determine: trace of I (I + P)^-1.

    MacKay 1992, Neural Comp. 4, 415. Where there are no priors, every direction known better than to 100 % counts one.

    Args:
        information, precision: of the data and of the priors, in relative changes, (n, n).
        along: the directions of the information.
    """
    if not np.any(precision):
        return float(sum(direction.standard_deviation < _POORLY_DETERMINED for direction in along))
    return float(np.trace(np.linalg.solve(information + precision, information)))


# How far coefficients can be taken for one another: condition, variance inflation, correlation.


def condition_number(information: Array) -> float:
    """Condition number of the information scaled to unit diagonal; infinite where a direction is missing."""
    values = np.linalg.eigvalsh(_unit_diagonal(information))
    return float(values[-1] / values[0]) if values[0] > 1e-15 * values[-1] else np.inf  # rounding of double precision


def collinearity(information: Array, names: Sequence[str]) -> tuple[Collinearity, ...]:
    """Variance inflation factor of each coefficient, H_jj (H^-1)_jj, and the coefficient most correlated with it.

    Marquardt 1970, Technometrics 12, 591.
    """
    unit = _unit_diagonal(information)
    values, vectors = np.linalg.eigh(unit)
    covariance = (vectors / np.maximum(values, 1e-14 * values[-1])) @ vectors.T  # rounding of double precision; chosen
    factors = np.diag(covariance)
    correlation = covariance / np.sqrt(np.outer(factors, factors))
    np.fill_diagonal(correlation, 0.0)
    partners = np.argmax(np.abs(correlation), axis=1)
    if len(names) < 2:
        return ()
    return tuple(
        Collinearity(name, float(factors[j]), names[int(partners[j])], float(correlation[j, partners[j]]))
        for j, name in enumerate(names)
    )


def _unit_diagonal(information: Array) -> Array:
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), 1e-300))  # above zero, for a division
    return information * scale[:, None] * scale[None, :]


# What a wrong assumed value does to the estimates, by one Gauss-Newton step from the information matrix.

_MOST_SHIFTED, _LEAST_SHIFT = 4, 0.005  # coefficients named in a text; relative shift worth naming; chosen
_VISIBLE_GROWTH = 0.05  # relative growth of the residuals that is visible; chosen
_ROUNDING = 1e-13  # of a singular information matrix, over its largest singular value; chosen


def estimate_shifts(information: Array, fitted: Index, change: Array) -> tuple[Array, float]:
    """Return changes of the fitted parameters, (len(fitted),), and the growth of chi squared, for an assumed change.

    information: shape (n, n); fitted: positions in it. change: of all parameters, (n,), whose effect on the outputs the
    fitted ones make up for. What the information does not determine stays.
    """
    pull = information @ change
    size = np.sqrt(information[fitted, fitted])
    scale = np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0)
    scaled = information[np.ix_(fitted, fitted)] * scale[:, None] * scale
    solved = np.linalg.lstsq(scaled, scale * pull[fitted], rcond=_ROUNDING)[0]
    moves = np.asarray(-scale * solved, dtype=np.float64)
    return moves, max(float(change @ pull + pull[fitted] @ moves), 0.0)


def consequence_text(
    name: str, change: float, shifts_by_name: Mapping[str, float], chi_squared_growth: float, chi_squared: float
) -> str:
    """A sentence; change and shifts_by_name are relative, the largest first; chi_squared: without the change."""
    shifts = [
        f"{n} by {float(f'{100 * m:.2g}'):+g} %"
        for n, m in list(shifts_by_name.items())[:_MOST_SHIFTED]
        if abs(m) >= _LEAST_SHIFT
    ]
    first = f"were {name} {100 * change:.0f} % larger, "
    if not shifts:
        return f"{first}no estimate would shift by half a per cent"
    growth = float(np.sqrt(1.0 + chi_squared_growth / chi_squared) - 1.0) if chi_squared > 0 else np.inf
    shown = "show it" if growth >= _VISIBLE_GROWTH else "hardly show it"
    return (
        f"{first}the estimates would shift, {', '.join(shifts)}, and the residuals would {shown} "
        f"(they would grow by {100 * growth:.2g} %, chi squared by {chi_squared_growth:.2g})"
    )


# Differences of two estimates with independent errors: intervals, joint intervals, and one test of all together.

_EQUAL_WITHIN = 1e-12  # relative, within which two values are one: a few roundings of double precision
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
    if apart is not None and abs(apart) <= _EQUAL_WITHIN * max(abs(a.value or 0.0), abs(b.value or 0.0)):
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
