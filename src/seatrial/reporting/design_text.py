"""A designed manoeuvre in sentences: how much more precise it is, on how many ships, and within which limits."""

import math

import numpy as np

from seatrial.core.results import Actuator, Design, ManoeuvrePrecision
from seatrial.core.results.design import (
    best_baseline,
    count_outside_limits,
    criterion_error,
    has_track,
    is_within_limits,
    sampled_criterion_errors,
)
from seatrial.core.text.numbers import duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import NOTATION, Severity, display_unit
from seatrial.core.values.notation import channel_meaning, unit_text
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting.first_screen import KeyFact
from seatrial.reporting.measures import manoeuvre_name

# relative standard error from which on only its order is shown
LARGEST_SHOWN_ERROR = 100.0
_SIDES = ("port", "starboard")
_CRITERION_NAMES = {"worst": "worst relative standard error", "mean": "mean relative standard error"}


def verdict(design: Design) -> str:
    """Return how precise the manoeuvre is, compared with the best standard one."""
    return _comparison(design)


def key_facts(design: Design) -> tuple[KeyFact, ...]:
    """Return the rows at the top: ships that differ, simulated trials, limits, warnings."""
    is_kept = is_within_limits(design.designed, design.limits) and not count_outside_limits(
        design.designed, design.limits
    )
    rows = (
        KeyFact("Ships that differ", _prior_draws(design), "ships"),
        KeyFact("Simulated trials", _confirmation(design), "confirmation"),
        KeyFact("Limits", _limits(design), "orders", is_kept),
    )
    warned = [f.code for f in design.findings if f.severity is not Severity.INFO]
    warnings = KeyFact("Warnings", enumeration(warned) or "none", "findings" if design.findings else "", not warned)
    return (*(row for row in rows if row.text), warnings)


def order_meaning(name: str) -> str:
    """Return what an input is and where its orders count positive: ``rudder angle, positive to starboard``."""
    if name not in NOTATION or NOTATION[name].positive == "none":
        return channel_meaning(name)
    side = NOTATION[name].positive
    return f"{NOTATION[name].meaning}, positive {'to ' if side in _SIDES else ''}{side}"


def order_warnings(design: Design) -> list[str]:
    """Return what the helmsman must know beside the orders: limits that are left, and the checks' warnings."""
    is_left = has_track(design) and not is_within_limits(design.designed, design.limits)
    limits = [_limits(design)] if is_left else []
    return limits + [sentence(f.text) for f in design.findings if f.severity is not Severity.INFO]


def _percent(share: float) -> str:
    if share < LARGEST_SHOWN_ERROR:
        return f"{significant(100.0 * share, 2)} %"
    return f"more than {significant(100.0 * LARGEST_SHOWN_ERROR, 1)} %"


def _weakest_coefficient(manoeuvre: ManoeuvrePrecision, design: Design) -> str:
    if design.criterion != "worst" or not np.isfinite(manoeuvre.relative_error).any():
        return ""
    return f" ({design.coefficients[int(np.argmax(manoeuvre.relative_error))]})"


def _comparison(design: Design) -> str:
    best, criterion = best_baseline(design), design.criterion
    error = criterion_error(design.designed, criterion)
    start = f"The {_CRITERION_NAMES[criterion]} is {_percent(error)}{_weakest_coefficient(design.designed, design)}"
    if best is None:
        return f"{start}; there is no standard manoeuvre to compare it with."
    theirs = criterion_error(best, criterion)
    against = f"{_percent(theirs)}{_weakest_coefficient(best, design)} with the best standard manoeuvre of equal length"
    leaving = "" if is_within_limits(best, design.limits) else ", which leaves the limits"
    against += f", {manoeuvre_name(best.name)}{leaving}"
    if error >= theirs:
        return f"{start}, no better than the {against}."
    ratio = f" ({significant(theirs / error, 2)} times as much)" if theirs < LARGEST_SHOWN_ERROR else ""
    return f"{start} against {against}{ratio}."


