"""Precision of the coefficients after one manoeuvre, for the ship as assumed and for ships drawn from the prior."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import ListedArray, Number, StoredRecord, named_by
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
    drift: Annotated[Number, Field(description="rad, largest drift angle of the ship as assumed")]
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
