"""Jumps of position (held and catching up, or staying) and single wild samples."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.data.check.signal import RowIndices

# samples on each side over which the mean step of the track is taken, ours
HALF_WINDOW = 15
# a step is a jump beyond these multiples of the mean and of the median step, ours
STEP_RATIO, MEDIAN_STEP_RATIO = 4.0, 6.0
# a position is held where it moves by less than this share of the mean step, for so many samples at most, ours
HELD_RATIO, LONGEST_HOLD = 0.35, 50
# a jump matches the distance missed while the position was held between these shares of it; chosen
MATCHING = (0.3, 2.5)
# least step of a wild sample: over the quantile of all steps, and over the smallest (quantisation); chosen
STEP_QUANTILE, OVER_QUANTILE, OVER_SMALLEST = 0.95, 3.0, 5.0
# a sample is wild where it leaves and returns by this multiple of the largest of so many neighbouring steps, ours
SPIKE_RATIO, NEIGHBOURS = 4.0, 8
_NO_ROWS: RowIndices = np.empty(0, dtype=np.intp)


@dataclass(frozen=True)
class Jumps:
    """Jumps of a track.

    Attributes:
        rows: index of the sample after each jump.
        sizes: length of each jump [m].
        held: samples to replace: the position stood still there before it caught up.
    """

    rows: RowIndices
    sizes: Array
    held: RowIndices


def track_jumps(x: Array, y: Array) -> Jumps:
    """Return steps of more than four times the mean step around them and six times the median step of the run.

    x, y: shape (n,), no NaN. A receiver that holds its last position and then catches up shows small steps first.
    """
    steps = np.hypot(np.diff(x), np.diff(y))
    rows = np.arange(len(steps))
    first, last = np.maximum(rows - HALF_WINDOW, 0), np.minimum(rows + 1 + HALF_WINDOW, len(x) - 1)
    mean = np.hypot(x[last] - x[first], y[last] - y[first]) / np.maximum(last - first, 1)
    moving = steps[steps > 0]
    typical = float(np.median(moving)) if moving.size else 0.0
    jumped = np.flatnonzero((steps > STEP_RATIO * mean) & (steps > MEDIAN_STEP_RATIO * typical))
    held = [_held_before(j, steps, mean) for j in jumped.tolist()]
    return Jumps(jumped + 1, steps[jumped], np.unique(np.concatenate([*held, _NO_ROWS])))


def _held_before(j: int, steps: Array, mean: Array) -> RowIndices:
    """Samples held before step j, or none where the jump does not match the distance missed."""
    count = 0
    while count < LONGEST_HOLD and j - 1 - count >= 0 and steps[j - 1 - count] < HELD_RATIO * mean[j]:
        count += 1
    missed = (count + 1) * mean[j]
    if count == 0 or not MATCHING[0] * missed < steps[j] < MATCHING[1] * missed:
        return _NO_ROWS
    return np.arange(j - count + 1, j + 1, dtype=np.intp)


def spike_rows(values: Array) -> RowIndices:
    """Return rows of single samples that leave and return in steps over four times any other within eight samples.

    values: shape (n,), no NaN. The step must also exceed three times the record's 95 % step, and five times its
    smallest (quantisation).
    """
    steps = np.diff(values)
    sizes = np.abs(steps)
    moving = sizes[sizes > 0]
    if moving.size == 0 or len(values) < 2 * NEIGHBOURS:
        return _NO_ROWS
    floor = max(OVER_QUANTILE * float(np.quantile(sizes, STEP_QUANTILE)), OVER_SMALLEST * float(moving.min()))
    both = np.minimum(sizes[:-1], sizes[1:])
    candidates = np.flatnonzero((steps[:-1] * steps[1:] < 0) & (both > floor))
    spikes = []
    for c in candidates.tolist():
        before, after = sizes[max(0, c - NEIGHBOURS) : c], sizes[c + 2 : c + 2 + NEIGHBOURS]
        if both[c] > SPIKE_RATIO * max(before.max(initial=0.0), after.max(initial=0.0)):
            spikes.append(c + 1)
    return np.array(spikes, dtype=np.intp)
