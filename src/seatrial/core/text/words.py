"""Words for names and numbers: measures, channels, what correlations say."""

import math
import re
from collections.abc import Sequence

import numpy as np

from seatrial.core.results import Extrapolation, Measure
from seatrial.core.text.numbers import fixed, significant
from seatrial.core.values import Array, display_unit
from seatrial.core.values.arrays import correlation_matrix
from seatrial.core.values.notation import NOTATION

_MEASURES = {
    "rudder_deg": ("rudder angle", "deg"),
    "approach_speed": ("approach speed", "m/s"),
    "advance_L": ("advance", "L"),
    "transfer_L": ("transfer", "L"),
    "tactical_diameter_L": ("tactical diameter", "L"),
    "steady_diameter_L": ("steady turning diameter", "L"),
    "steady_yaw_rate_deg_s": ("steady yaw rate", "deg/s"),
    "steady_drift_deg": ("steady drift angle", "deg"),
    "speed_loss": ("speed lost in the turn, share of approach speed", ""),
    "time_90_s": ("time to 90° change of heading", "s"),
    "initial_turning_time_s": ("initial turning time", "s"),
    "initial_turning_L": ("initial turning, distance", "L"),
    "period_s": ("period", "s"),
}
_UNIT_ENDINGS = (("_deg_s", "deg/s"), ("_deg", "deg"), ("_L", "L"), ("_s", "s"))
STRONG_CORRELATION = 0.9
INSIDE_INDEX, EDGE_INDEX = 1.05, 1.2
EXTRA_DECIMALS = 2


def measure_label(name: str) -> tuple[str, str]:
    """Name and unit of a manoeuvring measure: ``overshoot_1_deg`` -> 1st overshoot, deg."""
    if name in _MEASURES:
        return _MEASURES[name]
    overshoot = re.fullmatch(r"overshoot_(\d+)_deg", name)
    if overshoot:
        return f"{ordinal(int(overshoot[1]))} overshoot", "deg"
    for ending, unit in _UNIT_ENDINGS:
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def measure_decimals(unit: str, m: Measure) -> int:
    """Decimals of a measure in that unit, so many that two digits of its interval's width are seen."""
    usual = {"deg": 1, "L": 2, "s": 1, "m/s": 3, "deg/s": 2}.get(unit, 3)
    width = m.upper - m.lower if m.upper is not None and m.lower is not None else 0.0
    if not 0.0 < width < math.inf:
        return usual
    return min(usual + EXTRA_DECIMALS, max(usual, 1 - math.floor(math.log10(width))))


def is_inside(m: Measure) -> bool | None:
    """Whether the measured value lies in the interval; None where one of them is not known."""
    if m.measured is None or m.lower is None or m.upper is None:
        return None
    return m.lower <= m.measured <= m.upper


def ordinal(number: int) -> str:
    """1st, 2nd, 3rd, 4th, … 11th, 21st."""
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def channel_meaning(name: str) -> str:
    """What a channel is: ``psi`` -> heading."""
    return NOTATION[name].meaning if name in NOTATION else name


def unit_text(si: str) -> str:
    """The unit people read, empty for numbers."""
    shown = display_unit(si)[1]
    return "" if shown == "1" else shown.replace("^2", "²").replace("^3", "³")


def enumeration(items: Sequence[str], max_items: int = 6) -> str:
    """a, b and c; from `most` on: a, b, c and 5 more."""
    if len(items) > max_items:
        return f"{', '.join(items[: max_items - 1])} and {len(items) - max_items + 1} more"
    return " and ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def counted(number: int, noun: str) -> str:
    """1 run, 2 runs, no runs."""
    return f"{number or 'no'} {noun}{'' if number == 1 else 's'}"


def sentence(text: str, names: Sequence[str] = ()) -> str:
    """The text with a capital and a full stop; a text that begins with one of the `names` keeps its letter."""
    first = re.split(r"[\s,;:]", text, maxsplit=1)[0]
    is_word = first.isalpha() and len(first) > 1 and first not in names
    begun = text[:1].upper() + text[1:] if is_word or first in ("a", "A") else text
    return begun if not begun or begun.endswith((".", "!", "?")) else f"{begun}."


