"""Errors of two candidates on the same parts of records: is one worse by more than the parts' scatter explains?"""

import numpy as np
from scipy.special import stdtrit

from seatrial.core.values import Array

_LEVEL = 0.95  # of the one-sided test; chosen


def standard_error(excess: Array) -> float:
    """Return that of the mean excess of one candidate's errors over another's, (parts,); infinite of one part."""
    return float(np.std(excess, ddof=1) / np.sqrt(len(excess))) if len(excess) > 1 else np.inf


def is_no_worse(excess: Array, negligible: float) -> bool:
    """Return whether the mean excess, of (parts,), is negligible or within its scatter (paired t test, 95 %)."""
    if not np.all(np.isfinite(excess)):
        return False
    level = float(stdtrit(max(len(excess) - 1, 1), _LEVEL))
    return bool(excess.mean() <= max(level * standard_error(excess), negligible))
