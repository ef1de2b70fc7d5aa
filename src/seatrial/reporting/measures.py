"""Measures of manoeuvres in words and units, and the course stability of a craft."""

import math
import re
from collections.abc import Sequence
from enum import StrEnum

from seatrial.core.results import CraftMeasure, Extrapolation, Fit, Measure, Stability
from seatrial.core.results.fit import COURSE_UNSTABLE
from seatrial.core.text.numbers import EstimateText, estimate_text, exponent, fixed, ratio_text, significant
from seatrial.core.text.words import counted, enumeration, ordinal, sentence
from seatrial.reporting.section import KeyFact, Level, Section

# Manoeuvring measures and extrapolation in words: names, units and digits; how far a run leaves the training runs.

_MEASURED_TRACK, _SIMULATED_TRACK = "over ground", "in still water"
"""What distances of a run refer to: whatever current there was is in those of a measured one."""
_MEASURES = {
    "rudder_deg": ("rudder angle", "deg"),
    "approach_speed": ("approach speed", "m/s"),
    "advance_L": (f"advance {_MEASURED_TRACK}", "L"),
    "transfer_L": (f"transfer {_MEASURED_TRACK}", "L"),
    "tactical_diameter_L": (f"tactical diameter {_MEASURED_TRACK}", "L"),
    "steady_diameter_L": ("steady turning diameter, 2 U/r", "L"),
    "steady_yaw_rate_deg_s": ("steady yaw rate", "deg/s"),
    "steady_drift_deg": ("steady drift angle", "deg"),
    "steady_heel_deg": ("steady heel out of the turn", "deg"),
    "speed_loss": ("speed lost in the turn, share of approach speed", ""),
    "time_90_s": ("time to 90° change of heading", "s"),
    "initial_turning_time_s": ("initial turning time", "s"),
    "initial_turning_L": ("initial turning, distance", "L"),
    "period_s": ("period", "s"),
}
_UNIT_ENDINGS = (("_deg_s", "deg/s"), ("_deg", "deg"), ("_L", "L"), ("_s", "s"))
# decimals by unit, and how many more an interval may demand
_DECIMALS = {"deg": 1, "L": 2, "s": 1, "m/s": 3, "deg/s": 2}
EXTRA_DECIMALS = 2


def measure_label(name: str) -> tuple[str, str]:
    """Return name and unit of a manoeuvring measure: ``overshoot_1_deg`` -> 1st overshoot, deg."""
    if name in _MEASURES:
        return _MEASURES[name]
    numbered = re.fullmatch(r"(overshoot|heel)_(\d+)_deg", name)
    if numbered:
        count = ordinal(int(numbered[2]))
        return f"largest heel, {count} turn" if numbered[1] == "heel" else f"{count} overshoot", "deg"
    for ending, unit in _UNIT_ENDINGS:
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def simulated_measure_label(name: str) -> tuple[str, str]:
    """Return `measure_label` of a manoeuvre that was steered through a model: its distances are in still water."""
    label, unit = measure_label(name)
    return label.replace(_MEASURED_TRACK, _SIMULATED_TRACK), unit


def current_words(speed: float | None) -> str:
    """Return what distances of a measured run refer to; speed: m/s of the current they are corrected for, or None."""
    if speed is None:
        return _MEASURED_TRACK
    return f"corrected for the estimated current of {fixed(speed, 2)} m/s"


def bare_measure_label(name: str) -> tuple[str, str]:
    """Return `measure_label` without what a distance refers to, where another line says that."""
    label, unit = measure_label(name)
    return label.removesuffix(f" {_MEASURED_TRACK}"), unit


def corrected_measure_label(name: str, speed: float | None) -> tuple[str, str]:
    """Return `measure_label` of a run that is corrected for an estimated current [m/s], or of one that is not: None."""
    label, unit = measure_label(name)
    return (label if speed is None else label.replace(f" {_MEASURED_TRACK}", f", {current_words(speed)}")), unit


def manoeuvre_name(text: str) -> str:
    """Return a manoeuvre as people call it: ``zigzag:20/10:port`` -> zigzag 20°/10°, first to port.

    Turns without a side are to starboard, as the programmes have it.
    """
    kind, *rest = text.split(":")
    side = rest.pop() if rest and rest[-1] in ("port", "starboard") else ""
    angles = rest[0] if rest else ""
    if kind == "zigzag" and re.fullmatch(r"[\d.]+/[\d.]+", angles):
        return f"zigzag {angles.replace('/', '°/')}°" + (f", first to {side}" if side else "")
    if kind == "turning-circle" and angles:
        return f"turning circle with {angles}° to {side or 'starboard'}"
    if kind == "pull-out" and angles:
        return f"pull-out from {angles}° to {side or 'starboard'}"
    if kind == "consecutive-zigzags" and angles:
        return f"consecutive zigzags, {counted(int(angles), 'execute')} each"
    if kind == "prbs" and len(rest) == 3:
        share, hold, seed = rest
        return f"random steps (PRBS), {share.replace('%', ' %')} of the range, {hold} at least, seed {seed}"
    return text.replace("-", " ").replace(":", " ")


def measure_decimals(unit: str, m: Measure) -> int:
    """Return the decimals of a measure in that unit, enough for two digits of its interval's width."""
    usual = _DECIMALS.get(unit, 3)
    width = m.upper - m.lower if m.upper is not None and m.lower is not None else 0.0
    if not 0.0 < width < math.inf:
        return usual
    return min(usual + EXTRA_DECIMALS, max(usual, 1 - math.floor(math.log10(width))))


