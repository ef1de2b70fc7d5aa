"""Held-out runs of a kind of manoeuvre that no training run shows: predictions of them are extrapolations."""

from collections.abc import Sequence

from seatrial.core.results import Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, Severity

_MOST_RUNS = 3  # names that a message holds; chosen


def untrained_manoeuvre_findings(predictions: Sequence[Prediction]) -> tuple[Finding, ...]:
    """Return a warning `untrained-manoeuvre` for each kind that was held out and never fitted."""
    of_kind = dict[str, list[str]]()
    for p in predictions:
        if p.role == "validation" and p.extrapolation is not None and p.extrapolation.untrained_kind:
            of_kind.setdefault(p.extrapolation.untrained_kind, []).append(p.record)
    return tuple(
        Finding(
            Severity.WARNING, "untrained-manoeuvre", f"no training run is a {kind.replace('-', ' ')}",
            f"held out: {enumeration(names, _MOST_RUNS)}",
            "their bands are extrapolations, calibrated by other manoeuvres: read them as lower limits, or train a "
            f"{kind.replace('-', ' ')}",
        )
        for kind, names in of_kind.items()
    )  # fmt: skip
