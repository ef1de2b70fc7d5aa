"""Readings of a slower sensor that a faster table repeats from row to row: each counts once, where it appears."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.values import Array
from seatrial.core.values.arrays import Mask
from seatrial.numerics.resolution import local_resolution

_TOGETHER = (("lat", "lon"), ("x0", "y0"), ("u", "v"), ("sog", "cog"), ("q_w", "q_x", "q_y", "q_z"))
_ALONE = ("stw", "r", "p", "psi", "psi_magnetic", "phi", "theta", "z", "u_dot", "v_dot")
_FEWEST = 8  # steps of a channel by which its rate is judged; chosen: a run of ten seconds at 1 Hz
_JUMP = 1.5  # resolutions; a channel of every row that moves by more in one row moves in the next row too
_HELD_SHARE = 0.8  # of its jumps that stand between repeats, from which on a channel is held; chosen
_JUMPS_SHARE = 0.3  # of its steps that must be jumps: others may be any coarse channel's; chosen
_SLOWER = 1.5  # rows between two readings, from which on a channel is slower than its table; chosen
# rows for which a frozen channel stays at least, and how many times as far as it usually moves it then jumps; chosen
_FROZEN_ROWS, _CATCHES_UP = 5, 3.0
# times the longest of all other stays from which on a stay is like no other, and how far such a one then jumps at least
# of what the channel usually moves: an instrument that stood still with its ship begins slowly; chosen
_APART, _GOES_ON = 3.0, 0.5
_USUAL = 0.98  # quantile of steps and stays that are usual; chosen: few are of a frozen channel
_LOST = 1.5  # steps of the table, above which a row is missing; chosen
_SAME_ROWS = 0.5  # share of the steps of the rarer of two channels in rows where the other steps too; chosen


def slower_channels(values: Mapping[str, Array], time: Array) -> dict[str, Mask]:
    """Return the rows (n,) in which each channel that is renewed more slowly than its table was measured.

    Such a channel jumps by several of its resolutions and stays on both sides of the jump, which no motion does that is
    read in every row: one in coarse steps moves by one of them at a time. Channels of one message (a fix) are renewed
    together, or in turn. A stay longer than the usual one is of new readings of the same value, one after the other.

    A channel of every row that stays and then jumps by far more than it ever moves was frozen for so long, and so was
    one that jumps by about as much where it stays far longer than ever else.

    Args:
        values: readings (n,) of one table, in the units of its cells, angles without jumps of a turn; NaN where there
            is none. Inputs are left alone.
        time: stamps (n,) [s].
    """
    masks: dict[str, Mask] = {}
    for group in (*_TOGETHER, *((symbol,) for symbol in _ALONE)):
        present = [symbol for symbol in group if symbol in values]
        if present:
            for part in _renewed_together(present, values):
                columns = [values[symbol] for symbol in part]
                mask = _renewals(columns, time)
                if mask is None and group[0] in _ALONE:  # held positions are found as jumps of the track
                    mask = _unfrozen(columns)
                masks |= {} if mask is None else dict.fromkeys(part, mask)
    return masks


def held_text(masks: Mapping[str, Mask], time: Array) -> str:
    """Return the sentence on slower channels, by the rows in which they were measured; empty where there are none."""
    if not masks:
        return ""
    periods = {symbol: float(np.nanmedian(np.diff(time[mask]))) for symbol, mask in masks.items()}
    step = float(np.nanmedian(np.diff(time)))
    slower = ", ".join(f"'{symbol}' every {p:.3g} s" for symbol, p in periods.items() if p > _SLOWER * step)
    frozen = ", ".join(f"'{symbol}'" for symbol, p in periods.items() if p <= _SLOWER * step)
    texts = [f"readings are new more slowly than the rows of {step:.3g} s: {slower}"] if slower else []
    texts += [f"{frozen} stay and then jump to what was missed"] if frozen else []
    return f"{'; '.join(texts)}; what repeats a reading is no measurement"


def between_readings(values: Array, is_measured: Mask, *, is_angle: bool) -> Array:
    """Return values (n,) straight between the readings, angles in rad without jumps of a turn."""
    rows = np.flatnonzero(is_measured & np.isfinite(values))
    smooth = np.unwrap(values[rows]) if is_angle else values[rows]
    return np.where(is_measured, values, np.interp(np.arange(len(values)), rows, smooth))


def _renewed_together(symbols: Sequence[str], values: Mapping[str, Array]) -> list[list[str]]:
    """The channels of a message: all of them where they step in the same rows, else each by itself."""
    steps = [_stepping_rows([values[symbol]]) for symbol in symbols]
    counts = [int(step.sum()) for step in steps]
    moving = [step for step, count in zip(steps, counts, strict=True) if count >= _FEWEST]
    if len(moving) < 2:
        return [list(symbols)]
    common = int(np.sum(np.all(moving, axis=0)))
    least = min(int(step.sum()) for step in moving)
    return [list(symbols)] if common >= _SAME_ROWS * least else [[symbol] for symbol in symbols]


def _stepping_rows(columns: Sequence[Array]) -> Mask:
    """Rows in which one of the columns differs from its last reading; not its first one."""
    stepping = np.zeros(len(columns[0]), dtype=np.bool_)
    for values in columns:
        read_rows = np.flatnonzero(np.isfinite(values))
        stepping[read_rows[1:]] |= np.diff(values[read_rows]) != 0.0
    return stepping


def _renewals(columns: Sequence[Array], time: Array) -> Mask | None:
    """Rows in which a group of columns was measured; None where it was in every row."""
    read_rows = np.flatnonzero(np.all(np.isfinite(columns), axis=0))
    steps = np.flatnonzero(_stepping_rows([values[read_rows] for values in columns]))
    if len(steps) < _FEWEST:
        return None
    stays = np.diff(steps)
    is_between_stays = (stays[:-1] > 1) & (stays[1:] > 1)
    fewest_jumps = max(_FEWEST, _JUMPS_SHARE * len(is_between_stays))
    if np.sum(is_between_stays) < _HELD_SHARE * fewest_jumps:  # whichever steps are jumps: their sizes take a sort
        return None
    jumps = np.any([np.abs(_step_sizes(values[read_rows], steps)) > _JUMP for values in columns], axis=0)[1:-1]
    if np.sum(jumps) < fewest_jumps:
        return None
    if np.mean(is_between_stays[jumps]) < _HELD_SHARE:
        return None
    moments = time[read_rows]
    if not np.all(np.diff(moments) > 0.0):  # rounded stamps: rows count
        moments = np.arange(len(read_rows), dtype=np.float64)
    late = steps[np.diff(moments)[steps - 1] > _LOST * float(np.median(np.diff(moments)))]  # new in a row that is lost
    mask = np.zeros(len(columns[0]), dtype=np.bool_)
    mask[read_rows[np.setdiff1d(_with_unchanged(moments, steps), late)]] = True
    return mask


def _unfrozen(columns: Sequence[Array]) -> Mask | None:
    """Rows in which a group of columns of every row was measured; None where it never froze."""
    read_rows = np.flatnonzero(np.all(np.isfinite(columns), axis=0))
    steps = np.flatnonzero(_stepping_rows([values[read_rows] for values in columns]))
    if len(steps) < _FEWEST:
        return None
    stays = np.diff(steps, prepend=0)
    longest = max(_FROZEN_ROWS, 2.0 * float(np.quantile(stays, _USUAL)))
    if np.max(stays) < longest:
        return None
    moving = [values[read_rows] for values in columns if np.ptp(values[read_rows]) > 0.0]
    sizes = np.max([np.abs(np.diff(values))[steps - 1] / _usual_step(values) for values in moving], axis=0)
    jumps = np.max([np.abs(_step_sizes(values, steps)) for values in moving], axis=0) > _JUMP
    is_apart = jumps & (sizes > _GOES_ON) & (stays >= _apart(stays))
    is_apart[0] = False  # at rest from the first row on
    caught_up = np.flatnonzero(((sizes > _CATCHES_UP) | is_apart) & (stays >= longest))
    if not caught_up.size:
        return None
    mask = np.ones(len(columns[0]), dtype=np.bool_)
    for k in caught_up:
        mask[read_rows[steps[k] - stays[k] + 1 : steps[k]]] = False
    return mask


def _apart(stays: np.ndarray) -> float:
    """The shortest stay that is far longer than all shorter ones; infinite where none is."""
    lengths = np.unique(stays)
    far = np.flatnonzero(lengths[1:] >= _APART * lengths[:-1])
    return float(lengths[far[-1] + 1]) if far.size else np.inf


def _usual_step(values: Array) -> float:
    """By how much a column moves where it does."""
    sizes = np.abs(np.diff(values))
    return float(np.quantile(sizes[sizes > 0.0], _USUAL)) if np.any(sizes > 0.0) else 0.0


def _step_sizes(values: Array, steps: np.ndarray) -> Array:
    """The steps of a column in the resolution of its numbers before and after them, the coarser one."""
    step = local_resolution(values)
    sizes, coarser = np.abs(np.diff(values))[steps - 1], np.maximum(step[steps], step[steps - 1])
    return np.divide(sizes, coarser, out=np.zeros(len(steps)), where=coarser > 0.0)


def _with_unchanged(moments: Array, steps: np.ndarray) -> np.ndarray:
    """The rows of steps, and of readings that repeat the last one: a period apart while a value stays."""
    period = float(np.median(np.diff(moments[steps])))
    tolerance = 0.5 * float(np.median(np.diff(moments)))
    first, last = float(moments[steps[0]]), float(moments[-1])
    due = [np.arange(first - period, moments[0] - tolerance, -period)]
    ends = [*(moments[steps[1:]] - 0.5 * period), last + tolerance]
    begins = moments[steps].tolist()
    due += [np.arange(stay + period, float(end), period) for stay, end in zip(begins, ends, strict=True)]
    rows = np.searchsorted(moments, np.concatenate(due) - tolerance)
    return np.unique(np.concatenate([steps, np.minimum(rows, len(moments) - 1)]))
