"""Predictions over windows of a run, with baselines that anybody could make."""

import math
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class ChannelScore:
    """How one channel is predicted over all windows of a length; null where a window diverges."""

    rms: Annotated[Number, Field(description="root-mean-square error, unit as in `Prediction.rms`")]
    fit_percent: Annotated[
        Number, Field(description="100 (1 - |error| / |measured - mean|), as MATLAB's compare (NRMSE); 100 is perfect")
    ]
    r_squared: Annotated[Number, Field(description="1 - sum of squared errors over that about the mean")]
    inside_band: Annotated[
        Number | None,
        Field(description="share of samples inside their 95 % band (sensor noise included); null: no band"),
    ] = None
    band_share: Annotated[
        Number | None,
        Field(description="rms half width of the band over the standard deviation of the motion; null: no band"),
    ] = None

    @property
    def band_over_error(self) -> float | None:
        """Return the rms half width of the band over the rms error, about 2 where the band is right; None: no band."""
        if self.band_share is None or not self.r_squared < 1.0:
            return None
        return self.band_share / math.sqrt(1.0 - self.r_squared)  # the error is that share of the motion

    @property
    def is_band_too_wide(self) -> bool:
        """Whether the band is wider than the motion itself, so that the mean of the motion would lie inside it, too."""
        return self.band_share is not None and self.band_share > 1.0


@dataclass(frozen=True)
class WindowBaseline:
    """A prediction that needs no fit of this model, over the same windows from the same beginnings."""

    name: str
    scores: Annotated[
        dict[str, ChannelScore], Field(description="keys as in `WindowScore.scores`, as far as it predicts them")
    ]


@dataclass(frozen=True)
class WindowScore:
    """A run cut into windows of one length, each predicted open loop from the state estimated in its beginning."""

    window: Annotated[str, Field(description="as required: 10 s, 5 L (ship lengths at the run's speed)")]
    seconds: Annotated[Number, Field(description="length of the windows")]
    count: Annotated[int, Field(description="number of windows")]
    scores: Annotated[dict[str, ChannelScore], Field(description="keys as in `Prediction.rms`")] = field(
        default_factory=dict
    )
    baselines: tuple[WindowBaseline, ...] = ()
    diverged: Annotated[int, Field(description="number of windows in which the model diverges")] = 0

    @property
    def divergence_text(self) -> str:
        """Return in how many windows the model diverges; empty where it does in none."""
        return f"the model diverges in {self.diverged} of {self.count} windows" if self.diverged else ""

    @property
    def better_baselines(self) -> dict[str, str]:
        """Return the channel of each baseline that errs less than the fit -> name of the best one there.

        An error of the fit without a number, after a divergence, is compared with none.
        """
        better: dict[str, str] = {}
        for channel, score in self.scores.items():
            if not math.isfinite(score.rms):
                continue
            rivals = [
                (b.scores[channel].rms, b.name) for b in self.baselines if b.scores.get(channel, score).rms < score.rms
            ]
            if rivals:
                better[channel] = min(rivals)[1]
        return better
