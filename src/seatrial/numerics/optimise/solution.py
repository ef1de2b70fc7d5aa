"""What an optimiser found."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Status(StrEnum):
    """How a search ended; the text says what to do next."""

    CONVERGED = "converged: no smaller residual within rounding"
    STALLED = "stalled: no step lowers the residual; check the model, or start elsewhere"
    EXHAUSTED = "stopped at the evaluation limit; raise it, or look at the history for slow directions"
    FAILED = "the residual could not be evaluated at the start; check start values and records"

    @property
    def is_success(self) -> bool:
        """Whether the point can be used."""
        return self is Status.CONVERGED


@dataclass(frozen=True, eq=False)
class Solution:
    """A point, its value (half the sum of squared residuals, or an objective) and how it was reached.

    Attributes:
        point: shape (n,), physical units.
        value: objective at the point.
        evaluations: number of objective evaluations.
        history: best value after each iteration.
        seed: of the search, where it draws at random.
    """

    point: Array
    value: float
    status: Status
    evaluations: int
    history: tuple[float, ...] = ()
    seed: int | None = None
