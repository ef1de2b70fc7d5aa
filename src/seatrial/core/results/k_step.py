"""Errors of predictions some samples ahead, from the samples up to each moment."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class KStepErrors:
    """How far one channel is missed k samples ahead, by the fit's Kalman filter, over all runs of a role.

    Inputs are those recorded. Without a disturbance in the fit every horizon has the error of a simulation.
    """

    channel: str
    unit: Annotated[str, Field(description="SI")]
    role: Annotated[str, Field(description="validation or training")]
    steps: Annotated[tuple[int, ...], Field(description="horizons k, samples")]
    seconds: Annotated[tuple[Number, ...], Field(description="the same, s")]
    rms: Annotated[tuple[Number, ...], Field(description="root-mean-square error at each horizon, `unit`")]
    fit_percent: Annotated[
        tuple[Number, ...],
        Field(description="100 (1 - |error| / |measured - mean|) at each horizon, as MATLAB's compare (NRMSE)"),
    ]
    held_rms: Annotated[
        tuple[Number, ...],
        Field(description="root-mean-square error of a baseline: the last measured value stays as it is, `unit`"),
    ]
    count: Annotated[tuple[int, ...], Field(description="number of predictions at each horizon")]
