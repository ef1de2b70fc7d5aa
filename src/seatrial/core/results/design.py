"""A designed manoeuvre: the request, the orders, and its precision compared with standard manoeuvres."""

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import (
    ListedArray,
    NamedModel,
    Number,
    ReportedFinding,
    StoredRecord,
    StoredSolution,
    Summarised,
    Summary,
    named_by,
)
from seatrial.core.values import Array

BY_COEFFICIENT = named_by("coefficients")


@dataclass(frozen=True, eq=False)
class ManoeuvrePrecision:
    """Standard errors, over the magnitude of the coefficients, that a manoeuvre of the trial's duration gives."""

    name: Annotated[str, Field(description="designed, zigzag:20/20, prbs:35:10 and the like")]
    relative_error: Annotated[
        Array,
        BY_COEFFICIENT,
        Field(description="coefficient -> relative standard error, by the model's own values; shape (k,)"),
    ]
    sampled_relative_error: Annotated[
        Array,
        BY_COEFFICIENT,
        Field(description="the same for each ship drawn from the prior, shape (draws, k); null where it diverges"),
    ]
    drift: Annotated[
        Number,
        Field(
            description="rad, largest drift angle of the ship as assumed; null: it turns on the spot and goes astern"
        ),
    ]
    distance: Annotated[Number, Field(description="m, largest distance of the ship as assumed from the start")]
    sampled_drift: Annotated[ListedArray, Field(description="rad, the same for each drawn ship, shape (draws,)")]
    sampled_distance: Annotated[ListedArray, Field(description="m, the same for each drawn ship, shape (draws,)")]
    executed: Annotated[StoredRecord, Field(description="simulated with the model's own values at the sensors' rate")]

    @computed_field(description="largest relative standard error")
    @property
    def worst(self) -> Number:
        """Return the relative standard error of the least precise coefficient."""
        return float(self.relative_error.max())

    @computed_field(description="root mean square of the relative standard errors")
    @property
    def mean(self) -> Number:
        """Return the root mean square of the relative standard errors."""
        return float((self.relative_error**2).mean() ** 0.5)

    @computed_field(description="largest over all drawn ships that do not diverge; null: none")
    @property
    def worst_sampled_error(self) -> Number:
        """Return the largest relative standard error over all drawn ships that do not diverge; NaN without one."""
        rows = self.sampled_relative_error
        valid = rows[~np.isnan(rows).any(axis=1)] if rows.size else rows
        return float(valid.max()) if valid.size else math.nan

    @computed_field(description="number of drawn ships whose simulation diverges")
    @property
    def diverged(self) -> int:
        """Return the number of drawn ships whose simulation diverges."""
        return sum(bool(np.isnan(row).any()) for row in self.sampled_relative_error)


@dataclass(frozen=True)
class Actuator:
    """An input that the helmsman may move, SI and in the record's signs."""

    name: str
    lower: float
    upper: float
    rate: Annotated[Number, Field(description="largest change in a second; null: it may jump (infinite)")]
    hold: Annotated[float, Field(description="s, shortest time between two orders")]


@dataclass(frozen=True)
class TrialLimits:
    """What the trial may not leave."""

    drift: Annotated[Number, Field(description="rad, drift angle; null: free (infinite)")] = float("inf")
    sea_room: Annotated[Number, Field(description="m from the start; null: free (infinite)")] = float("inf")
    for_every_ship: Annotated[
        bool, Field(description="whether they bind every ship drawn from the prior, not only the ship as assumed")
    ] = False


@dataclass(frozen=True)
class TimedOrder:
    """One line of the helmsman's table."""

    time: Annotated[float, Field(description="s")]
    values: Annotated[dict[str, float], Field(description="input -> SI value to set, in the record's signs")]


