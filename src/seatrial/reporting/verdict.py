"""The verdict on a fit: one sentence with its number, and where the model extrapolates."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from seatrial.core.results import Fit, Prediction, Stability
from seatrial.core.text.numbers import duration, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import InputError, Record, Severity
from seatrial.physics.manoeuvres import (
    REACH_PERCENTILE,
    ManoeuvreKind,
    ObservedManoeuvre,
    initial_speed,
    ordered_degrees,
    to_starboard,
)
from seatrial.reporting.course import growth_clause, unstable_course
from seatrial.reporting.grades import Grade, is_missed, judged_share, judging_course, judging_window
from seatrial.reporting.repeats import MAX_NAMES, repeat_clause, repeated_runs
from seatrial.reporting.runs import ERROR_LABELS
from seatrial.reporting.summary import search_status

# errors that a sentence names, the first ones that the runs have
MAX_ERRORS = 2
# factor of the reach of the rudder to one side from which on both sides are named
ONE_SIDED = 1.25
# share of their mean by which speeds at the start of runs differ that count as one; chosen
ONE_SPEED = 0.1
# rad below which the rudder is not over
LEAST_RUDDER = math.radians(0.5)
_DEGREES = math.degrees(1.0)
_MAIN_ERRORS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")


def verdict(fit: Fit) -> str:
    """Return how well runs that were not fitted are predicted, and where the model extrapolates, in one sentence."""
    clauses = [_score_clause(fit), _implausible_clause(fit), extrapolation_limit(fit)]
    return f"{unusable_sentence(fit)}{'; '.join(clause for clause in clauses if clause)}."


def _implausible_clause(fit: Fit) -> str:
    """That a good prediction was made by coefficients that no craft has; empty where none is called so."""
    if not any(f.code == "unphysical-values" and f.severity is not Severity.INFO for f in fit.findings):
        return ""
    return "its coefficients are implausible, so rely on it for such runs only"


def unusable_sentence(fit: Fit) -> str:
    """Return that the coefficients must not be used, with the reason and a space behind it; empty where they can."""
    if has_converged(fit):
        return ""
    tested = "What is tested are predictions alone. " if fit.validation and not is_missed(fit) else ""
    return f"Do not use the coefficients: the search did not converge ({search_status(fit)}). {tested}"


def has_converged(fit: Fit) -> bool:
    """Return whether the search ended at an optimum; one by a population has no test of it and counts as ended."""
    return fit.search is not None or fit.solution.status.is_success


def _score_clause(fit: Fit) -> str:
    held = fit.validation
    if not held and not fit.predictions:
        return "Nothing is said of predictions: no run was simulated with this fit"
    if not held:
        lost = [p.record for p in fit.predictions if p.divergence is not None]
        if lost:
            return (
                f"Does not reproduce {enumeration(lost, MAX_NAMES)} of {counted(len(fit.predictions), 'run')} that it "
                "was fitted to: the simulation diverges; no run was held out to test its predictions"
            )
        to_errors = f", to {worst_errors(fit.predictions)}" if worst_errors(fit.predictions) else ""
        fitted = counted(len(fit.predictions), "run")
        return f"Reproduces the {fitted} it was fitted to{to_errors}; no run was held out to test its predictions"
    course = judging_course(held, unstable_course(fit))
    if len(held) == 1:
        return _one_run_clause(held[0], fit.predictions, course)
    return _several_runs_clause(held, fit.predictions, course)


def _one_run_clause(p: Prediction, predictions: Sequence[Prediction], course: Stability | None) -> str:
    """How a single held-out run is predicted, as a grade and its errors, and what it repeats.

    course: because of which windows judge it; None: the whole run does.
    """
    if p.divergence is not None:
        return (
            f"Does not predict {run_name(p)} that was not used: the simulation diverges after "
            f"{duration(p.divergence.seconds)} of {duration(p.measured.duration)}"
        )
    largest, errors, repeat = judged_share(p, course), _judged_errors([p], course), repeat_clause(p, predictions)
    repeat = f"; it is {repeat}" if repeat else ""
    if largest is not None and largest.grade is Grade.NOT:
        over = "" if course is not None else f" {_over_time(p)}"
        return f"Does not predict {run_name(p)} that was not used: {errors}{over}{repeat}"
    lasting = f"Predicts {run_name(p)} that was not used, {duration(p.measured.duration)},"
    if largest is None:
        return f"{lasting} to {errors}{repeat}" if errors else f"{lasting.rstrip(',')}{repeat}"
    short = _short_windows(p) if largest.grade is Grade.POORLY and course is None else ""
    return f"{lasting} {largest.grade}: to {errors}{f'; {short}' if short else ''}{repeat}"


def _judged_errors(held: Sequence[Prediction], course: Stability | None) -> str:
    """The largest errors by which runs are judged; of a course-unstable craft in windows, with those of whole runs."""
    whole, worst = worst_errors(held), " at worst" if len(held) > 1 else ""
    if course is None:
        return f"{whole}{worst}" if whole else ""
    windows = [w for p in held if (w := judging_window(p, course)) is not None]
    names = [n for n in _MAIN_ERRORS if any(n in w.scores for w in windows)][:MAX_ERRORS]
    worst_of = {n: max(w.scores[n].rms for w in windows if n in w.scores) for n in names}
    errors = enumeration([f"{error_text(n, rms)} in {ERROR_LABELS[n][0]}" for n, rms in worst_of.items()])
    lengths = enumeration(list(dict.fromkeys(w.window for w in windows)))
    leaves = f"simulated whole, the model leaves {'them' if len(held) > 1 else 'it'} by {whole}"
    reason = f"where small errors grow by themselves, as the craft is {growth_clause(course)}"
    return f"{errors}{worst}, in windows of {lengths}; {leaves}, {reason}"


def _several_runs_clause(
    held: Sequence[Prediction], predictions: Sequence[Prediction], course: Stability | None
) -> str:
    """How held-out runs are predicted: the worst of them counts, and is named where it is predicted poorly.

    course: because of which windows judge them; None: whole runs do.
    """
    diverged = [p.record for p in held if p.divergence is not None]
    if diverged:
        return (
            f"Of {len(held)} runs that were not used, {len(diverged)} cannot be predicted (the simulation diverges: "
            f"{enumeration(diverged, MAX_NAMES)})"
        )
    shortest, longest = (duration(f(p.measured.duration for p in held)) for f in (min, max))
    lasting = f"{shortest if shortest == longest else f'{shortest} to {longest}'} each"
    repeats = sum(bool(repeated_runs(p, predictions)) for p in held)
    repeat = f"; {repeats} of them {'repeats' if repeats == 1 else 'repeat'} a fitted manoeuvre" if repeats else ""
    grades = {p.record: share.grade for p in held if (share := judged_share(p, course)) is not None}
    worst = _worst(grades.values())
    if worst in (Grade.POORLY, Grade.NOT):
        names = [name for name, grade in grades.items() if grade is worst]
        verb = f"{'is' if len(names) == 1 else 'are'} {'not predicted' if worst is Grade.NOT else 'poorly predicted'}"
        missed, others = ([p for p in held if (p.record in names) is which] for which in (True, False))
        rest = _graded([grades.get(p.record) for p in others], _judged_errors(others, course))
        clauses = [f"{enumeration(names, MAX_NAMES)} {verb}, to {_judged_errors(missed, course)}",
                   *([f"the other{'s' if len(others) > 1 else ''}{rest}"] if rest else [])]  # fmt: skip
        return f"Of {len(held)} runs that were not used, {lasting}, {'; '.join(clauses)}{repeat}"
    graded = _graded(list(grades.values()), _judged_errors(held, course))
    return f"Predicts {len(held)} runs that were not used, {lasting},{graded}{repeat}"


def _worst(grades: Iterable[Grade | None]) -> Grade | None:
    return max((grade for grade in grades if grade is not None), key=list(Grade).index, default=None)


def _graded(grades: Sequence[Grade | None], errors: str) -> str:
    """How runs are predicted and their errors: `` well or better: to 6.3° in heading``."""
    worst = _worst(grades)
    better = "" if worst is Grade.CLOSELY or len(grades) == 1 else " or better"
    return "".join([f" {worst}{better}:" if worst is not None else "", f" to {errors}" if errors else ""])


def _over_time(p: Prediction) -> str:
    """The length of the run, and the errors over its shortest windows."""
    whole, short = f"over {duration(p.measured.duration)}", _short_windows(p)
    return f"{whole}, {short}" if short else whole


def _short_windows(p: Prediction) -> str:
    """The errors over the shortest windows; empty where none has any."""
    window = min(p.windows, key=lambda w: w.seconds, default=None)
    if window is None:
        return ""
    names = [n for n in _MAIN_ERRORS if n in window.scores and math.isfinite(window.scores[n].rms)][:MAX_ERRORS]
    errors = enumeration([f"{error_text(n, window.scores[n].rms)} in {ERROR_LABELS[n][0]}" for n in names])
    return f"{errors} over {window.window}" if errors else ""


def worst_errors(predictions: Sequence[Prediction]) -> str:
    """Return the largest rms error over the runs of the first two quantities: ``6.3° in heading and 5.6 m in …``."""
    texts = []
    names = [n for n in _MAIN_ERRORS if any(n in p.rms for p in predictions)]
    for name in (names or [n for n in ERROR_LABELS if any(n in p.rms for p in predictions)])[:MAX_ERRORS]:
        sizes = [p.rms[name] for p in predictions if name in p.rms and math.isfinite(p.rms[name])]
        if sizes:
            texts.append(f"{error_text(name, max(sizes))} in {ERROR_LABELS[name][0]}")
    return enumeration(texts)


def error_text(name: str, rms: float) -> str:
    """Return an error of `Prediction.rms` with its unit: ``6.3°``, ``0.037 m/s``."""
    unit = ERROR_LABELS[name][1]
    value = significant(rms * (_DEGREES if name == "r" else 1.0), 2)
    return f"{value}°" if unit == "deg" else f"{value} {unit}"


def run_name(p: Prediction) -> str:
    """Return what a run is, from its rudder and heading: ``a 35° zigzag``; its name where they do not show it."""
    try:
        manoeuvre = ObservedManoeuvre.from_record(p.measured)
    except InputError:
        return f"{p.record}, a run"
    angles = [hold.angle for hold in manoeuvre.holds]
    if manoeuvre.kind is ManoeuvreKind.ZIGZAG and angles:
        return f"a {ordered_degrees(float(np.median(np.abs(angles)))):.0f}° zigzag"
    if manoeuvre.kind is ManoeuvreKind.TURNING_CIRCLE:
        angle = ordered_degrees(manoeuvre.longest_hold[0].angle)
        return f"a turning circle to {'starboard' if angle > 0 else 'port'} with {abs(angle):.0f}° rudder"
    return f"{p.record}, a run"


def extrapolation_limit(fit: Fit) -> str:
    """Return beyond which rudder, roll or speed the model leaves its training runs; empty where none of them shows."""
    training = [p.measured for p in fit.predictions if p.role == "training"]
    rudder = [to_starboard(r, "delta") for r in training if "delta" in r]
    if rudder:
        speed = _only_speed(training) if fit.model.has_speed else ""
        return _beyond(
            _rudder_reach(np.concatenate(rudder)), f", or from approach speeds far from {speed}," if speed else ""
        )
    if "phi" in fit.model.states and any("phi" in r for r in training):
        largest = max(float(np.nanmax(np.abs(r["phi"]))) for r in training if "phi" in r)  # a decay has it once
        return _beyond(f"{math.degrees(largest):.0f}° of roll")
    if fit.model.has_speed and any("u" in r for r in training):
        speed = np.concatenate([np.abs(r["u"]) for r in training if "u" in r])
        return _beyond(f"{significant(float(np.nanpercentile(speed, REACH_PERCENTILE)), 2)} m/s")
    return ""


def _beyond(reach: str, other: str = "") -> str:
    return f"beyond {reach}{other} the model extrapolates" if reach else ""


def _only_speed(training: Sequence[Record]) -> str:
    """The speed from which all of several training runs begin; empty where they differ, and of one run."""
    speeds = [speed for r in training if math.isfinite(speed := initial_speed(r))]
    if len(speeds) < 2 or np.ptp(speeds) > ONE_SPEED * np.mean(speeds):
        return ""
    return f"{significant(float(np.mean(speeds)), 2)} m/s"


def _rudder_reach(angles: np.ndarray) -> str:
    """How far the rudder went, with the side where it went farther to one; empty where it was not moved."""
    port, starboard = (float(np.nanpercentile(np.maximum(side, 0.0), REACH_PERCENTILE))
                       for side in (-angles, angles))  # fmt: skip
    if max(port, starboard) < LEAST_RUDDER:
        return ""
    if max(port, starboard) <= ONE_SIDED * min(port, starboard):
        return f"{math.degrees(max(port, starboard)):.0f}° rudder"
    return f"{math.degrees(starboard):.0f}° rudder to starboard and {math.degrees(port):.0f}° to port"
