"""A designed manoeuvre: the request, the orders, and its precision compared with standard manoeuvres."""

import math
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field, computed_field

from seatrial.core.results.fields import (
    NamedModel,
    Number,
    ReportedFinding,
    StoredRecord,
    StoredSolution,
    named_by,
)
from seatrial.core.results.manoeuvre_precision import ManoeuvrePrecision
from seatrial.core.results.summary import Summarised, Summary
from seatrial.core.values import Array

BY_COEFFICIENT = named_by("coefficients")


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
        Array, BY_COEFFICIENT, Field(description="rms error over the magnitude of each coefficient, shape (k,)")
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
                f"{math.degrees(m.drift):.3g}",
                f"{m.distance:.4g}",
            )
            for m in (self.designed, *self.baselines)
        )
        facts = {
            "coefficients": str(len(self.coefficients)), "duration": f"{self.duration:g} s",
            "orders": str(len(self.orders)), "criterion": self.criterion, "search": self.status,
        }  # fmt: skip
        header = ("manoeuvre", "worst error [%]", "mean error [%]", "drift [deg]", "distance [m]")
        return Summary(f"Manoeuvre designed for {self.ship}, model {self.model.name}", header, rows, facts)
