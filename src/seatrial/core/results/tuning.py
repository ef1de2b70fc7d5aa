"""A tuned controller: the front, the choice and its reasons, its schedule. Plain values, SI."""

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, computed_field

from seatrial.core.results.controller import (
    Component,
    Controller,
    ControllerConstraints,
    OperatingPoint,
    ParetoFront,
    PerformanceBound,
)
from seatrial.core.results.fields import ReportedFinding, StoredSolution
from seatrial.core.results.gain_search import GainSearch
from seatrial.core.results.seaway_simulation import ManoeuvreResponse, PairedDifference, SeawaySimulation
from seatrial.core.results.summary import Summarised, Summary
from seatrial.core.values import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Component", "Controller", "ControllerConstraints", "ManoeuvreResponse", "OperatingPoint", "PairedDifference",
    "ParetoFront", "PerformanceBound", "SeawaySimulation", "Tuning", "TuningMethod",
]  # fmt: skip


class TuningMethod(StrEnum):
    """Where the chosen gains come from: the package's own front, or a published search."""

    FRONT = "front"
    GENETIC = "genetic"


@dataclass(frozen=True, eq=False, repr=False)
class Tuning(Summarised):
    """A tuned controller with everything its page shows."""

    question: str
    name: str
    plant: Annotated[str, Field(description="where it comes from, in a sentence")]
    seas: Annotated[tuple[str, ...], Field(description="those it is tuned in, a sentence each")]
    output: Annotated[str, Field(description="symbol of what is to stay small")]
    actuator: Annotated[str, Field(description="symbol of what moves")]
    objectives: Annotated[dict[str, str], Field(description="name -> unit, in order")]
    constraints: ControllerConstraints
    chosen: Annotated[Controller, Field(description="the recommendation")]
    reasons: Annotated[tuple[str, ...], Field(description="why, sentence by sentence")]
    baselines: Annotated[tuple[Controller, ...], Field(description="given gains and other choices")]
    front: Annotated[ParetoFront, Field(description="with the task's own gains")]
    extended_fronts: Annotated[
        tuple[ParetoFront, ...], Field(description="fronts of more structure or other comparisons")
    ]
    components: Annotated[
        tuple[Component, ...], Field(description="blocks of the chosen loop, so that other programs can rebuild it")
    ]
    seaway_simulations: tuple[SeawaySimulation, ...]
    paired_differences: tuple[PairedDifference, ...]
    schedule: tuple[OperatingPoint, ...]
    bounds: tuple[PerformanceBound, ...]
    manoeuvres: tuple[ManoeuvreResponse, ...]
    findings: tuple[ReportedFinding, ...]
    solution: StoredSolution
    seed: int
    elapsed_s: float
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)
    method: Annotated[TuningMethod, Field(description="where the chosen gains come from")] = TuningMethod.FRONT
    search: Annotated[GainSearch | None, Field(description="the published search; null: none")] = None
    reference: Annotated[
        Controller | None, Field(description="the package's own choice beside that of a published search; null: chosen")
    ] = None

    @property
    def compared(self) -> tuple[Controller, ...]:
        """Return the chosen controller, the package's own where it is another, and the baselines."""
        return (self.chosen, *(() if self.reference is None else (self.reference,)), *self.baselines)

    @property
    def units(self) -> tuple[str, ...]:
        """Return the unit of each objective, in order."""
        return tuple(self.objectives.values())

    @computed_field(description="number of controllers evaluated")
    @property
    def evaluations(self) -> int:
        """Return the number of controllers evaluated."""
        return self.solution.evaluations

    @computed_field(description="how the search ended and what to do next")
    @property
    def status(self) -> str:
        """Return how the search ended and what to do next."""
        return self.solution.status.value

    def plot(self) -> "Figure":
        """Draw the front with the controllers compared, or the magnitudes of S and T where there is one objective.

        Raises:
            InputError: neither a front nor a loop is known.
        """
        from seatrial.core.figures.matplotlib_axes import matplotlib_figure
        from seatrial.core.results.front_chart import front_chart
        from seatrial.core.results.loop_charts import sensitivity_chart

        chart = front_chart(self) or sensitivity_chart(self)
        if chart is None:
            raise InputError(f"the tuning '{self.name}' has neither a front nor a stable loop to plot")
        return matplotlib_figure(chart)

    def summary(self) -> Summary:
        """Return the gains and margins of the chosen and the other controllers as a table."""
        header = ("controller", *self.chosen.gains, "Ms", "gain margin", "phase margin [deg]", "damping")
        rows = tuple(
            (
                c.name, *(f"{c.gains[name]:.5g}" if name in c.gains else "" for name in self.chosen.gains),
                f"{c.Ms:.3g}", f"{c.gain_margin:.3g}", f"{math.degrees(c.phase_margin):.3g}", f"{c.damping:.2g}",
            )
            for c in self.compared
        )  # fmt: skip
        facts = {"plant": self.plant, "output": self.output, "actuator": self.actuator, "search": self.status}
        return Summary(f"Tuning of {self.name}", header, rows, facts, self.reasons)
