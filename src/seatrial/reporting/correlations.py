"""What the correlations of the estimates mean, in words."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Array
from seatrial.core.values.arrays import correlation_matrix

# variance inflation from which on coefficients are collinear (Marquardt 1970)
MIN_VARIANCE_INFLATION = 10.0
# size from which on a correlation is strong: it alone inflates variances as collinear coefficients have them, and how
# many of these are named
STRONG_CORRELATION, MAX_PAIRS = math.sqrt(1.0 - 1.0 / MIN_VARIANCE_INFLATION), 4


@dataclass(frozen=True)
class Partner:
    """The coefficient with which another one is most correlated."""

    name: str
    correlation: float


def correlation_text(names: Sequence[str], covariance: Array, degrees_of_freedom: float = math.inf) -> str:
    """Return which coefficients the records hardly distinguish; empty for fewer than two.

    Args:
        degrees_of_freedom: of the covariance; finite where it comes from that many runs left out, less one. Strong is
            then only what chance does not give in any of the pairs.
    """
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return ""
    below = np.nan_to_num(np.tril(correlation_matrix(covariance), k=-1))
    pairs = [(int(k // len(names)), int(k % len(names))) for k in np.argsort(-np.abs(below), axis=None)[:MAX_PAIRS]]
    least = max(STRONG_CORRELATION, _largest_by_chance(len(names), degrees_of_freedom))
    strong = [pair for pair in pairs if abs(below[pair]) >= least]
    if not strong:
        i, j = pairs[0]
        if i == j:
            return "None is correlated with another."
        chance = (
            f"; with {degrees_of_freedom + 1:g} runs or segments left out that may be chance"
            if least > STRONG_CORRELATION
            else ""
        )
        return f"The strongest is {fixed(below[i, j], 2)}, between {names[i]} and {names[j]}{chance}."
    count = int(np.sum(np.abs(below) >= least))
    strongest = enumeration([f"{names[i]} and {names[j]} ({fixed(below[i, j], 2)})" for i, j in strong])
    return (
        f"{counted(count, 'pair').capitalize()} at {fixed(least, 2)} or above in size; the strongest: {strongest}. "
        "Their errors depend on one another: use them with their covariance."
    )


def strong_partners(
    names: Sequence[str], covariance: Array, degrees_of_freedom: float = math.inf
) -> dict[str, Partner]:
    """Return the coefficients that are strongly correlated with another -> that one and the correlation.

    Arguments, and what counts as strong, as in `correlation_text`.
    """
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return {}
    matrix = np.nan_to_num(correlation_matrix(covariance)) * (1.0 - np.eye(len(names)))
    least = max(STRONG_CORRELATION, _largest_by_chance(len(names), degrees_of_freedom))
    places = ((name, int(np.argmax(np.abs(row))), row) for name, row in zip(names, matrix, strict=True))
    return {name: Partner(names[k], float(row[k])) for name, k, row in places if abs(row[k]) >= least}


def _largest_by_chance(count: int, degrees_of_freedom: float) -> float:
    """Size below which 95 of 100 sets of so many unrelated estimates have all their correlations.

    r = t / sqrt(t^2 + n - 2) (Fisher 1915, Biometrika 10, 507), n runs, the level shared among the pairs (Bonferroni).
    """
    if not 1.0 < degrees_of_freedom < math.inf:
        return 1.0 if degrees_of_freedom <= 1.0 else 0.0
    pairs = count * (count - 1) // 2
    t = two_sided_quantile(1.0 - (1.0 - STORED_LEVEL) / pairs, degrees_of_freedom - 1.0)
    return t / math.sqrt(t**2 + degrees_of_freedom - 1.0)
