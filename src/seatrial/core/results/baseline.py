"""Another estimator's answer to the records of a fit."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number, ReportedFinding

NO_COMPARISON = "no-comparison"
"""Code of the finding that says why other estimators could not be compared."""


@dataclass(frozen=True)
class OpenLoopScores:
    """Runs simulated open loop, scored together; rms and correlation are empty where one diverges."""

    rms: Annotated[
        dict[str, Number], Field(description="keys as in `Prediction.rms`, root of the mean of squares over the runs")
    ] = field(default_factory=dict)
    correlation: Annotated[
        dict[str, Number], Field(description="u, v, r: Pearson's coefficient of measured and simulated, mean over runs")
    ] = field(default_factory=dict)
    diverged: Annotated[tuple[str, ...], Field(description="names of the runs whose simulation diverges")] = ()


@dataclass(frozen=True)
class Baseline:
    """An estimator on the records of a fit; first the fit itself, then, if it has any, without its offsets."""

    name: str
    values: Annotated[dict[str, Number], Field(description="coefficient -> SI; empty where the estimator failed")] = (
        field(default_factory=dict)
    )
    normalised_difference: Annotated[
        dict[str, Number], Field(description="coefficient -> difference from the fit's estimate in its standard errors")
    ] = field(default_factory=dict)
    error: Annotated[dict[str, Number], Field(description="relative, where the true value is known and not zero")] = (
        field(default_factory=dict)
    )
    training: Annotated[
        OpenLoopScores, Field(description="training runs with these values, from the initial states of the fit")
    ] = field(default_factory=OpenLoopScores)
    validation: Annotated[OpenLoopScores, Field(description="the same of the runs that were not fitted")] = field(
        default_factory=OpenLoopScores
    )
    bias: Annotated[
        dict[str, Number], Field(description="equation -> constant that the estimator allowed itself in addition")
    ] = field(default_factory=dict)
    findings: tuple[ReportedFinding, ...] = ()
    note: Annotated[str, Field(description="why the estimator failed; empty where it did not")] = ""
    is_fit: Annotated[bool, Field(description="whether these are the coefficients of the fit")] = False

    @property
    def diverged(self) -> tuple[str, ...]:
        """Return the names of all runs whose simulation diverges."""
        return (*self.training.diverged, *self.validation.diverged)

    def relative_deviation(self, fit: "Baseline") -> dict[str, float]:
        """Return the relative error of each coefficient where the truth is known, else its difference from the fit."""
        if fit.error:
            return self.error
        return {n: value / fit.values[n] - 1.0 for n, value in self.values.items() if fit.values.get(n)}
