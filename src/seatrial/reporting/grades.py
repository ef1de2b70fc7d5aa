"""How well a run is predicted, as a grade: its error as a share of the motion itself, on one scale for every page."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.results import Fit, Prediction, WindowScore
from seatrial.core.results.prediction import (
    HEADING_SPREAD,
    HELD_COURSE_SPREAD,
    MOTIONS,
    motion_spread,
    motion_spreads,
)
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Record
from seatrial.reporting.course import growth_time, unstable_course

ERROR_LABELS = {
    "psi_deg": ("heading", "deg"),
    "position_m": ("position", "m"),
    "u": ("u", "m/s"),
    "v": ("v", "m/s"),
    "r": ("r", "deg/s"),
    "z": ("heave", "m"),
    "theta_deg": ("pitch", "deg"),
    "phi_deg": ("roll", "deg"),
}
"""Error of `Prediction.rms` -> its quantity and unit on a screen."""
DEGREES = math.degrees(1.0)
"""Degrees of a radian."""
MAX_GROWTH = 100.0
"""Growth of a deviation over the windows that judge a course-unstable craft: a hundredth becomes the whole; chosen."""
_CARRIED = ("psi_deg", "position_m")
"""Errors of which a disturbance that moves the craft has a floor; waves on sensors alone carry nothing off."""
_EXPLAINED = 0.7  # share of an error from which on a disturbance is said to leave it; chosen
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
_GRADE_LIMITS = ", ".join(f"{grade} to {limit:g}" for grade, limit in _LIMITS.items())
GRADE_NOTE = (
    f"Grades: error over the standard deviation of the motion, {_GRADE_LIMITS}. That of a heading is "
    f"{math.degrees(HELD_COURSE_SPREAD):.0f}° where it is held, and {math.degrees(HEADING_SPREAD):.0f}° where it turns "
    "on and on."
)
"""How a grade comes about, once for a page."""


def error_text(name: str, rms: float) -> str:
    """Return an error of `Prediction.rms` with its unit: ``6.3°``, ``0.037 m/s``."""
    unit = ERROR_LABELS[name][1]
    value = significant(rms * (DEGREES if name == "r" else 1.0), 2)
    return f"{value}°" if unit == "deg" else f"{value} {unit}"


@dataclass(frozen=True)
class ErrorShare:
    """An error over a whole run, or over windows of it, as a share of the spread of that motion there.

    Attributes:
        name: as in `Prediction.rms`.
        rms: the error; spread: standard deviation of the motion, in its unit.
        window: length of the windows; empty: over the whole run.
    """

    name: str
    rms: float
    spread: float
    window: str = ""

    @property
    def share(self) -> float:
        """Error over spread; infinite where nothing moves."""
        return self.rms / self.spread if self.spread > 0.0 else math.inf

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
    return tuple(ErrorShare(name, p.rms[name], spread) for name, spread in motion_spreads(p.rms, p.measured).items())


def window_shares(p: Prediction, window: WindowScore) -> tuple[ErrorShare, ...]:
    """Return the errors over windows as shares of the motions inside such windows."""
    return tuple(
        ErrorShare(name, window.scores[name].rms,
                   motion_spread(name, _inside_windows(p.measured, channels, window.seconds)), window.window)
        for name, channels in MOTIONS.items()
        if name in window.scores and all(c in p.measured for c in channels)
    )  # fmt: skip


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


def longest_judged(fit: Fit) -> float | None:
    """Return how long windows that judge held-out runs may be [s]; None where runs are judged whole.

    Deviations grow whatever the model is worth where the craft is course unstable, or where the disturbance that was
    estimated carries it so far: where a whole run is then predicted roughly at best, windows judge all of them.
    """
    worst = [(p, share) for p in fit.validation if p.divergence is None and (share := largest_error_share(p))]
    if not any(p.windows for p in fit.validation) or not any(share.needs_attention for _, share in worst):
        return None
    if (course := unstable_course(fit)) is not None:
        return math.log(MAX_GROWTH) * growth_time(course)
    carried = all(is_disturbed(fit, p, share) for p, share in worst if share.needs_attention)
    return math.inf if carried else None


def is_disturbed(fit: Fit, p: Prediction, share: ErrorShare) -> bool:
    """Return whether the disturbance that was estimated leaves most of an error by itself."""
    noise = fit.noise_model
    if noise is None or noise.disturbance == "none" or share.name not in _CARRIED or not any(noise.process.values()):
        return False
    return p.noise_floor.get(share.name, share.rms) >= _EXPLAINED * share.rms  # no floor: it would leave more


def judging_window(p: Prediction, longest: float) -> WindowScore | None:
    """Return the longest windows that last no longer [s], else the shortest; None: no windows."""
    ordered = sorted(p.windows, key=lambda w: w.seconds)
    short = [w for w in ordered if w.seconds <= longest]
    return short[-1] if short else next(iter(ordered), None)


def judged_shares(p: Prediction, longest: float | None) -> tuple[ErrorShare, ...]:
    """Return the errors by which a run is judged; longest: as `longest_judged`."""
    window = None if longest is None or p.divergence is not None else judging_window(p, longest)
    return error_shares(p) if window is None else window_shares(p, window)


def judged_share(p: Prediction, longest: float | None) -> ErrorShare | None:
    """Return the largest of them; None where none can be compared."""
    return max(judged_shares(p, longest), key=lambda share: share.share, default=None)


def run_error(p: Prediction, longest: float | None = None) -> float:
    """Return the largest share of its motion that a run misses, infinite where it diverges."""
    share = judged_share(p, longest)
    return math.inf if p.divergence is not None else 0.0 if share is None else share.share


def worst_run(runs: Sequence[Prediction], longest: float | None = None) -> Prediction:
    """Return the run with the largest error; longest: as `longest_judged`."""
    return max(runs, key=lambda p: run_error(p, longest))


def worst_share(fit: Fit) -> ErrorShare | None:
    """Return the largest of all errors by which held-out runs are judged; None where none can be compared."""
    longest = longest_judged(fit)
    return judged_share(worst_run(fit.validation, longest), longest) if fit.validation else None


def is_missed(fit: Fit) -> bool:
    """Return whether a held-out run is not predicted at all: it diverges, or its mean is nearer."""
    largest = worst_share(fit)
    is_beyond = largest is not None and largest.grade is Grade.NOT
    return is_beyond or any(p.divergence is not None for p in fit.validation)


def graded_errors(fit: Fit) -> str:
    """Return the errors of the worst run of its motions: ``2.3° of 14° in heading: well``; empty: unknown."""
    longest, worst = longest_judged(fit), worst_share(fit)
    if worst is None:
        return ""
    shares = judged_shares(worst_run(fit.validation, longest), longest)
    texts = [f"{error_text(error.name, error.rms)} of {error_text(error.name, error.spread)} in "
             f"{ERROR_LABELS[error.name][0]}" for error in shares]  # fmt: skip
    over = f", over {worst.window}" if worst.window else ""
    return f"{enumeration(texts)}{over}: {worst.grade}"
