"""Array types, and arrays that cannot be written to."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]


def frozen(values: ArrayLike) -> Array:
    """Return a float64 copy that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def correlation_matrix(covariance: Array) -> Array:
    """Return a covariance (n, n) scaled to a unit diagonal; rows without a variance are NaN."""
    spread = np.sqrt(np.where(np.diag(covariance) > 0, np.diag(covariance), np.nan))
    return covariance / np.outer(spread, spread)


def unwrapped(angle: Array) -> Array:
    """Angle in rad without jumps of a full turn; NaN samples stay NaN and do not break the count."""
    result = np.array(angle, dtype=float)
    is_finite = np.isfinite(result)
    if np.any(np.abs(np.diff(result[is_finite])) > np.pi):
        result[is_finite] = np.unwrap(result[is_finite])
    return result
