"""How far a run leaves the training runs, in words."""

import math
from collections.abc import Sequence

from seatrial.core.results import Extrapolation
from seatrial.core.text.numbers import ratio_text
from seatrial.core.text.words import enumeration

# index up to which a run lies inside the training runs, and up to which at their edge
INSIDE_INDEX, EDGE_INDEX = 1.05, 1.2
_EXTRAPOLATION_CLAUSES = {
    "yaw_rate": ("turns {} times as fast as", "{} times the yaw rate"),
    "drift": ("drifts at {} times the angle of", "{} times the drift angle"),
    "rudder": ("uses {} times the rudder of", "{} times the rudder"),
    "speed": ("goes {} times as fast as", "{} times the speed"),
}


def extrapolation_zone(index: float) -> str:
    """Return where a run lies: inside the training runs, at their edge, or beyond; empty where that is not known."""
    if math.isnan(index):
        return ""
    if index <= INSIDE_INDEX:
        return "inside"
    return "edge" if index <= EDGE_INDEX else "beyond"


def extrapolation_text(e: Extrapolation) -> str:
    """Return how far a run leaves the training runs, and how to read its intervals."""
    index = ratio_text(e.index)
    if extrapolation_zone(e.index) == "inside":
        return f"{index}: the run stays inside what the training runs covered."
    outside = sorted((item for item in e.ratios.items() if item[1] > INSIDE_INDEX), key=lambda item: -item[1])
    clause = _extrapolation_clause(outside) if outside else "the run goes beyond the training runs"
    if extrapolation_zone(e.index) == "edge":
        return f"{index}: {clause}, just beyond their edge."
    return f"{index}: {clause}. Read its intervals as lower limits."


def _extrapolation_clause(outside: Sequence[tuple[str, float]]) -> str:
    """The first ratio as a clause, the others after it."""
    clauses = [_EXTRAPOLATION_CLAUSES.get(name, (f"reaches in {name} {{}} times", f"{{}} times in {name}"))
               for name, _ in outside]  # fmt: skip
    ratios = [ratio_text(ratio) for _, ratio in outside]
    further = [clause[1].format(ratio) for clause, ratio in zip(clauses[1:], ratios[1:], strict=True)]
    tail = f", with {enumeration(further)}" if further else ""
    return f"the run {clauses[0][0].format(ratios[0])} any training run{tail}"
