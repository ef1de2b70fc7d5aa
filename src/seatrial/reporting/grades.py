"""How well a run is predicted, as a grade: its error as a share of the motion itself, on one scale for every page."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.results import Fit, Prediction, Stability, WindowScore
from seatrial.core.results.prediction import (
    HEADING_SPREAD,
    HELD_COURSE_SPREAD,
    MOTIONS,
    MotionSpread,
    motion_spread,
    motion_spreads,
)
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Record
from seatrial.reporting.course import growth_time, unstable_course
from seatrial.reporting.runs import ERROR_LABELS

MAX_GROWTH = 100.0
"""Growth of a deviation over the windows that judge a course-unstable craft: a hundredth becomes the whole; chosen."""
_ROUNDING = 1e-9  # of a window, by which time stamps are rounded


class Grade(StrEnum):
    """How a whole run is predicted open loop, the best first."""

    CLOSELY = "closely"
    WELL = "well"
    ROUGHLY = "roughly"
    POORLY = "poorly"
    NOT = "not at all"


# grade -> largest error over the run as a share of the standard deviation of that motion; chosen but for the last: from
# 1 on the mean of the motion is nearer to it than the prediction
_LIMITS = {Grade.CLOSELY: 0.1, Grade.WELL: 0.3, Grade.ROUGHLY: 0.7, Grade.POORLY: 1.0}
SCALE = f"{', '.join(f'{grade} to {limit:g}' for grade, limit in _LIMITS.items())}"
"""The scale in words, for where a grade stands."""


@dataclass(frozen=True)
class ErrorShare:
    """An error over a whole run, or over windows of it, as a share of the standard deviation of that motion there.

    name: as in `Prediction.rms`. window: length of the windows; empty: over the whole run. is_turning: the heading
    spreads further than all directions alike do, so that the share is one of those. is_held: it is held over the run,
    so that the share is one of a small turn.
    """

    name: str
    share: float
    window: str = ""
    is_turning: bool = False
    is_held: bool = False

    @property
    def grade(self) -> Grade:
        """What is said of such an error."""
        return next((grade for grade, limit in _LIMITS.items() if self.share <= limit), Grade.NOT)

    @property
    def needs_attention(self) -> bool:
        """Whether the error is marked: the run is predicted roughly at best."""
        return self.grade not in (Grade.CLOSELY, Grade.WELL)


def error_shares(p: Prediction) -> tuple[ErrorShare, ...]:
    """Return the errors over a whole run as shares of its own motions; none where none can be compared."""
    return tuple(_error_share(name, p.rms[name], spread) for name, spread in motion_spreads(p.rms, p.measured).items())


def window_shares(p: Prediction, window: WindowScore) -> tuple[ErrorShare, ...]:
    """Return the errors over windows as shares of the motions inside such windows."""
    return tuple(
        _error_share(name, window.scores[name].rms,
                     motion_spread(name, _inside_windows(p.measured, channels, window.seconds)), window.window)
        for name, channels in MOTIONS.items()
        if name in window.scores and all(c in p.measured for c in channels)
    )  # fmt: skip


def _error_share(name: str, rms: float, spread: MotionSpread, window: str = "") -> ErrorShare:
    """An error as the share of the spread of its motion."""
    share = rms / spread.size if spread.size > 0.0 else math.inf
    return ErrorShare(name, share, window, spread.is_turning, spread.is_held)


def _inside_windows(record: Record, channels: Sequence[str], seconds: float) -> list[Array]:
    """Each channel about its mean in every window of that length, a remainder at the end left out; (m,) each."""
    number = np.floor((record.time - record.time[0]) / seconds + _ROUNDING).astype(int)
    whole = max(math.floor(record.duration / seconds + _ROUNDING), 1)
    motions = []
    for channel in channels:
        parts = (record[channel][(number == k) & np.isfinite(record[channel])] for k in range(whole))
        motions.append(np.concatenate([part - part.mean() for part in parts if len(part)] or [np.zeros(1)]))
    return motions


def largest_error_share(p: Prediction) -> ErrorShare | None:
    """Return the error over a whole run that is the largest share of its own motion; None: none can be compared."""
    return max(error_shares(p), key=lambda error_share: error_share.share, default=None)


def judging_course(predictions: Sequence[Prediction], course: Stability | None) -> Stability | None:
    """Return the course stability because of which windows judge the runs; None where they are judged whole.

    A deviation of a course-unstable craft grows whatever the model is worth: where a whole run is predicted roughly at
    best, windows judge all of them.
    """
    leaves = any(
        error_share.needs_attention for p in predictions for error_share in error_shares(p) if p.divergence is None
    )
    return course if leaves and any(p.windows for p in predictions) else None


def judging_window(p: Prediction, course: Stability) -> WindowScore | None:
    """Return the longest windows in which a deviation grows up to `MAX_GROWTH`, else the shortest; None: no windows."""
    ordered = sorted(p.windows, key=lambda w: w.seconds)
    short = [w for w in ordered if w.seconds <= math.log(MAX_GROWTH) * growth_time(course)]
    return short[-1] if short else next(iter(ordered), None)


def judged_shares(p: Prediction, course: Stability | None) -> tuple[ErrorShare, ...]:
    """Return the errors by which a run is judged; course: because of which windows judge it, None: the whole run."""
    window = None if course is None or p.divergence is not None else judging_window(p, course)
    return error_shares(p) if window is None else window_shares(p, window)


def judged_share(p: Prediction, course: Stability | None) -> ErrorShare | None:
    """Return the largest of them; None where none can be compared."""
    return max(judged_shares(p, course), key=lambda one: one.share, default=None)


def worst_share(predictions: Sequence[Prediction], course: Stability | None = None) -> ErrorShare | None:
    """Return the largest of all errors by which the runs are judged; None where none can be compared.

    course: of a craft that is course unstable; None of all others.
    """
    by_windows = judging_course(predictions, course)
    shares = [share for p in predictions if (share := judged_share(p, by_windows)) is not None]
    return max(shares, key=lambda one: one.share, default=None)


def is_missed(fit: Fit) -> bool:
    """Return whether a held-out run is not predicted at all: it diverges, or its mean is nearer."""
    largest = worst_share(fit.validation, unstable_course(fit))
    is_lost = largest is not None and largest.grade is Grade.NOT
    return is_lost or any(p.divergence is not None for p in fit.validation)


def share_sentence(predictions: Sequence[Prediction], course: Stability | None = None) -> str:
    """Return the largest share of each quantity, the grade of the worst and the scale; empty where unknown."""
    by_windows = judging_course(predictions, course)
    every = [share for p in predictions for share in judged_shares(p, by_windows)]
    worst = max(every, key=lambda one: one.share, default=None)
    if worst is None:
        return ""
    largest = [max((one for one in every if one.name == name), key=lambda one: one.share)
               for name in MOTIONS if any(one.name == name for one in every)]  # fmt: skip
    parts = enumeration([f"{significant(one.share, 2)} in {ERROR_LABELS[one.name][0]}" for one in largest])
    over = f", over {worst.window}" if worst.window else ""
    notes = (
        (f"{math.degrees(HEADING_SPREAD):.0f}° for a heading that turns on and on", any(o.is_turning for o in largest)),
        (f"{math.degrees(HELD_COURSE_SPREAD):.0f}° for a heading that is held", any(o.is_held for o in largest)),
    )
    capped = f" ({'; '.join(text for text, is_said in notes if is_said)})" if any(said for _, said in notes) else ""
    noun = "share" if len(largest) == 1 else "shares"
    return f"{noun} of the standard deviation of the motion itself{over}{capped}: {parts}, {worst.grade} ({SCALE})"
