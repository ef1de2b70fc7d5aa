"""Manoeuvres compared under the criterion and limits of a design."""

import numpy as np

from seatrial.core.results.design import Design, TrialLimits
from seatrial.core.results.manoeuvre_precision import ManoeuvrePrecision

ROUNDING = 1e-6
"""Relative excess of a limit that counts as kept, 1: what the rounding of orders can add."""


def criterion_error(manoeuvre: ManoeuvrePrecision, criterion: str) -> float:
    """Return the relative standard error that the criterion ``worst`` or ``mean`` compares."""
    return manoeuvre.worst if criterion == "worst" else manoeuvre.mean


def sampled_criterion_errors(manoeuvre: ManoeuvrePrecision, criterion: str) -> list[float]:
    """Return the same for each ship drawn from the prior; NaN where the simulation diverges."""
    if criterion == "worst":
        return [float(row.max()) for row in manoeuvre.sampled_relative_error]
    return [float((row**2).mean() ** 0.5) for row in manoeuvre.sampled_relative_error]


def ranked_baselines(design: Design) -> tuple[ManoeuvrePrecision, ...]:
    """Return the standard manoeuvres: those within the limits before the others, the smaller error first."""
    return tuple(
        sorted(
            design.baselines,
            key=lambda m: (not is_within_limits(m, design.limits), criterion_error(m, design.criterion)),
        )
    )


def best_baseline(design: Design) -> ManoeuvrePrecision | None:
    """Return the best standard manoeuvre within the limits, or of all where none is; None where none was tried."""
    return next(iter(ranked_baselines(design)), None)


def is_within_limits(manoeuvre: ManoeuvrePrecision, limits: TrialLimits) -> bool:
    """Return whether drift angle and distance stay within the limits for the ships that these bind."""
    assumed_ship = manoeuvre.drift <= limits.drift * (1.0 + ROUNDING) and manoeuvre.distance <= limits.sea_room * (
        1.0 + ROUNDING
    )
    return assumed_ship and not (limits.for_every_ship and count_outside_limits(manoeuvre, limits))


def count_outside_limits(manoeuvre: ManoeuvrePrecision, limits: TrialLimits) -> int:
    """Return the number of drawn ships that leave the limits."""
    beyond = manoeuvre.sampled_drift > limits.drift * (1.0 + ROUNDING)
    return int(np.sum(beyond | (manoeuvre.sampled_distance > limits.sea_room * (1.0 + ROUNDING))))


def has_track(design: Design) -> bool:
    """Return whether the ship changes its place, so that drift angle and distance mean something."""
    return {"x0", "y0"} <= set(design.designed.executed.channels) and design.designed.distance > 0.0
