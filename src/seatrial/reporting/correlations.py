"""What the correlations of the estimates mean, in words."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Array
from seatrial.core.values.arrays import correlation_matrix

# size from which on a correlation is strong, and how many of these are named
STRONG_CORRELATION, MAX_PAIRS = 0.9, 4


def correlation_text(names: Sequence[str], covariance: Array) -> str:
    """Return which coefficients the records hardly distinguish; empty for fewer than two."""
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return ""
    below = np.nan_to_num(np.tril(correlation_matrix(covariance), k=-1))
    pairs = [(int(k // len(names)), int(k % len(names))) for k in np.argsort(-np.abs(below), axis=None)[:MAX_PAIRS]]
    strong = [pair for pair in pairs if abs(below[pair]) >= STRONG_CORRELATION]
    if not strong:
        i, j = pairs[0]
        if i == j:
            return "None is correlated with another."
        return f"The strongest is {fixed(below[i, j], 2)}, between {names[i]} and {names[j]}."
    count = int(np.sum(np.abs(below) >= STRONG_CORRELATION))
    strongest = enumeration([f"{names[i]} and {names[j]} ({fixed(below[i, j], 2)})" for i, j in strong])
    return (
        f"{counted(count, 'pair').capitalize()} at {STRONG_CORRELATION} or above in size; the strongest: {strongest}. "
        "The records determine such coefficients mainly together: take them as a set, not one by one."
    )