@dataclass(frozen=True, eq=False)
class Confirmation:
    """The design tried on simulated trials: fits of noisy records compared with the bound."""

    runs: Annotated[int, Field(description="number of simulated trials")]
    converged_runs: Annotated[int, Field(description="number of fits that succeeded")]
    error: Annotated[
        Array,
        BY_COEFFICIENT,
        Field(description="bound times the rms of each fit's error over the one predicted for its ship, shape (k,)"),
    ]
    bound: Annotated[
        Array,
        BY_COEFFICIENT,
        Field(description="rms of the relative standard errors predicted for the same ships, shape (k,)"),
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Design(Summarised):
    """A manoeuvre that identifies the coefficients as well as the limits allow."""

    question: str
    ship: Annotated[str, Field(description="name of the ship")]
    model: Annotated[NamedModel, Field(description="name of the model; its values stand in model.toml")]
    coefficients: Annotated[tuple[str, ...], Field(description="names of the free coefficients, k")]
    sensors: Annotated[dict[str, float], Field(description="channel -> standard deviation of its noise, SI")]
    rate: Annotated[float, Field(description="Hz at which the sensors are recorded")]
    duration: Annotated[float, Field(description="s")]
    actuators: tuple[Actuator, ...]
    limits: TrialLimits
    criterion: Annotated[str, Field(description="worst or mean", pattern="^(worst|mean)$")]
    relative_spread: Annotated[
        Array,
        BY_COEFFICIENT,
        Field(
            description="coefficient -> share by which drawn ships differ, evenly up to it; a standard deviation "
            "where a prior or a fit's covariance is known; shape (k,)"
        ),
    ]
    designed: Annotated[ManoeuvrePrecision, Field(description="the manoeuvre found")]
    baselines: Annotated[
        tuple[ManoeuvrePrecision, ...],
        Field(description="standard manoeuvres of equal duration under the same limits"),
    ]
    orders: Annotated[tuple[TimedOrder, ...], Field(description="the helmsman's table")]
    plan: Annotated[StoredRecord, Field(description="inputs only, at the sensors' rate")]
    solution: StoredSolution
    confirmation: Annotated[Confirmation | None, Field(description="null: not tried")]
    findings: tuple[ReportedFinding, ...]
    seed: int
    elapsed_s: float
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)

    @computed_field(description="of the model's equations")
    @property
    def equation_hash(self) -> str:
        """Return the hash of the model's equations."""
        return self.model.equation_hash

    @computed_field(description="coefficient -> the value the manoeuvre is designed for, SI")
    @property
    def values(self) -> dict[str, Number]:
        """Return the value of each coefficient that the manoeuvre is designed for, SI."""
        return {name: self.model.parameters[name].value for name in self.coefficients}

    @computed_field(description="number of manoeuvres evaluated")
    @property
    def evaluations(self) -> int:
        """Return the number of manoeuvres evaluated."""
        return self.solution.evaluations

    @computed_field(description="how the search ended and what to do next")
    @property
    def status(self) -> str:
        """Return how the search ended and what to do next."""
        return self.solution.status.value

    def summary(self) -> Summary:
        """Return the precision of the designed and the standard manoeuvres as a table."""
        rows = tuple(
            (
                m.name,
                f"{100.0 * m.worst:.3g}",
                f"{100.0 * m.mean:.3g}",
                *([f"{math.degrees(m.drift):.3g}"] if has_drift(self) else []),
                f"{m.distance:.4g}",
            )
            for m in (self.designed, *self.baselines)
        )
        facts = {
            "coefficients": str(len(self.coefficients)), "duration": f"{self.duration:g} s",
            "orders": str(len(self.orders)), "criterion": self.criterion, "search": self.status,
        }  # fmt: skip
        drift = ["drift [deg]"] if has_drift(self) else []
        header = ("manoeuvre", "worst error [%]", "mean error [%]", *drift, "distance [m]")
        return Summary(f"Manoeuvre designed for {self.ship}, model {self.model.name}", header, rows, facts)


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
    """Return whether drift angle, where there is one, and distance keep within the limits for the ships these bind."""
    drifts = manoeuvre.drift > limits.drift * (1.0 + ROUNDING)
    assumed_ship = not drifts and manoeuvre.distance <= limits.sea_room * (1.0 + ROUNDING)
    return assumed_ship and not (limits.for_every_ship and count_outside_limits(manoeuvre, limits))


def count_outside_limits(manoeuvre: ManoeuvrePrecision, limits: TrialLimits) -> int:
    """Return the number of drawn ships that leave the limits."""
    beyond = manoeuvre.sampled_drift > limits.drift * (1.0 + ROUNDING)
    return int(np.sum(beyond | (manoeuvre.sampled_distance > limits.sea_room * (1.0 + ROUNDING))))


def has_drift(design: Design) -> bool:
    """Return whether a drift angle means something: not of a craft that turns on the spot and goes astern."""
    return math.isfinite(design.designed.drift)


def has_track(design: Design) -> bool:
    """Return whether the ship changes its place, so that the distance from its start means something."""
    return {"x0", "y0"} <= set(design.designed.executed.channels) and design.designed.distance > 0.0