def signed_percent(share: float) -> str:
    """+12 %, −0.8 %."""
    if not math.isfinite(share):
        return "without limit"
    return f"{'+' if share > 0 else ''}{significant(100.0 * share, 2)} %"


def interval(lower: float | None, upper: float | None, decimals: int) -> str:
    """``[2.83, 3.27]``; empty without both ends."""
    if lower is None or upper is None or not math.isfinite(lower + upper):
        return ""
    return f"[{fixed(lower, decimals)}, {fixed(upper, decimals)}]"


_EXTRAPOLATION_CLAUSES = {
    "yaw_rate": ("turns {} times as fast as", "{} times the yaw rate"),
    "drift": ("drifts at {} times the angle of", "{} times the drift angle"),
    "rudder": ("uses {} times the rudder of", "{} times the rudder"),
    "speed": ("goes {} times as fast as", "{} times the speed"),
}


def extrapolation_zone(index: float) -> str:
    """Where a run lies: inside the training runs, at their edge, or beyond; empty where that is not known."""
    if math.isnan(index):
        return ""
    if index <= INSIDE_INDEX:
        return "inside"
    return "edge" if index <= EDGE_INDEX else "beyond"


def ratio_text(ratio: float) -> str:
    """A ratio with two digits, ∞ where there is no bound."""
    return "∞" if math.isinf(ratio) else significant(ratio, 2)


def extrapolation_text(e: Extrapolation) -> str:
    """How far a run leaves the training runs, and how to read its intervals."""
    index = ratio_text(e.index)
    if extrapolation_zone(e.index) == "inside":
        return f"{index}: the run stays inside what the training runs covered."
    outside = sorted((item for item in e.ratios.items() if item[1] > INSIDE_INDEX), key=lambda item: -item[1])
    how = _extrapolation_clause(outside) if outside else "the run goes beyond the training runs"
    if extrapolation_zone(e.index) == "edge":
        return f"{index}: {how}, just beyond their edge."
    return f"{index}: {how}. Read its intervals as lower limits."


def _extrapolation_clause(outside: Sequence[tuple[str, float]]) -> str:
    """The first ratio as a clause, the others after it."""
    told = [
        (
            _EXTRAPOLATION_CLAUSES.get(name, (f"reaches in {name} {{}} times", f"{{}} times in {name}")),
            ratio_text(ratio),
        )
        for name, ratio in outside
    ]
    (clause, _), first = told[0]
    others = [also.format(ratio) for (_, also), ratio in told[1:]]
    return f"the run {clause.format(first)} any training run" + (f", with {enumeration(others)}" if others else "")


def prefix_note(prefix: str) -> str:
    """A sentence for captions whose names are shortened."""
    return f" Names without their common beginning, {prefix}" if prefix else ""


def correlation_text(names: Sequence[str], covariance: Array) -> str:
    """Which coefficients the records hardly tell apart."""
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return ""
    matrix = np.nan_to_num(np.tril(correlation_matrix(covariance), k=-1))
    order = np.argsort(-np.abs(matrix), axis=None)
    pairs = [(int(i // len(names)), int(i % len(names))) for i in order[:4]]
    strong = [(i, j) for i, j in pairs if abs(matrix[i, j]) >= STRONG_CORRELATION]
    count = int(np.sum(np.abs(matrix) >= STRONG_CORRELATION))
    if not strong:
        i, j = pairs[0]
        if i == j:
            return "None is correlated with another."
        return f"The strongest is {fixed(matrix[i, j], 2)}, between {names[i]} and {names[j]}."
    told = enumeration([f"{names[i]} and {names[j]} ({fixed(matrix[i, j], 2)})" for i, j in strong])
    return (
        f"{counted(count, 'pair').capitalize()} at {STRONG_CORRELATION} or above in size; the strongest: "
        f"{told}. The records "
        "determine such coefficients mainly together: take them as a set, not one by one."
    )
