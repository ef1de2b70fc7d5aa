"""What problems have in common whose unknowns are a model's free parameters and nothing else."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array


@dataclass(frozen=True, eq=False)
class FreeParameterProblem:
    """Names, bounds and start of the unknowns, and all parameter values at a point."""

    model: Model

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return self.model.parameters.free_names

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        return np.array([p.lower for p in self.model.parameters.free])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        return np.array([p.upper for p in self.model.parameters.free])

    def start(self) -> Array:
        """Return the model's own values."""
        return np.array([p.value for p in self.model.parameters.free])

    @cached_property
    def _free_indices(self) -> list[int]:
        return [self.model.parameters.index(n) for n in self.free]

    def _parameter_values(self, shared: Array) -> Array:
        """Return all of the model's parameters with the unknowns at `shared`."""
        values = self.model.parameters.values
        values[self._free_indices] = shared
        return values
