"""The response of an output to an input over frequency: the records' and the model's, estimated in one way."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from seatrial.core.results.fields import ComplexArray, ListedArray

Mask = NDArray[np.bool_]
"""Booleans, one for each frequency."""


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Cross-spectrum over input spectrum (H1), of what was measured and of the model simulated with the same inputs.

    Both have the same windows, the same transients and, where several inputs move, the same share of the others; so
    they may be compared with each other, also for a nonlinear model, but are no transfer function then.
    """

    input: str
    output: str
    unit: Annotated[str, Field(description="SI unit of the output over that of the input")]
    omega: Annotated[ListedArray, Field(description="rad/s, shape (n,)")]
    measured: Annotated[ComplexArray, Field(description="response of the records")]
    simulated: Annotated[ComplexArray, Field(description="response of the model over the same runs")]
    coherence: Annotated[
        ListedArray, Field(description="share of the measured output's power that is linear in the input, 0 to 1")
    ]
    radius: Annotated[
        ListedArray,
        Field(
            description="the records' response lies within this distance of `measured`, in the complex plane, with a "
            "probability of 95 % at each frequency; null: too few averages"
        ),
    ]
    averages: Annotated[ListedArray, Field(description="number of independent averages behind each value")]
    excited: Annotated[
        tuple[bool, ...], Field(description="whether the input moves there: density of 0.001 of its largest or more")
    ]

    @property
    def is_compared(self) -> Mask:
        """Return at which frequencies the input moves and the 95 % region leaves zero out, shape (n,), as booleans."""
        return np.array(self.excited) & (self.radius < np.abs(self.measured))

    @property
    def is_inside(self) -> Mask:
        """Return at which frequencies the model lies within the 95 % region of the records, shape (n,), as booleans."""
        return np.abs(self.simulated - self.measured) <= self.radius

    @property
    def excited_range(self) -> tuple[float, float]:
        """Return the lowest and the highest excited frequency [rad/s]."""
        omega = self.omega[np.array(self.excited)]
        return float(omega[0]), float(omega[-1])