class IntervalVerdict(StrEnum):
    """Where a measured value lies; an interval that holds whatever a ship may do is not tested by it."""

    INSIDE = "inside"
    OUTSIDE = "outside"
    TOO_WIDE = "too wide to test"
    UNKNOWN = ""


# half width of an interval over the value from which on it tests nothing; chosen
TOO_WIDE_SHARE = 0.5
# unit -> least size of the value for that: of first overshoots, diameters and lost speeds of ships; chosen
_USUAL_SIZE = {"deg": 10.0, "L": 2.0, "": 1.0}


def interval_verdict(name: str, m: Measure) -> IntervalVerdict:
    """Return where the measured value lies in the interval, and whether that says anything.

    Too wide to test is an interval whose half width is more than half of the value: of the larger one, measured or
    predicted, and for angles, ship lengths and shares of at least 10 degrees, 2 L and 1.
    """
    if not m.is_determined or m.measured is None or m.lower is None or m.upper is None:
        return IntervalVerdict.UNKNOWN
    if not m.lower <= m.measured <= m.upper:
        return IntervalVerdict.OUTSIDE
    size = max(abs(m.measured), abs(m.simulated or 0.0), _USUAL_SIZE.get(measure_label(name)[1], 0.0))
    is_wide = 0.5 * (m.upper - m.lower) > TOO_WIDE_SHARE * size
    return IntervalVerdict.TOO_WIDE if is_wide else IntervalVerdict.INSIDE


NOT_DETERMINED = "not determined"
# index up to which a run lies inside the training runs, and up to which at their edge
INSIDE_INDEX, EDGE_INDEX = 1.05, 1.2
_COMMAND = "command "  # what names of a thruster's ranges begin with (`estimation.information.extrapolation`)
_EXTRAPOLATION_CLAUSES = {
    "yaw_rate": ("turns {} times as fast as", "{} times the yaw rate"),
    "drift": ("drifts, as the model has it, at {} times the angle of", "{} times the modelled drift angle"),
    "rudder": ("uses {} times the rudder of", "{} times the rudder"),
    "rudder to port": ("uses more rudder to port than", "more rudder to port"),
    "rudder to starboard": ("uses more rudder to starboard than", "more rudder to starboard"),
    "roll": ("rolls {} times as far as", "{} times the roll angle"),
    "heave": ("heaves {} times as far as", "{} times the heave"),
    "pitch": ("pitches {} times as far as", "{} times the pitch angle"),
    "elevation": ("meets waves {} times as high as", "{} times the height of the waves"),
    "fastest": ("goes {} times as fast as", "{} times the highest speed"),
    "slowest": ("slows to 1/{} of the lowest speed of", "1/{} of the lowest speed"),
}


def extrapolation_zone(index: float) -> str:
    """Return where a run lies: inside the training runs, at their edge, or beyond; empty where that is not known."""
    if math.isnan(index):
        return ""
    if index <= INSIDE_INDEX:
        return "inside"
    return "edge" if index <= EDGE_INDEX else "beyond"


def is_extrapolated(m: CraftMeasure) -> bool:
    """Return whether what a craft does at full command lies beyond the training runs."""
    return m.extrapolation_index is not None and m.extrapolation_index > EDGE_INDEX


def craft_estimate(m: CraftMeasure) -> EstimateText:
    """Return a measure at full command with its interval; beyond the training runs in three digits at most."""
    error = None if m.lower is None or m.upper is None else 0.5 * (m.upper - m.lower)
    if error is not None and is_extrapolated(m) and m.value != 0.0:
        error = max(error, 10.0 ** (exponent(m.value, 1) - 1))  # two digits of it are three of the value
    return estimate_text(m.value, error, m.lower, m.upper)


def extrapolation_text(e: Extrapolation) -> str:
    """Return how far a run leaves the training runs, and how to read its intervals."""
    index = ratio_text(e.index)
    if e.untrained_kind:
        kind = e.untrained_kind.replace("-", " ")
        return f"{index}; no training run is a {kind}: this one is extrapolated. Read its intervals as lower limits."
    if extrapolation_zone(e.index) == "inside":
        return f"{index}: the run stays inside what the training runs covered."
    outside = sorted((item for item in e.ratios.items() if item[1] > INSIDE_INDEX), key=lambda item: -item[1])
    clause = _extrapolation_clause(outside) if outside else "the run goes beyond the training runs"
    if extrapolation_zone(e.index) == "edge":
        return f"{index}: {clause}, just beyond their edge."
    return f"{index}: {clause}. Read its intervals as lower limits."


def _command_clause(name: str) -> tuple[str, str]:
    """``command port ahead, moving astern``: a thruster, the direction of its thrust and that of the water."""
    text = name.removeprefix(_COMMAND)
    return f"commands {text}, further than", f"commands of {text} beyond theirs"


def _extrapolation_clause(outside: Sequence[tuple[str, float]]) -> str:
    """The first ratio as a clause, the others after it; of commands the one farthest out."""
    commands = [name for name, _ in outside if name.startswith(_COMMAND)]
    outside = [(name, ratio) for name, ratio in outside if name not in commands[1:]]
    clauses = [_command_clause(name) if name in commands else
               _EXTRAPOLATION_CLAUSES.get(name, (f"reaches in {name} {{}} times", f"{{}} times in {name}"))
               for name, _ in outside]  # fmt: skip
    ratios = [ratio_text(ratio) for _, ratio in outside]
    further = [clause[1].format(ratio) for clause, ratio in zip(clauses[1:], ratios[1:], strict=True)]
    tail = f", with {enumeration(further)}" if further else ""
    return f"the run {clauses[0][0].format(ratios[0])} any training run{tail}"


# What is said of a craft that does not hold a straight course by itself: how fast it leaves one, and what follows.


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
