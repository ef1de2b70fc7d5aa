"""The even time base behind rounded stamps: its step, and the place of each sample on it."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.data.check.signal import RowIndices

# steps of time beyond which samples are missing, and roundings of the stamps by which such a step must exceed the mean
# one; chosen: a single lost sample is no gap
GAP_STEPS, GAP_QUANTA = 2.5, 1.5
# samples over which the mean step is taken; chosen: rounded stamps average out
STEP_LAG = 20
# distance of a stamp from the even base, in steps and in roundings, up to which the samples are even; chosen
LARGEST_JITTER, LARGEST_ROUNDING = 0.6, 1.01
# distance of a step of the clock from a whole number of the usual one, in steps, up to which samples between are lost;
# chosen: ten standard deviations of stamps that jitter by 3 ms at 10 Hz
_WHOLE_STEPS = 0.3
# significant digits that a logger may round its stamps to, fewest first; more cannot be distinguished from noise
_DIGITS = range(2, 7)
# share of a rounding by which a stamp may differ from a multiple of it, and of stamps that may be zero; representation
_REPRESENTATION = 1e-6


@dataclass(frozen=True, eq=False)
class EvenBase:
    """An even time base and where the samples of a record stand on it.

    Attributes:
        index: place of each sample, counted from the first.
        start, step: s.
        jitter: largest distance of a stamp from its place [s].
        is_even: whether every stamp lies at its place, within rounding.
        repeated: number of stamps that repeat the one before.
        gaps: rows after which samples are missing.
    """

    index: RowIndices
    start: float
    step: float
    jitter: float
    is_even: bool
    repeated: int
    gaps: RowIndices


def even_base(time: Array) -> EvenBase:
    """Return the even base of stamps in order, shape (n,), n >= 2.

    Without gaps where every stamp then lies within its rounding (that of a fixed number of decimals, or of significant
    digits, which grows with the clock); otherwise stretches between gaps share one step, each with its own place.
    """
    steps = np.diff(time)
    if (counted := _counted_base(time, steps)) is not None:
        return counted
    repeated = int(np.sum(steps == 0))
    quantum = float(np.min(steps[steps > 0], initial=np.inf)) if repeated else 0.0
    rounding = np.maximum(_significant_rounding(time), quantum) if repeated else np.zeros(len(time))
    gapless = _base(time, np.empty(0, dtype=np.intp), rounding, repeated)
    if repeated and gapless.is_even:
        return gapless
    nominal = _nominal_step(time, quantum)
    gaps = np.flatnonzero((steps > GAP_STEPS * nominal) & (steps > nominal + GAP_QUANTA * rounding[1:]))
    return _base(time, gaps, rounding, repeated)


def _counted_base(time: Array, steps: Array) -> EvenBase | None:
    """The base of stamps that are whole numbers of one step apart, so that each lost sample counts; None of others."""
    usual = float(np.median(steps))
    if not usual > 0.0:
        return None
    counts = np.round(steps / usual)
    if np.any(counts < 1.0) or np.any(np.abs(steps - counts * usual) > _WHOLE_STEPS * usual):
        return None
    index = np.concatenate([[0.0], np.cumsum(counts)])
    step, start = (float(one) for one in np.polyfit(index, time - time[0], 1))
    jitter = float(np.max(np.abs(time - time[0] - start - step * index)))
    if jitter > LARGEST_JITTER * step:
        return None
    gaps = np.flatnonzero(counts > GAP_STEPS)
    return EvenBase(index.astype(np.intp), float(time[0]) + start, step, jitter, True, 0, gaps)


def _base(time: Array, gaps: RowIndices, rounding: Array, repeated: int) -> EvenBase:
    """The base whose step the stretches between the gaps share, by least squares; later stretches count from it."""
    rows = np.arange(len(time), dtype=np.float64)
    stretch = np.zeros(len(time), dtype=np.intp)
    stretch[gaps + 1] = 1
    stretch = np.cumsum(stretch)
    weights = 1.0 / np.where(rounding > 0, rounding, 1.0) ** 2
    total = np.bincount(stretch, weights)
    mean_row, mean_time = (np.bincount(stretch, weights * x) / total for x in (rows, time))
    off_row, off_time = rows - mean_row[stretch], time - mean_time[stretch]
    power = float(np.sum(weights * off_row**2))
    step = float(np.sum(weights * off_row * off_time)) / power if power > 0 else 0.0
    if not step > 0.0:
        step = float(time[-1] - time[0]) / (len(time) - 1)
    places = mean_time - step * mean_row
    shift = np.round((places - places[0]) / step) if step > 0 else np.zeros(len(places))
    index = rows + shift[stretch]
    start = float(np.sum(weights * (time - step * index)) / np.sum(weights))
    deviation = np.abs(time - start - step * index)
    is_even = bool(np.all(deviation <= np.maximum(LARGEST_JITTER * step, LARGEST_ROUNDING * rounding)))
    return EvenBase(index.astype(np.intp), start, step, float(np.max(deviation)), is_even, repeated, gaps)


def _nominal_step(time: Array, quantum: float) -> float:
    """The usual step: from the samples that share a rounded stamp where there are many, else the median over 20."""
    lag = min(STEP_LAG, len(time) - 1)
    nominal = float(np.median((time[lag:] - time[:-lag]) / lag))
    if quantum > 0.0:
        stamps, counts = np.unique(time, return_counts=True)
        is_next = np.diff(stamps) < GAP_QUANTA * quantum
        inner = counts[1:-1][is_next[1:] & is_next[:-1]]
        if inner.size and np.mean(inner) > 1.0:
            return quantum / float(np.mean(inner))
    return nominal


def _significant_rounding(time: Array) -> Array:
    """Rounding of each stamp [s] to as many significant digits as all of them have, shape (n,); zero beyond six."""
    size = np.abs(time)
    known = size > 0
    for digits in _DIGITS:
        quantum = 10.0 ** (np.floor(np.log10(size[known])) + 1 - digits)  # decimal places of the leading digit
        ratio = size[known] / quantum
        if np.all(np.abs(ratio - np.round(ratio)) < _REPRESENTATION * np.maximum(ratio, 1.0)):
            rounding = np.zeros(len(time))
            rounding[known] = quantum
            return rounding
    return np.zeros(len(time))
