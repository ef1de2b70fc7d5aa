"""A published search for gains: the answers of several seeds, and what one search costs."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import ListedArray, Number

RECORD_SECONDS, RECORD_STEP = 1000.0, 0.1
"""s: length and step of the record that each controller would be simulated with (Yu et al. 2014, section 3)."""


@dataclass(frozen=True, eq=False)
class GainSearch:
    """A published search for gains: what it made small, its answers by seed, its cost. Rows: one for each seed."""

    source: Annotated[str, Field(description="the publication")]
    settings: Annotated[dict[str, str], Field(description="name -> value, as in the loop file")]
    objectives: Annotated[dict[str, str], Field(description="what was made small: name -> unit")]
    evaluations: Annotated[int, Field(description="controllers that one search evaluates")]
    cpu_s: Annotated[Number, Field(description="CPU time of one search with its front, median of the seeds")]
    histories: Annotated[
        ListedArray,
        Field(description="J of the fittest under equal weights in each generation, shape (seeds, generations)"),
    ]
    gain_names: Annotated[tuple[str, ...], Field(description="columns of `gains`, `lower`, `upper` and `spread`")]
    gains: Annotated[ListedArray, Field(description="answers, shape (seeds, g); the first is the controller chosen")]
    lower: Annotated[ListedArray, Field(description="bounds of the search, shape (g,)")]
    upper: Annotated[ListedArray, Field(description="bounds of the search, shape (g,)")]
    spread: Annotated[
        ListedArray, Field(description="largest minus smallest answer over the range searched, shape (g,)")
    ]
    values: Annotated[ListedArray, Field(description="objectives of the tuning at the answers, shape (seeds, m)")]
    Ms: Annotated[ListedArray, Field(description="of the answers, shape (seeds,)")]
    is_feasible: Annotated[tuple[bool, ...], Field(description="whether each answer keeps all constraints")]
    dominated: Annotated[int, Field(description="answers beaten in every objective by a controller of the front")]
    hypervolume: Annotated[
        Number,
        Field(description="of what the first search saw within the constraints, over that of the package's front"),
    ]
    compiled_record_s: Annotated[
        Number,
        Field(description="CPU time of one record of 1000 s at 0.1 s of one controller, compiled scalar loop"),
    ]
    lsim_record_s: Annotated[Number, Field(description="the same by scipy.signal.lsim")]

    @computed_field(description="J of the fittest in each generation, first seed")
    @property
    def history(self) -> tuple[float, ...]:
        """Return J of the fittest in each generation of the first seed."""
        return tuple(float(value) for value in self.histories[0])

    @computed_field(description="CPU time of the search with compiled records for each controller, over its own")
    @property
    def compiled_ratio(self) -> float:
        """Return how many times as long the search takes with records by the compiled loop."""
        return self.compiled_record_s * self.evaluations / self.cpu_s

    @computed_field(description="the same with scipy.signal.lsim")
    @property
    def lsim_ratio(self) -> float:
        """Return how many times as long the search takes with records by lsim."""
        return self.lsim_record_s * self.evaluations / self.cpu_s

    @property
    def feasible_count(self) -> int:
        """Return how many answers keep all constraints."""
        return int(np.sum(self.is_feasible))
