"""Data besides the records: a sum of squares over model parameters that an output-error problem adds to its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from seatrial.core.values import Array


@dataclass(frozen=True, eq=False)
class Contribution:
    """Cost, gradient (k,) and Gauss-Newton Hessian (k, k) of one addend by k model parameters."""

    cost: float
    gradient: Array
    hessian: Array


class DataTerm(Protocol):
    """What the output-error problem asks of other data."""

    def cost(self, values: Array) -> float:
        """Half the sum of squares at these values of all model parameters."""
        ...

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """The Gauss-Newton model by the parameters at the positions `free`."""
        ...
