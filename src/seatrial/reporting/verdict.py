"""The verdict on a fit: one sentence with its number; beyond what the model extrapolates."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from seatrial.core.results import Fit, Prediction
from seatrial.core.text.numbers import duration, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, Severity
from seatrial.physics.manoeuvres import (
    REACH_PERCENTILE,
    ManoeuvreKind,
    ObservedManoeuvre,
    ordered_degrees,
    to_starboard,
)
from seatrial.reporting.grades import (
    ERROR_LABELS,
    Grade,
    error_text,
    judged_share,
    judging_window,
    longest_judged,
    worst_run,
)
from seatrial.reporting.repeats import MAX_NAMES, repeated_runs

# errors that a sentence names, the first ones that the runs have
MAX_ERRORS = 2
# factor of the reach of the rudder to one side from which on both sides are named
ONE_SIDED = 1.25
# rad below which the rudder is not over
LEAST_RUDDER = math.radians(0.5)
_MAIN_ERRORS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")


def verdict(fit: Fit) -> str:
    """Return how well runs that were not fitted are predicted, in one sentence; first whether it may be used at all."""
    clauses = [_score_clause(fit), _implausible_clause(fit)]
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


def _score_clause(fit: Fit) -> str:
    held = fit.validation
    if not fit.predictions:
        return "No run was simulated with this fit"
    if not held:
        return _fitted_clause(fit.predictions)
    longest = longest_judged(fit)
    if len(held) == 1:
        return _one_run_clause(held[0], fit.predictions, longest)
    return _several_runs_clause(held, fit.predictions, longest)


def _fitted_clause(predictions: Sequence[Prediction]) -> str:
    """How the runs are reproduced that the model was fitted to, where no other tests it."""
    diverged = [p.record for p in predictions if p.divergence is not None]
    if diverged:
        of_all = "" if len(predictions) == 1 else f" of its {len(predictions)} runs"
        return f"Does not reproduce {enumeration(diverged, MAX_NAMES)}{of_all}: the simulation diverges"
    errors, runs = worst_errors(predictions), "run" if len(predictions) == 1 else f"{len(predictions)} runs"
    return f"Reproduces its {runs}{f' to {errors}' if errors else ''}; no held-out run tests the model"


def _one_run_clause(p: Prediction, predictions: Sequence[Prediction], longest: float | None) -> str:
    """How a single held-out run is predicted, as a grade and its errors.

    longest: of windows that judge it [s]; None: the whole run does.
    """
    run = f"the held-out {run_name(p)}"
    if p.divergence is not None:
        return f"Does not predict {run}: the simulation diverges after {duration(p.divergence.seconds)}"
    largest, errors = judged_share(p, longest), _judged_errors(p, longest)
    if largest is not None and largest.grade is Grade.NOT:
        return f"Does not predict {run}: {errors}"
    grade = "" if largest is None else f" {largest.grade}"
    repeat = "; it repeats a fitted manoeuvre" if repeated_runs(p, predictions) else ""
    return f"Predicts {run}{grade}{f': {errors}' if errors else ''}{repeat}"


def _judged_errors(p: Prediction, longest: float | None) -> str:
    """The errors by which a run is judged; where windows judge it, in those."""
    window = None if longest is None else judging_window(p, longest)
    if window is None:
        return worst_errors([p])
    names = [name for name in _MAIN_ERRORS if name in window.scores][:MAX_ERRORS]
    errors = enumeration([f"{error_text(n, window.scores[n].rms)} in {ERROR_LABELS[n][0]}" for n in names])
    return f"{errors} over {window.window}"


def _worst_errors(held: Sequence[Prediction], longest: float | None) -> str:
    """The errors of the worst of several runs, with its name: ``, R35 worst: 5.3° in heading``."""
    worst = worst_run(held, longest)
    errors = _judged_errors(worst, longest)
    name = f", {worst.record} worst" if len(held) > 1 else ""
    return f"{name}: {errors}" if errors else ""


def _several_runs_clause(held: Sequence[Prediction], predictions: Sequence[Prediction], longest: float | None) -> str:
    """How held-out runs are predicted: the worst of them counts, and is named where it is predicted poorly.

    longest: of windows that judge them [s]; None: whole runs do.
    """
    diverged = [p.record for p in held if p.divergence is not None]
    if diverged:
        names = enumeration(diverged, MAX_NAMES)
        return f"Does not predict {len(diverged)} of {len(held)} held-out runs: the simulation diverges ({names})"
    grades = {p.record: share.grade for p in held if (share := judged_share(p, longest)) is not None}
    worst = _worst(grades.values())
    if worst in (Grade.POORLY, Grade.NOT):
        names = [name for name, grade in grades.items() if grade is worst]
        missed, others = ([p for p in held if (p.record in names) is which] for which in (True, False))
        verb = "Does not predict" if worst is Grade.NOT else "Predicts poorly"
        graded = _graded([grades.get(p.record) for p in others])
        remainder = f"; the other{'s' if len(others) > 1 else ''}{graded}" if graded else ""
        which = f"{len(names)} of {len(held)} held-out runs ({enumeration(names, MAX_NAMES)})"
        return f"{verb} {which}{_worst_errors(missed, longest)}{remainder}"
    repeats = sum(bool(repeated_runs(p, predictions)) for p in held)
    repeat = f"; {repeats} {'repeats' if repeats == 1 else 'repeat'} a fitted manoeuvre" if repeats else ""
    return f"Predicts {len(held)} held-out runs{_graded(list(grades.values()))}{_worst_errors(held, longest)}{repeat}"


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
