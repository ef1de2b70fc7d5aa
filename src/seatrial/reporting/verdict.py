"""How well runs are predicted: grades, repeats of one manoeuvre, and the verdict in one sentence."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from seatrial.core.results import Fit, Prediction, WindowScore
from seatrial.core.results.prediction import (
    HEADING_SPREAD,
    HELD_COURSE_SPREAD,
    MOTIONS,
    is_sensor_noise,
    motion_spread,
    motion_spreads,
    with_hull_ends,
)
from seatrial.core.text.numbers import duration, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, InputError, Record, Severity
from seatrial.physics.manoeuvres import (
    REACH_PERCENTILE,
    ManoeuvreKind,
    ObservedManoeuvre,
    ordered_degrees,
    steered_orders,
    to_starboard,
)
from seatrial.reporting.measures import growth_time, unstable_course

# How well a run is predicted, as a grade: its error as a share of the motion itself, on one scale for every page.

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
    f"Grades: error over the standard deviation of the motion, {_GRADE_LIMITS}. That of a held course is "
    f"{math.degrees(HELD_COURSE_SPREAD):.0f}° of heading and where they lead, that of a heading that turns on and on "
    f"{math.degrees(HEADING_SPREAD):.0f}°, that of a place at least how far the heading swings the ends of the hull."
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


@dataclass(frozen=True)
class ErrorScale:
    """What errors of predicted runs are judged by.

    Attributes:
        longest: s, how long windows that judge them may be; None: whole runs do.
        length: of the ship, m; 0: not known.
        noise: errors of the sensors, as of `sensor_errors`.
    """

    longest: float | None = None
    length: float = 0.0
    noise: Mapping[str, float] = field(default_factory=dict)


WHOLE_RUNS = ErrorScale()
"""Whole runs of a ship whose length and sensors are not known."""


def error_scale(fit: Fit) -> ErrorScale:
    """Return what the held-out runs of a fit are judged by."""
    return replace(_whole_runs(fit), longest=longest_judged(fit))


def _whole_runs(fit: Fit) -> ErrorScale:
    return ErrorScale(None, fit.ship.particulars.get("L", 0.0), fit.sensor_errors)


def error_shares(p: Prediction, by: ErrorScale = WHOLE_RUNS) -> tuple[ErrorShare, ...]:
    """Return the errors over a whole run as shares of its own motions; none where none can be compared."""
    spreads = motion_spreads(p.rms, p.measured, by.length)
    return _above_noise([ErrorShare(name, p.rms[name], spread) for name, spread in spreads.items()], by)


def window_shares(p: Prediction, window: WindowScore, by: ErrorScale = WHOLE_RUNS) -> tuple[ErrorShare, ...]:
    """Return the errors over windows as shares of the motions inside such windows."""
    spreads = {
        name: motion_spread(name, _inside_windows(p.measured, channels, window.seconds))
        for name, channels in MOTIONS.items()
        if name in window.scores and all(c in p.measured for c in channels)
    }
    spreads = with_hull_ends(spreads, by.length)
    shares = [ErrorShare(name, window.scores[name].rms, spread, window.window) for name, spread in spreads.items()]
    return _above_noise(shares, by)


def _above_noise(shares: Sequence[ErrorShare], by: ErrorScale) -> tuple[ErrorShare, ...]:
    """Leave out motions that are mostly noise of their sensor, which measure no model; all where all are."""
    kept = tuple(e for e in shares if not is_sensor_noise(e.spread, by.noise.get(e.name, 0.0)))
    return kept or tuple(shares)


def _inside_windows(record: Record, channels: Sequence[str], seconds: float) -> list[Array]:
    """Each channel about its mean in every window of that length, a remainder at the end left out; (m,) each."""
    number = np.floor((record.time - record.time[0]) / seconds + _ROUNDING).astype(int)
    whole = max(math.floor(record.duration / seconds + _ROUNDING), 1)
    motions = []
    for channel in channels:
        parts = (record[channel][(number == k) & np.isfinite(record[channel])] for k in range(whole))
        motions.append(np.concatenate([part - part.mean() for part in parts if len(part)] or [np.zeros(1)]))
    return motions


def largest_error_share(p: Prediction, by: ErrorScale = WHOLE_RUNS) -> ErrorShare | None:
    """Return the error over a whole run that is the largest share of its own motion; None: none can be compared."""
    return max(error_shares(p, by), key=lambda error_share: error_share.share, default=None)


def longest_judged(fit: Fit) -> float | None:
    """Return how long windows that judge held-out runs may be [s]; None where runs are judged whole.

    Deviations grow whatever the model is worth where the craft is course unstable, or where the disturbance that was
    estimated carries it so far: where a whole run is then predicted roughly at best, windows judge all of them.
    """
    by = _whole_runs(fit)
    worst = [(p, share) for p in fit.validation if p.divergence is None and (share := largest_error_share(p, by))]
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
    return p.is_left_by_disturbance(share.name, share.rms)


def judging_window(p: Prediction, longest: float) -> WindowScore | None:
    """Return the longest windows that last no longer [s], else the shortest; None: no windows."""
    ordered = sorted(p.windows, key=lambda w: w.seconds)
    short = [w for w in ordered if w.seconds <= longest]
    return short[-1] if short else next(iter(ordered), None)


def judged_shares(p: Prediction, by: ErrorScale) -> tuple[ErrorShare, ...]:
    """Return the errors by which a run is judged."""
    window = None if by.longest is None or p.divergence is not None else judging_window(p, by.longest)
    return error_shares(p, by) if window is None else window_shares(p, window, by)


def judged_share(p: Prediction, by: ErrorScale) -> ErrorShare | None:
    """Return the largest of them; None where none can be compared."""
    return max(judged_shares(p, by), key=lambda share: share.share, default=None)


def run_error(p: Prediction, by: ErrorScale = WHOLE_RUNS) -> float:
    """Return the largest share of its motion that a run misses, infinite where it diverges."""
    share = judged_share(p, by)
    return math.inf if p.divergence is not None else 0.0 if share is None else share.share


def worst_run(runs: Sequence[Prediction], by: ErrorScale = WHOLE_RUNS) -> Prediction:
    """Return the run with the largest error."""
    return max(runs, key=lambda p: run_error(p, by))


def worst_share(fit: Fit) -> ErrorShare | None:
    """Return the largest of all errors by which held-out runs are judged; None where none can be compared."""
    by = error_scale(fit)
    return judged_share(worst_run(fit.validation, by), by) if fit.validation else None


def is_missed(fit: Fit) -> bool:
    """Return whether a held-out run is not predicted at all: it diverges, or its mean is nearer."""
    largest = worst_share(fit)
    is_beyond = largest is not None and largest.grade is Grade.NOT
    return is_beyond or any(p.divergence is not None for p in fit.validation)


def is_carried(fit: Fit) -> bool:
    """Return whether the disturbance that was estimated leaves most of the errors of held-out runs by itself."""
    return longest_judged(fit) == math.inf


def graded_errors(fit: Fit) -> str:
    """Return the errors of the worst run of its motions: ``2.3° of 14° in heading: well``; empty: unknown."""
    by, worst = error_scale(fit), worst_share(fit)
    if worst is None:
        return ""
    shares = judged_shares(worst_run(fit.validation, by), by)
    noise = by.noise
    texts = [
        f"{error_text(e.name, e.rms)} of {error_text(e.name, e.spread)} in {ERROR_LABELS[e.name][0]}"
        + (f" (sensor noise {error_text(e.name, n)})" if is_sensor_noise(e.rms, n := noise.get(e.name, 0.0)) else "")
        for e in shares
    ]
    over = f", over {worst.window}" if worst.window else ""
    return f"{enumeration(texts)}{over}: {worst.grade}"


# Held-out runs that repeat a trained manoeuvre: same kind, same orders, same speed, by what the runs show.

MAX_NAMES = 3  # of runs that a sentence holds; chosen


def repeated_runs(p: Prediction, predictions: Sequence[Prediction]) -> list[str]:
    """Return the names of the training runs whose manoeuvre a held-out run repeats."""
    orders = steered_orders(p.measured)
    if orders is None:
        return []
    trained = (
        (prediction.record, steered_orders(prediction.measured))
        for prediction in predictions
        if prediction.role == "training"
    )
    return [name for name, other in trained if other is not None and orders.is_repeated_by(other)]


def repeat_clause(p: Prediction, predictions: Sequence[Prediction]) -> str:
    """Return which trained manoeuvre a held-out run repeats, and what that leaves open; empty where it repeats none."""
    names = repeated_runs(p, predictions)
    if not names:
        return ""
    were = "which was" if len(names) == 1 else "which were"
    return f"a repeat of {enumeration(names, MAX_NAMES)}, {were} fitted: it does not test other manoeuvres"


# The verdict on a fit: one sentence with its number; beyond what the model extrapolates.

# errors that a sentence names, the first ones that the runs have
MAX_ERRORS = 2
# factor of the reach of the rudder to one side from which on both sides are named
ONE_SIDED = 1.25
# rad below which the rudder is not over
LEAST_RUDDER = math.radians(0.5)
_MAIN_ERRORS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")


def verdict(fit: Fit) -> str:
    """Return how well runs that were not fitted are predicted, in one sentence; first whether it may be used at all."""
    score, limit = _score_clauses(fit)
    clauses = [score, _implausible_clause(fit) or limit] if has_converged(fit) else [score]
    return f"{unusable_sentence(fit)}{'; '.join(clause for clause in clauses if clause)}."


def _implausible_clause(fit: Fit) -> str:
    """That a good prediction was made by coefficients that no craft has; empty where none is called so."""
    is_odd = any(f.code == "unphysical-values" and f.severity is not Severity.INFO for f in fit.findings)
    return "its coefficients are implausible" if is_odd else ""


def unusable_sentence(fit: Fit) -> str:
    """Return that the coefficients must not be used, with a space behind it; empty where they can."""
    return "" if has_converged(fit) else "Do not use the coefficients: the search did not converge. "


def has_converged(fit: Fit) -> bool:
    """Return whether the search ended at an optimum; one by a population has no test of it and counts as ended."""
    return fit.search is not None or fit.solution.status.is_success


def _score_clauses(fit: Fit) -> tuple[str, str]:
    """How well runs are predicted, and what limits that; empty where nothing does."""
    held = fit.validation
    if not fit.predictions:
        return "No run was simulated with this fit", ""
    if not held:
        return _fitted_clauses(fit.predictions)
    by = error_scale(fit)
    if len(held) == 1:
        return _one_run_clauses(held[0], fit.predictions, by)
    return _several_runs_clauses(held, fit.predictions, by)


def _fitted_clauses(predictions: Sequence[Prediction]) -> tuple[str, str]:
    """How the runs are reproduced that the model was fitted to, where no other tests it."""
    diverged = [p.record for p in predictions if p.divergence is not None]
    if diverged:
        of_all = "" if len(predictions) == 1 else f" of its {len(predictions)} runs"
        return f"Does not reproduce {enumeration(diverged, MAX_NAMES)}{of_all}: the simulation diverges", ""
    errors, runs = worst_errors(predictions), "run" if len(predictions) == 1 else f"{len(predictions)} runs"
    return f"Reproduces its {runs}{f' to {errors}' if errors else ''}", "no held-out run tests the model"


def _one_run_clauses(p: Prediction, predictions: Sequence[Prediction], by: ErrorScale) -> tuple[str, str]:
    """How a single held-out run is predicted, as a grade and its errors."""
    run = f"the held-out {run_name(p)}"
    if p.divergence is not None:
        return f"Does not predict {run}: the simulation diverges after {duration(p.divergence.seconds)}", ""
    largest, errors = judged_share(p, by), _judged_errors(p, by)
    if largest is not None and largest.grade is Grade.NOT:
        return f"Does not predict {run}: {errors}", _carried_clause(by)
    grade = "" if largest is None else f" {largest.grade}"
    repeat = "it repeats a fitted manoeuvre" if repeated_runs(p, predictions) else ""
    return f"Predicts {run}{grade}{f': {errors}' if errors else ''}", repeat


def _carried_clause(by: ErrorScale) -> str:
    """That a disturbance explains a miss; empty where none carries the craft so far, by `longest_judged`."""
    return "the estimated disturbance alone leaves most of that" if by.longest == math.inf else ""


def _judged_errors(p: Prediction, by: ErrorScale) -> str:
    """The errors by which a run is judged; where windows judge it, in those."""
    window = None if by.longest is None else judging_window(p, by.longest)
    if window is None:
        return worst_errors([p])
    names = [name for name in _MAIN_ERRORS if name in window.scores][:MAX_ERRORS]
    errors = enumeration([f"{error_text(n, window.scores[n].rms)} in {ERROR_LABELS[n][0]}" for n in names])
    return f"{errors} over {window.window}"


def _worst_errors(held: Sequence[Prediction], by: ErrorScale) -> str:
    """The name of the worst of several runs, or of the only one, and its errors: ``, R35 worst: 5.3° in heading``."""
    worst = worst_run(held, by)
    errors = _judged_errors(worst, by)
    name = f", {worst.record} worst" if len(held) > 1 else f" ({worst.record})"
    return f"{name}: {errors}" if errors else name


def _several_runs_clauses(
    held: Sequence[Prediction], predictions: Sequence[Prediction], by: ErrorScale
) -> tuple[str, str]:
    """How held-out runs are predicted: the worst of them counts, and is named where it is predicted poorly."""
    diverged = [p.record for p in held if p.divergence is not None]
    if diverged:
        names = enumeration(diverged, MAX_NAMES)
        return f"Does not predict {len(diverged)} of {len(held)} held-out runs: the simulation diverges ({names})", ""
    grades = {p.record: share.grade for p in held if (share := judged_share(p, by)) is not None}
    worst = _worst(grades.values())
    if worst in (Grade.POORLY, Grade.NOT):
        names = [name for name, grade in grades.items() if grade is worst]
        missed, others = ([p for p in held if (p.record in names) is which] for which in (True, False))
        verb = "Does not predict" if worst is Grade.NOT else "Predicts poorly"
        graded = _graded([grades.get(p.record) for p in others])
        remainder = f"the other{'s' if len(others) > 1 else ''}{graded}" if graded else ""
        score = f"{verb} {len(names)} of {len(held)} held-out runs{_worst_errors(missed, by)}"
        return score, remainder or _carried_clause(by)
    repeats = sum(bool(repeated_runs(p, predictions)) for p in held)
    repeat = f"{repeats} {'repeats' if repeats == 1 else 'repeat'} a fitted manoeuvre" if repeats else ""
    return f"Predicts {len(held)} held-out runs{_graded(list(grades.values()))}{_worst_errors(held, by)}", repeat


def _worst(grades: Iterable[Grade | None]) -> Grade | None:
    return max((grade for grade in grades if grade is not None), key=list(Grade).index, default=None)


def _graded(grades: Sequence[Grade | None]) -> str:
    """How runs are predicted: `` well or better``; empty where none is graded."""
    worst = _worst(grades)
    better = "" if worst is Grade.CLOSELY or len(grades) == 1 else " or better"
    return "" if worst is None else f" {worst}{better}"


def worst_errors(predictions: Sequence[Prediction]) -> str:
    """Return the largest rms error over the runs of the first two quantities: ``6.3° in heading and 5.6 m in …``."""
    texts = []
    names = [n for n in _MAIN_ERRORS if any(n in p.rms for p in predictions)]
    for name in (names or [n for n in ERROR_LABELS if any(n in p.rms for p in predictions)])[:MAX_ERRORS]:
        sizes = [p.rms[name] for p in predictions if name in p.rms and math.isfinite(p.rms[name])]
        if sizes:
            texts.append(f"{error_text(name, max(sizes))} in {ERROR_LABELS[name][0]}")
    return enumeration(texts)


def run_name(p: Prediction) -> str:
    """Return what a run is, from its rudder and heading: ``35° zigzag``; its name where they do not show it."""
    try:
        manoeuvre = ObservedManoeuvre.from_record(p.measured)
    except InputError:
        return f"run {p.record}"
    angles = [hold.angle for hold in manoeuvre.holds]
    if manoeuvre.kind is ManoeuvreKind.ZIGZAG and angles:
        return f"{ordered_degrees(float(np.median(np.abs(angles)))):.0f}° zigzag"
    if manoeuvre.kind is ManoeuvreKind.TURNING_CIRCLE:
        angle = ordered_degrees(manoeuvre.longest_hold[0].angle)
        return f"turning circle to {'starboard' if angle > 0 else 'port'} with {abs(angle):.0f}° rudder"
    return f"run {p.record}"


def extrapolation_limit(fit: Fit) -> str:
    """Return beyond which rudder, roll or speed the model extrapolates, ``rudder beyond 30°``; empty: none shows."""
    training = [p.measured for p in fit.predictions if p.role == "training"]
    rudder = [to_starboard(r, "delta") for r in training if "delta" in r]
    if rudder:
        reach = _rudder_reach(np.concatenate(rudder))
        return f"rudder beyond {reach}" if reach else ""
    if "phi" in fit.model.states and any("phi" in r for r in training):
        largest = max(float(np.nanmax(np.abs(r["phi"]))) for r in training if "phi" in r)  # a decay has it once
        return f"roll beyond {math.degrees(largest):.0f}°"
    if fit.model.has_speed and any("u" in r for r in training):
        speed = np.concatenate([np.abs(r["u"]) for r in training if "u" in r])
        return f"speed beyond {significant(float(np.nanpercentile(speed, REACH_PERCENTILE)), 2)} m/s"
    return ""


def _rudder_reach(angles: np.ndarray) -> str:
    """How far the rudder went, with the side where it went farther to one; empty where it was not moved."""
    port, starboard = (float(np.nanpercentile(np.maximum(side, 0.0), REACH_PERCENTILE))
                       for side in (-angles, angles))  # fmt: skip
    if max(port, starboard) < LEAST_RUDDER:
        return ""
    if max(port, starboard) <= ONE_SIDED * min(port, starboard):
        return f"{math.degrees(max(port, starboard)):.0f}°"
    return f"{math.degrees(starboard):.0f}° to starboard and {math.degrees(port):.0f}° to port"
