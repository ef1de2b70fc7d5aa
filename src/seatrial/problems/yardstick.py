"""What an answer to a benchmark problem is measured by; no method sees it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from seatrial.core.values import Array

_ONE_PERCENT = 0.01
"""Share of the truth that is an error of 1 where there is no noise; chosen."""


class Yardstick(Protocol):
    """Measures answers by one number, 0 for the exact one."""

    @property
    def unit(self) -> str:
        """What an error of 1 is, in words."""
        ...

    @property
    def success_limit(self) -> float:
        """Largest error of an answer that counts as a success."""
        ...

    @property
    def truth(self) -> Array | None:
        """True values (d,); None where nobody knows them."""
        ...

    @property
    def bound(self) -> Array | None:
        """Cramer-Rao bound of the standard errors (d,); None without noise or truth."""
        ...

    def error(self, values: Array) -> float:
        """Return the error of an answer (d,), infinite where it cannot be evaluated."""
        ...


@dataclass(frozen=True, eq=False)
class KnownTruth:
    """Coefficients whose true values are known.

    Attributes:
        truth: (d,).
        bound: Cramer-Rao bound of the standard errors (d,); None: the records have no noise, and errors count in per
            cent of the truth.
    """

    truth: Array
    bound: Array | None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        return "1 % of the truth, rms over the unknowns" if self.bound is None else "the Cramér-Rao bound, rms"

    @property
    def success_limit(self) -> float:
        """Two bounds, which an efficient estimate of several coefficients hardly ever exceeds, or 1 %; chosen."""
        return 1.0 if self.bound is None else 2.0

    @property
    def scale(self) -> Array:
        """Error of each unknown that counts as 1, (d,)."""
        return _ONE_PERCENT * np.abs(self.truth) if self.bound is None else self.bound

    def error(self, values: Array) -> float:
        """Return the root mean square over the unknowns of the errors in units of the scale."""
        return float(np.sqrt(np.mean(((values - self.truth) / self.scale) ** 2)))


@dataclass(frozen=True, eq=False)
class KnownOptimum:
    """An objective whose least value is known from a search beyond any budget.

    Attributes:
        fitness: points (n, d) -> objective (n,), deterministic.
        least: the least value, positive.
    """

    fitness: Callable[[Array], Array]
    least: float
    truth: None = None
    bound: None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        return "1 % of the least known objective above it"

    @property
    def success_limit(self) -> float:
        """Within 1 % of the least known objective; chosen."""
        return 1.0

    def error(self, values: Array) -> float:
        """Return by how many per cent the objective lies above the least known one; a smaller one counts as zero."""
        value = float(self.fitness(values[None])[0])
        return max(100.0 * (value / self.least - 1.0), 0.0) if np.isfinite(value) else np.inf
