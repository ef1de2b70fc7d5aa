"""The step in which numbers were written: the resolution of a clock's stamps or of a sensor's values."""

from collections.abc import Sequence
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

_FINEST_SHARE = 10  # smallest step looked for, as a part of the median gap between neighbouring values; chosen
_LEVELS = 3  # gaps, gaps between gaps, and theirs: stamps of milliseconds 200 ms apart need the second; chosen
_AGREEMENT = 1e-3  # of a step, within which a gap counts as so many whole steps; chosen, above what conversions round
_NEAR = 0.1  # of a step, within which a gap helps to measure the step; chosen
_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)  # of the largest value: what conversions of units leave; chosen
_NEIGHBOURS = 4  # gaps above a value, and below it, by which its own step goes; chosen
_MOST_AT_ONCE = 500  # gaps up to which all steps in one go are faster (measured)
_LEAST_SHARE = 0.95  # of the gaps that are whole steps: a few values may have been interpolated; chosen


def resolution(values: NDArray[np.float64], least: float = 0.0) -> float:
    """Return the coarsest step on whose multiples, counted from any origin, the values lie, in their unit.

    0 where there is none: fewer than three distinct values, as of two orders, or values with all digits of a computer.

    Args:
        values: any shape; what is not finite counts for nothing.
        least: the step from which on the answer counts; a finer one may be answered by 0, which is found sooner.
    """
    finite = np.unique(np.asarray(values, dtype=np.float64)[np.isfinite(values)])
    rounding = _ROUNDING * float(np.max(np.abs(finite), initial=0.0))
    gaps = _gaps(finite, rounding)
    steps = _candidate_steps(gaps, rounding)
    # gaps that are near whole steps make none coarser by more than that
    coarse = [k for k, step in enumerate(steps, start=1) if (1.0 + 2.0 * _NEAR) * step > least]
    for step in _likely_steps(gaps, steps[: max(coarse, default=0)], rounding):
        tolerance = _tolerance(step, rounding)
        counts = np.round(gaps / step)
        near = (np.abs(gaps - step * counts) <= _NEAR * step) & (counts > 0.0)
        if np.count_nonzero(near) > 2:  # by many gaps: one alone is rounded, and two numbers agree by chance
            step = float(counts[near] @ gaps[near] / (counts[near] @ counts[near]))
        if np.count_nonzero(np.abs(gaps - step * counts) <= tolerance) / gaps.size >= _LEAST_SHARE:
            return step
    return 0.0


def _likely_steps(gaps: NDArray[np.float64], steps: Sequence[float], rounding: float) -> list[float]:
    """Return the steps that may agree with the gaps; few gaps are looked at in one go, with some room for rounding."""
    if gaps.size > _MOST_AT_ONCE or not steps:
        return list(steps)
    columns = np.array(steps).reshape(-1, 1)
    counts = np.round(gaps / columns)
    weights = counts * (np.abs(gaps - columns * counts) <= _NEAR * columns)
    squares, room = np.sum(weights * counts, axis=1), _ROUNDING * gaps.size * gaps[-1]
    is_fitted = np.count_nonzero(weights, axis=1) > 2
    fitted = np.where(is_fitted, weights @ gaps / np.where(is_fitted, squares, 1.0), columns[:, 0])
    tolerances = np.array([_tolerance(step, rounding) for step in steps]).reshape(-1, 1) + room
    shares = np.count_nonzero(np.abs(gaps - fitted[:, None] * counts) <= tolerances, axis=1) / gaps.size
    return [step for step, share in zip(steps, shares.tolist(), strict=True) if share >= _LEAST_SHARE]


def _candidate_steps(gaps: NDArray[np.float64], rounding: float) -> list[float]:
    """Return the steps that are looked for: parts of the median gap, of that of gaps between gaps, and of theirs."""
    steps, further = list[float](), gaps if gaps.size > 1 else gaps[:0]
    for _ in range(_LEVELS):
        if further.size == 0:
            break
        usual = float(further[(further.size - 1) // 2])
        parts = (usual / part for part in range(1, _FINEST_SHARE + 1))
        # digits end where any number would agree; chosen
        steps += takewhile(lambda step: _tolerance(step, rounding) <= 0.1 * step, parts)
        further = _gaps(further, 2.0 * rounding)
    return steps


def _tolerance(step: float, rounding: float) -> float:
    """Return within what a gap is a number of whole steps; both its ends are rounded."""
    return max(_AGREEMENT * step, 2.0 * rounding)


def _gaps(ordered: NDArray[np.float64], rounding: float) -> NDArray[np.float64]:
    """Return the distances of neighbouring values, in order, without those that rounding makes."""
    gaps = np.sort(np.diff(ordered))
    return gaps[gaps > rounding]


def local_resolution(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the step in which numbers as large as each value were written, in their unit, (n,); NaN for a NaN.

    Of numbers of three digits it grows with them. It is the least distance of neighbouring values, or difference of
    such distances, among the nearest above or below; of numbers with all digits it is far below what they move by.

    Args:
        values: (n,).
    """
    result = np.full(len(values), np.nan)
    is_finite = np.isfinite(values)
    distinct, place = np.unique(values[is_finite], return_inverse=True)
    if distinct.size < 2:
        return np.where(is_finite, 0.0, np.nan)
    gaps, rounding = np.diff(distinct), _ROUNDING * float(np.max(np.abs(distinct)))
    least = np.minimum(gaps, np.append(np.where((apart := np.abs(np.diff(gaps))) > rounding, apart, np.inf), np.inf))
    count = min(_NEIGHBOURS, gaps.size)
    padded = np.pad(np.where(least > rounding, least, np.inf), count, constant_values=np.nan)
    windows = np.minimum.reduce([padded[k : k + distinct.size + count] for k in range(count)])
    steps = np.fmax(windows[: distinct.size], windows[count:])  # where a decade begins the coarser one counts
    result[is_finite] = np.minimum(steps, distinct[-1] - distinct[0])[place]
    return result
