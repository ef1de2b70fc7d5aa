"""Searches from several starting points, and where each ended."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class SearchAttempt:
    """One short search; losses are negative log-likelihoods, the noise of each channel at its residuals' own."""

    origin: Annotated[str, Field(description="where it started")]
    start_loss: Annotated[Number, Field(description="at its start, above the lowest end of all; null: diverges there")]
    loss: Annotated[Number, Field(description="at its end, above the lowest end of all; null: no finite one")]
    evaluations: Annotated[int, Field(description="of the residuals")]
    values: Annotated[dict[str, Number], Field(description="coefficient -> SI, at its end")]
    is_used: Annotated[bool, Field(description="whether the estimate goes on from its end")]
