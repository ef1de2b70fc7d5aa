"""Noise of a fit: what is between model and record, and what the residuals look like."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number, StoredArray


@dataclass(frozen=True)
class Noise:
    """Estimated noise of one channel and the colour of its residuals."""

    channel: str
    unit: Annotated[str, Field(description="SI")]
    standard_deviation: Annotated[Number, Field(description="in `unit`")]
    correlation_time: Annotated[Number, Field(description="s, integral scale of the residuals' autocorrelation")]
    whiteness_p: Annotated[
        Number, Field(description="p-value of a portmanteau test (Ljung & Box 1978) that the residuals are white")
    ]


@dataclass(frozen=True)
class NoiseModel:
    """Process noise in the states and measurement noise in the channels, as the criterion of the fit allows for."""

    method: Annotated[str, Field(description="output error or prediction error, the criterion of the fit")]
    whiteness_p: Annotated[
        Number, Field(description="smallest p-value over the channels that the residuals (innovations) are white")
    ]
    process: Annotated[
        dict[str, Number],
        Field(description="state -> intensity, SI unit of the state over the root of a second; 0: none needed"),
    ]
    measurement: Annotated[dict[str, Number], Field(description="channel -> standard deviation, SI")]
    text: Annotated[str, Field(description="why this criterion")] = ""


@dataclass(frozen=True, eq=False)
class Residuals:
    """Residuals of one channel of the training runs, in order, for whiteness plots."""

    channel: str
    rate: Annotated[float, Field(description="Hz")]
    values: Annotated[StoredArray, Field(description="shape (n,), SI; runs one after another")]
    autocorrelation: Annotated[
        StoredArray, Field(description="shape (k,), lags 0, 1, ... at `rate`, averaged over segments")
    ]
