"""Settings of a search by a population: a table of a trial file, a value in Python."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic.dataclasses import dataclass

from seatrial.data.trial.amounts import STRICT_FIELDS
from seatrial.data.trial.schema_errors import raises_input_error


class SearchFitness(StrEnum):
    """What one iteration of a search judges candidates by."""

    RECORD = "record"
    SAMPLE = "sample"


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class SearchSettings:
    """`[estimate.search]`: a search by a population; what is not given is as the method's source has it.

    Attributes:
        population: points of one iteration.
        iterations: populations judged, the first included.
        fitness: the whole record, or one sample in each iteration (Qi et al. 2025, eq. (28)).
        restarts: searches with random numbers of their own, at least 1.
        bounds: coefficient -> ends of its range, SI; those of `[model.bounds]` where it is not named.
    """

    population: Annotated[int, Field(ge=1)] | None = None
    iterations: Annotated[int, Field(ge=1)] | None = None
    fitness: SearchFitness = SearchFitness.RECORD
    restarts: Annotated[int, Field(ge=1)] = 3
    bounds: Mapping[str, tuple[float, float]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ends_in_order(self) -> Self:
        for name, (lower, upper) in self.bounds.items():
            if not lower < upper:
                raise ValueError(
                    f"the bounds of {name} run from {lower:g} to {upper:g}; write {name} = [{upper:g}, {lower:g}]"
                    if lower > upper
                    else f"both bounds of {name} are {lower:g}; widen them, or fix {name} under [model]"
                )
        return self
