"""Manoeuvres compared: what a worth is over the ships drawn from the prior, and which standard one is best."""

import math

import numpy as np

from seatrial.core.results.design import Design, ManoeuvrePrecision, TrialLimits

ROUNDING = 1e-6


def criterion_error(manoeuvre: ManoeuvrePrecision, criterion: str) -> float:
    """The relative standard error that the criterion ``worst`` or ``mean`` looks at."""
    return manoeuvre.worst if criterion == "worst" else manoeuvre.mean


def sampled_criterion_errors(manoeuvre: ManoeuvrePrecision, criterion: str) -> list[float]:
    """The same for each ship drawn from the prior; NaN where the simulation diverges."""
    if criterion == "worst":
        return [float(row.max()) for row in manoeuvre.sampled_relative_error]
    return [float((row**2).mean() ** 0.5) for row in manoeuvre.sampled_relative_error]


def worst_sampled_error(manoeuvre: ManoeuvrePrecision) -> float:
    """Largest relative standard error over all drawn ships that do not diverge; NaN where there is none."""
    known = (
        manoeuvre.sampled_relative_error[~np.isnan(manoeuvre.sampled_relative_error).any(axis=1)]
        if manoeuvre.sampled_relative_error.size
        else manoeuvre.sampled_relative_error
    )
    return float(known.max()) if known.size else math.nan


def count_diverged(manoeuvre: ManoeuvrePrecision) -> int:
    """How many of the drawn ships the simulation loses."""
    return sum(bool(np.isnan(row).any()) for row in manoeuvre.sampled_relative_error)


def ranked_baselines(design: Design) -> tuple[ManoeuvrePrecision, ...]:
    """The standard manoeuvres: those within the limits before the others, the smaller error first."""
    return tuple(
        sorted(
            design.baselines,
            key=lambda w: (not is_within_limits(w, design.limits), criterion_error(w, design.criterion)),
        )
    )


def best_baseline(design: Design) -> ManoeuvrePrecision | None:
    """The best standard manoeuvre within the design's limits, or of all where none is; None where none was tried."""
    return next(iter(ranked_baselines(design)), None)


def is_within_limits(manoeuvre: ManoeuvrePrecision, limits: TrialLimits) -> bool:
    """Whether drift angle and distance stay within the limits for the ships these bind."""
    own = manoeuvre.drift <= limits.drift * (1.0 + ROUNDING) and manoeuvre.distance <= limits.sea_room * (
        1.0 + ROUNDING
    )
    return own and not (limits.for_every_ship and count_outside_limits(manoeuvre, limits))


def count_outside_limits(manoeuvre: ManoeuvrePrecision, limits: TrialLimits) -> int:
    """How many of the drawn ships leave the limits."""
    beyond = manoeuvre.sampled_drift > limits.drift * (1.0 + ROUNDING)
    return int(np.sum(beyond | (manoeuvre.sampled_distance > limits.sea_room * (1.0 + ROUNDING))))


def has_track(design: Design) -> bool:
    """Whether the ship goes somewhere, so that drift angle and distance mean something."""
    return {"x0", "y0"} <= set(design.designed.executed.channels) and design.designed.distance > 0.0
