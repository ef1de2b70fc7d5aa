"""The verdict on a fit: one sentence with its number, and where the model extrapolates."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Fit, Prediction
from seatrial.core.text.numbers import duration, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import InputError
from seatrial.physics.manoeuvres import REACH_PERCENTILE, ManoeuvreKind, ObservedManoeuvre, to_starboard
from seatrial.reporting.runs import ERROR_LABELS

# errors that a sentence names, the first ones that the runs have
MAX_ERRORS = 2
# factor of the reach of the rudder to one side from which on both sides are named
ONE_SIDED = 1.25
# rad below which the rudder is not over
LEAST_RUDDER = math.radians(0.5)
_DEGREES = math.degrees(1.0)
# share of the spread of a motion, a standard deviation, from which on an error over the whole run has lost it; chosen
LOST_SHARE = 0.5
_MOTIONS = {"psi_deg": ("psi",), "position_m": ("x0", "y0"), "z": ("z",), "theta_deg": ("theta",), "phi_deg": ("phi",)}
_MAIN_ERRORS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")


def verdict(fit: Fit) -> str:
    """Return how well runs that were not fitted are predicted, and where the model extrapolates, in one sentence."""
    clauses = [_score_clause(fit), extrapolation_limit(fit)]
    return f"{unusable_sentence(fit)}{'; '.join(clause for clause in clauses if clause)}."


def unusable_sentence(fit: Fit) -> str:
    """Return that the coefficients must not be used, with the reason and a space behind it; empty where they can."""
    if has_converged(fit):
        return ""
    return f"Do not use the coefficients: the search did not converge ({fit.solution.status.value.partition(';')[0]}). "


def has_converged(fit: Fit) -> bool:
    """Return whether the search ended at an optimum; one by a population has no test of it and counts as ended."""
    return fit.search is not None or fit.solution.status.is_success


def _score_clause(fit: Fit) -> str:
    held = fit.validation
    if not held and not fit.predictions:
        return "Nothing is said of predictions: no run was simulated with this fit"
    if not held:
        to_errors = f", to {worst_errors(fit.predictions)}" if worst_errors(fit.predictions) else ""
        fitted = counted(len(fit.predictions), "run")
        return f"Reproduces the {fitted} it was fitted to{to_errors}; no run was held out to test its predictions"
    diverged = [p for p in held if p.divergence is not None]
    errors = worst_errors(held)
    to_errors = f" to {errors}{' at worst' if len(held) > 1 else ''}" if errors else ""
    if len(held) == 1:
        p = held[0]
        if p.divergence is not None:
            return (
                f"Does not predict {run_name(p)} that was not used: the simulation diverges after "
                f"{duration(p.divergence.seconds)} of {duration(p.measured.duration)}"
            )
        if is_lost(p):
            over = f"{errors} {_over_time(p)}"
            return f"Does not follow {run_name(p)} that was not used, to its end: {over}"
        return f"Predicts {run_name(p)} that was not used, {duration(p.measured.duration)},{to_errors}"
    if diverged:
        return (
            f"Of {len(held)} runs that were not used, {len(diverged)} cannot be predicted (the simulation diverges: "
            f"{enumeration([p.record for p in diverged], 3)})"  # names that a sentence holds, chosen
        )
    shortest, longest = (f([p.measured.duration for p in held]) for f in (min, max))
    lasting = duration(shortest) if duration(shortest) == duration(longest) else (
        f"{duration(shortest)} to {duration(longest)}")  # fmt: skip
    lost = [p.record for p in held if is_lost(p)]
    if lost:
        names = enumeration(lost, 3)  # that a sentence holds, chosen
        return f"Of {len(held)} runs that were not used, {lasting} each, {names} {_is_not_followed(lost)},{to_errors}"
    return f"Predicts {len(held)} runs that were not used, {lasting} each,{to_errors}"


def _is_not_followed(names: Sequence[str]) -> str:
    return f"{'is' if len(names) == 1 else 'are'} not followed to {'its' if len(names) == 1 else 'their'} end"


@dataclass(frozen=True)
class ErrorShare:
    """An error over a whole run, as a share of the standard deviation of that motion; name: as in `Prediction.rms`."""

    name: str
    share: float

    @property
    def is_lost(self) -> bool:
        """Whether the error is more than half of the motion itself."""
        return self.share > LOST_SHARE


def largest_error_share(p: Prediction) -> ErrorShare | None:
    """Return the error of a run that is the largest share of its own motion; None where none can be compared."""
    shares = []
    for name, channels in _MOTIONS.items():
        if name in p.rms and all(c in p.measured for c in channels):
            spread = math.sqrt(sum(float(np.nanvar(p.measured[c])) for c in channels))
            size = spread * (_DEGREES if name.endswith("_deg") else 1.0)
            shares.append(ErrorShare(name, p.rms[name] / size if size > 0.0 else math.inf))
    return max(shares, key=lambda one: one.share, default=None)


def is_lost(p: Prediction) -> bool:
    """Return whether an error over the whole run is more than half of the motion itself."""
    largest = largest_error_share(p)
    return largest is not None and largest.is_lost


def share_sentence(predictions: Sequence[Prediction]) -> str:
    """Return the largest of all errors as a share of its motion, with the limit of the verdict; empty where unknown."""
    shares = [share for p in predictions if (share := largest_error_share(p)) is not None]
    if not shares:
        return ""
    largest = max(shares, key=lambda one: one.share)
    return (
        f"in {ERROR_LABELS[largest.name][0]} {significant(largest.share, 2)} of the standard deviation of the motion "
        f"itself (above {LOST_SHARE:g}: does not follow)"
    )


def _over_time(p: Prediction) -> str:
    """The length of the run, and the errors over its shortest windows."""
    whole = f"over {duration(p.measured.duration)}"
    window = min(p.windows, key=lambda w: w.seconds, default=None)
    if window is None:
        return whole
    names = [n for n in _MAIN_ERRORS if n in window.scores and math.isfinite(window.scores[n].rms)][:MAX_ERRORS]
    errors = enumeration([f"{error_text(n, window.scores[n].rms)} in {ERROR_LABELS[n][0]}" for n in names])
    return f"{whole}, {errors} over {window.window}" if errors else whole


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
    angles = [math.degrees(hold.angle) for hold in manoeuvre.holds]
    if manoeuvre.kind is ManoeuvreKind.ZIGZAG and angles:
        return f"a {float(np.median(np.abs(angles))):.0f}° zigzag"
    if manoeuvre.kind is ManoeuvreKind.TURNING_CIRCLE:
        angle = math.degrees(manoeuvre.longest_hold[0].angle)
        return f"a turning circle to {'starboard' if angle > 0 else 'port'} with {abs(angle):.0f}° rudder"
    return f"{p.record}, a run"


def extrapolation_limit(fit: Fit) -> str:
    """Return beyond which rudder, roll or speed the model leaves its training runs; empty where none of them shows."""
    training = [p.measured for p in fit.predictions if p.role == "training"]
    rudder = [to_starboard(r, "delta") for r in training if "delta" in r]
    if rudder:
        return _beyond(_rudder_reach(np.concatenate(rudder)))
    if "phi" in fit.model.states and any("phi" in r for r in training):
        largest = max(float(np.nanmax(np.abs(r["phi"]))) for r in training if "phi" in r)  # a decay has it once
        return _beyond(f"{math.degrees(largest):.0f}° of roll")
    if "u" in fit.model.states and any("u" in r for r in training):
        speed = np.concatenate([np.abs(r["u"]) for r in training if "u" in r])
        return _beyond(f"{significant(float(np.nanpercentile(speed, REACH_PERCENTILE)), 2)} m/s")
    return ""


def _beyond(reach: str) -> str:
    return f"beyond {reach} the model extrapolates" if reach else ""


def _rudder_reach(angles: np.ndarray) -> str:
    """How far the rudder went, with the side where it went farther to one; empty where it was not moved."""
    port, starboard = (float(np.nanpercentile(np.maximum(side, 0.0), REACH_PERCENTILE))
                       for side in (-angles, angles))  # fmt: skip
    if max(port, starboard) < LEAST_RUDDER:
        return ""
    if max(port, starboard) <= ONE_SIDED * min(port, starboard):
        return f"{math.degrees(max(port, starboard)):.0f}° rudder"
    return f"{math.degrees(starboard):.0f}° rudder to starboard and {math.degrees(port):.0f}° to port"
