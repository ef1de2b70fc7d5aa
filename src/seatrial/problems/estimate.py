"""What a method answers: values, and how sure of them it is."""

from dataclasses import dataclass

from seatrial.core.values import Array


@dataclass(frozen=True, eq=False)
class Estimate:
    """Values (d,), and their covariance (d, d) where the method states one."""

    values: Array
    covariance: Array | None = None