def _prior_draws(design: Design) -> str:
    """On how many of the drawn ships it is more precise than every standard manoeuvre."""
    errors = sampled_criterion_errors(design.designed, design.criterion)
    if not errors:
        return ""
    within = [rival for rival in design.baselines if is_within_limits(rival, design.limits)]
    compared = [sampled_criterion_errors(rival, design.criterion) for rival in within or design.baselines]
    wins = sum(
        all(not ours >= theirs[k] for theirs in compared) for k, ours in enumerate(errors) if not math.isnan(ours)
    )
    finite = [x for x in errors if not math.isnan(x)]
    reach = f"from {_percent(min(finite))} to {_percent(max(finite))}" if finite else "not known"
    text = f"On {counted(len(errors), 'ship')} drawn from the prior it is {reach}"
    if compared:
        which = "any standard manoeuvre within the limits" if _has_limits(design) else "any standard manoeuvre"
        text += f", smaller than with {which} on {wins} of {len(errors)}"
    lost = design.designed.diverged
    return text + (f"; {counted(lost, 'ship')} cannot be simulated." if lost else ".")


def _has_limits(design: Design) -> bool:
    return math.isfinite(design.limits.drift) or math.isfinite(design.limits.sea_room)


def _confirmation(design: Design) -> str:
    confirmation = design.confirmation
    if confirmation is None:
        return ""
    text = f"{confirmation.converged_runs} of {counted(confirmation.runs, 'simulated trial')} could be fitted"
    ratios = confirmation.error / confirmation.bound
    ratios = ratios[np.isfinite(ratios)]
    if not ratios.size:
        return f"{text}."
    reach = " to ".join(fixed(float(end), 2) for end in (ratios.min(), ratios.max()))
    return f"{text}; their errors are {reach} of those predicted."


def _limits(design: Design) -> str:
    limits, manoeuvre = design.limits, design.designed
    reached: list[str] = []
    if not has_track(design):
        return ""
    if math.isfinite(limits.drift):
        reached.append(f"a drift angle of {_degrees(manoeuvre.drift)} ({_degrees(limits.drift)} allowed)")
    if math.isfinite(limits.sea_room):
        reached.append(f"{significant(manoeuvre.distance)} m from the start ({significant(limits.sea_room)} m allowed)")
    if not reached:
        return ""
    verb = "reaches" if is_within_limits(manoeuvre, limits) else "leaves the limits: it reaches"
    straying, draws = count_outside_limits(manoeuvre, limits), len(manoeuvre.sampled_relative_error)
    drawn = f"; {straying} of {draws} drawn ships leave the limits" if straying else ""
    return f"The ship as assumed {verb} at most {enumeration(reached)}{drawn}."


def _degrees(angle: float) -> str:
    return f"{fixed(math.degrees(angle), 1)}°"


def facts(design: Design) -> list[tuple[str, str]]:
    """Return ship, model, duration, actuators and limits as pairs of name and text."""
    pairs = [
        ("Ship", design.ship),
        ("Model", design.model.name),
        ("Duration", duration(design.duration)),
        ("Steered with", "; ".join(actuator_text(a) for a in design.actuators)),
    ]
    allowed = [f"drift angle {_degrees(design.limits.drift)}"] if math.isfinite(design.limits.drift) else []
    allowed += [f"{exact(design.limits.sea_room)} m from the start"] if math.isfinite(design.limits.sea_room) else []
    return [*pairs, ("Limits", ", ".join(allowed) or "none")]


def actuator_text(a: Actuator) -> str:
    """Return an actuator with its limits: ``delta −35 to 35 deg, 10 deg/s, orders 6 s apart at least``."""
    factor, unit = channel_display_unit(a.name)
    rate = f"{exact(a.rate * factor)} {unit}/s" if math.isfinite(a.rate) else "may jump"
    reach = f"{exact(a.lower * factor)} to {exact(a.upper * factor)} {'' if unit == '1' else unit}".rstrip()
    return f"{a.name} {reach}, {rate}, orders {exact(a.hold)} s apart at least"


def settings(design: Design) -> list[tuple[str, str]]:
    """Return criterion, sensors and provenance as pairs of name and text."""
    sensors = [f"{name} {_noise_text(name, sd)}" for name, sd in design.sensors.items()]
    return [
        ("Criterion", _CRITERION_NAMES[design.criterion]),
        ("Sensors", f"{', '.join(sensors)} (standard deviations) at {exact(design.rate)} Hz"),
        ("Ships drawn", str(len(design.designed.sampled_relative_error))),
        ("Manoeuvres tried", str(design.solution.evaluations)),
        ("Seed", str(design.seed)),
        ("Elapsed", duration(design.elapsed_s)),
        ("Versions", ", ".join(f"{name} {version}" for name, version in design.versions.items())),
    ]


def _noise_text(name: str, sd: float) -> str:
    si_unit = NOTATION[name].unit if name in NOTATION else "1"
    return f"{exact(sd * display_unit(si_unit)[0], 3)} {unit_text(si_unit)}".rstrip()
