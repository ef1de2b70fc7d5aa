"""A designed manoeuvre in sentences: how much better it is, on how many ships, and what was asked for."""

import math

import numpy as np

from seatrial.core.results import Actuator, Design, ManoeuvrePrecision
from seatrial.core.results.design_ranking import (
    best_baseline,
    count_outside_limits,
    criterion_error,
    has_track,
    is_within_limits,
    sampled_criterion_errors,
)
from seatrial.core.text.numbers import duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import NOTATION, display_unit
from seatrial.core.values.channel_text import unit_text
from seatrial.data.folder.orders import channel_display_unit

LARGEST_SHOWN_ERROR = 100.0
_CRITERION_NAMES = {"worst": "worst relative standard error", "mean": "mean relative standard error"}


def sentences(design: Design) -> list[str]:
    """The answer: the design beside the best standard manoeuvre, other ships, simulated trials, limits."""
    told = [_comparison(design), _prior_draws(design), _confirmation(design), _limits(design)]
    return [sentence for sentence in told if sentence]


def _percent(share: float) -> str:
    return (
        f"{significant(100.0 * share, 2)} %"
        if share < LARGEST_SHOWN_ERROR
        else f"more than {significant(100.0 * LARGEST_SHOWN_ERROR, 1)} %"
    )


def _weakest_coefficient(manoeuvre: ManoeuvrePrecision, design: Design) -> str:
    if design.criterion != "worst" or not np.isfinite(manoeuvre.relative_error).any():
        return ""
    return f" ({design.coefficients[int(np.argmax(manoeuvre.relative_error))]})"


def _comparison(design: Design) -> str:
    best, criterion = best_baseline(design), design.criterion
    found = criterion_error(design.designed, criterion)
    begin = f"The {_CRITERION_NAMES[criterion]} is {_percent(found)}{_weakest_coefficient(design.designed, design)}"
    if best is None:
        return f"{begin}; there is no standard manoeuvre to compare it with."
    theirs = criterion_error(best, criterion)
    against = (
        f"{_percent(theirs)}{_weakest_coefficient(best, design)} with the best standard manoeuvre of "
        f"equal length, {best.name}"
    )
    if not is_within_limits(best, design.limits):
        against += ", which leaves the limits"
    if found >= theirs:
        return f"{begin}, no better than the {against}."
    ratio = f" ({significant(theirs / found, 2)} times as much)" if theirs < LARGEST_SHOWN_ERROR else ""
    return f"{begin} against {against}{ratio}."


def _prior_draws(design: Design) -> str:
    """On how many of the drawn ships it beats every standard manoeuvre."""
    own = sampled_criterion_errors(design.designed, design.criterion)
    if not own:
        return ""
    within = [rival for rival in design.baselines if is_within_limits(rival, design.limits)]
    others = [sampled_criterion_errors(rival, design.criterion) for rival in within or design.baselines]
    wins = sum(all(not ours >= theirs[k] for theirs in others) for k, ours in enumerate(own) if not math.isnan(ours))
    known = [x for x in own if not math.isnan(x)]
    reach = f"from {_percent(min(known))} to {_percent(max(known))}" if known else "not known"
    told = f"On {counted(len(own), 'ship')} drawn from the prior it is {reach}"
    if others:
        which = "any standard manoeuvre within the limits" if _has_limits(design) else "any standard manoeuvre"
        told += f", smaller than with {which} on {wins} of {len(own)}"
    lost = design.designed.diverged
    return told + (f"; {counted(lost, 'ship')} cannot be simulated." if lost else ".")


def _has_limits(design: Design) -> bool:
    return math.isfinite(design.limits.drift) or math.isfinite(design.limits.sea_room)


def _confirmation(design: Design) -> str:
    known = design.confirmation
    if known is None:
        return ""
    told = f"{known.converged_runs} of {counted(known.runs, 'simulated trial')} could be fitted"
    ratios = known.error / known.bound
    ratios = ratios[np.isfinite(ratios)]
    if not ratios.size:
        return f"{told}."
    reach = " to ".join(fixed(float(end), 2) for end in (ratios.min(), ratios.max()))
    return f"{told}; their errors are {reach} of those foretold."


def _limits(design: Design) -> str:
    limits, worth = design.limits, design.designed
    told: list[str] = []
    if not has_track(design):
        return ""
    if math.isfinite(limits.drift):
        told.append(f"a drift angle of {_degrees(worth.drift)} ({_degrees(limits.drift)} allowed)")
    if math.isfinite(limits.sea_room):
        told.append(f"{significant(worth.distance)} m from the start ({significant(limits.sea_room)} m allowed)")
    if not told:
        return ""
    verb = "reaches" if is_within_limits(worth, limits) else "leaves the limits: she reaches"
    straying = count_outside_limits(worth, limits)
    others = f"; {straying} of {len(worth.sampled_relative_error)} drawn ships leave the limits" if straying else ""
    return f"The ship as assumed {verb} at most {enumeration(told)}{others}."


def _degrees(angle: float) -> str:
    return f"{fixed(math.degrees(angle), 1)}°"


def facts(design: Design) -> list[tuple[str, str]]:
    """What was asked for."""
    made = [
        ("Ship", design.ship),
        ("Model", design.model.name),
        ("Duration", duration(design.duration)),
        ("Steered with", "; ".join(actuator_text(a) for a in design.actuators)),
    ]
    allowed = [f"drift angle {_degrees(design.limits.drift)}"] if math.isfinite(design.limits.drift) else []
    allowed += [f"{exact(design.limits.sea_room)} m from the start"] if math.isfinite(design.limits.sea_room) else []
    return [*made, ("Limits", ", ".join(allowed) or "none")]


def actuator_text(a: Actuator) -> str:
    """``delta −35 to 35 deg, 10 deg/s, orders 6 s apart at least``."""
    factor, shown = channel_display_unit(a.name)
    rate = f"{exact(a.rate * factor)} {shown}/s" if math.isfinite(a.rate) else "may jump"
    reach = f"{exact(a.lower * factor)} to {exact(a.upper * factor)} {'' if shown == '1' else shown}".rstrip()
    return f"{a.name} {reach}, {rate}, orders {exact(a.hold)} s apart at least"


def settings(design: Design) -> list[tuple[str, str]]:
    """How it was made."""
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
