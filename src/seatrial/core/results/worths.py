"""Manoeuvres compared: what a worth is over the ships drawn from the prior, and which standard one is best."""

import math

import numpy as np

from seatrial.core.results.design import Design, Limits, Worth

ROUNDING = 1e-6


def error_of(worth: Worth, criterion: str) -> float:
    """The relative standard error that the criterion ``worst`` or ``mean`` looks at."""
    return worth.worst if criterion == "worst" else worth.mean


def drawn_errors(worth: Worth, criterion: str) -> list[float]:
    """The same for each ship drawn from the prior; NaN where the simulation diverges."""
    if criterion == "worst":
        return [float(row.max()) for row in worth.drawn]
    return [float((row**2).mean() ** 0.5) for row in worth.drawn]


def worst_drawn(worth: Worth) -> float:
    """Largest relative standard error over all drawn ships that do not diverge; NaN where there is none."""
    known = worth.drawn[~np.isnan(worth.drawn).any(axis=1)] if worth.drawn.size else worth.drawn
    return float(known.max()) if known.size else math.nan


def diverged(worth: Worth) -> int:
    """How many of the drawn ships the simulation loses."""
    return sum(bool(np.isnan(row).any()) for row in worth.drawn)


def ranked(design: Design) -> tuple[Worth, ...]:
    """The standard manoeuvres: those within the limits before the others, the smaller error first."""
    return tuple(sorted(design.rivals, key=lambda w: (not keeps(w, design.limits), error_of(w, design.criterion))))


def best_rival(design: Design) -> Worth | None:
    """The best standard manoeuvre within the design's limits, or of all where none is; None where none was tried."""
    return next(iter(ranked(design)), None)


def keeps(worth: Worth, limits: Limits) -> bool:
    """Whether drift angle and distance stay within the limits for the ships these bind."""
    own = worth.drift <= limits.drift * (1.0 + ROUNDING) and worth.room <= limits.room * (1.0 + ROUNDING)
    return own and not (limits.for_every_ship and leaving(worth, limits))


def leaving(worth: Worth, limits: Limits) -> int:
    """How many of the drawn ships leave the limits."""
    beyond = worth.drawn_drift > limits.drift * (1.0 + ROUNDING)
    return int(np.sum(beyond | (worth.drawn_room > limits.room * (1.0 + ROUNDING))))


def has_track(design: Design) -> bool:
    """Whether the ship goes somewhere, so that drift angle and distance mean something."""
    return {"x0", "y0"} <= set(design.designed.executed.channels) and design.designed.room > 0.0
