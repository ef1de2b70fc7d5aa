"""What is said of a craft that does not hold a straight course by itself: how fast it leaves one, and what follows."""

import math

from seatrial.core.results import Fit, Stability
from seatrial.core.results.fit import COURSE_UNSTABLE
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import sentence
from seatrial.reporting.first_screen import KeyFact
from seatrial.reporting.section import Level, Section


def unstable_course(fit: Fit) -> Stability | None:
    """Return the course stability of a fit whose craft is course unstable beyond its interval; None of all others."""
    course = fit.identifiability.stability if fit.identifiability else None
    return course if course is not None and course.is_unstable else None


def growth_time(course: Stability) -> float:
    """Return the time [s] in which a deviation of an unstable craft grows by a factor e; infinite where not known."""
    rate = course.growth_rate
    return 1.0 / rate if rate is not None and rate > 0.0 else math.inf


def growth_clause(course: Stability) -> str:
    """Return that the craft is course unstable and how fast: ``course unstable, a deviation grows e-fold in 1.5 s``."""
    seconds = growth_time(course)
    if not math.isfinite(seconds):
        return "course unstable"
    low, high = course.growth_lower, course.growth_upper
    ends = f" [{significant(1.0 / high, 2)}, {significant(1.0 / low, 2)}]" if low and high and low > 0.0 else ""
    return f"course unstable: a deviation grows by a factor e in {significant(seconds, 2)} s{ends}"


def course_facts(fit: Fit) -> tuple[KeyFact, ...]:
    """Return the row that says the craft does not hold a straight course; no row where it may."""
    course = unstable_course(fit)
    if course is None:
        return ()
    speed = f" at {significant(course.speed, 2)} m/s" if course.speed is not None else ""
    if course.stable_below is not None:
        speed += f", course stable below about {significant(course.stable_below, 2)} m/s"
    return (KeyFact("Straight course", f"{growth_clause(course)}{speed}", "identifiability"),)


def course_section(fit: Fit) -> Section:
    """Return the chapter on whether the craft holds a straight course; empty where that is not known."""
    course = fit.identifiability.stability if fit.identifiability else None
    if course is None:
        return Section("")
    turns = [f.evidence.partition("; ")[2] for f in fit.findings if f.code == COURSE_UNSTABLE]
    index = f"{significant(course.index, 2)} [{significant(course.lower, 2)}, {significant(course.upper, 2)}]"
    craft = "craft with equal orders of its thrusters" if fit.model.has_thrusters else "ship with the rudder amidships"
    return Section(
        "Straight course",
        "course",
        sentences=tuple(sentence(text) for text in (course.text, *turns) if text),
        note=f"Index of straight-line stability, C = {index}: positive where a {craft} returns to a straight course.",
        level=Level.DETAIL,
        is_folded=True,
    )
