"""Controllers in nonlinear simulation: in seas of several seeds, and through demanded manoeuvres."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import ListedArray, Number, StoredArray, StoredRecord


@dataclass(frozen=True, eq=False)
class SeawaySimulation:
    """One controller over seeds of the sea: reductions of the output's rms, 0 to 1, shape (seeds,)."""

    name: str
    linear: Annotated[ListedArray, Field(description="without limits")]
    limited: Annotated[ListedArray, Field(description="with limits of angle and rate")]
    stalled: Annotated[ListedArray, Field(description="with stall, too")]
    record: Annotated[
        StoredRecord,
        Field(
            description="first seed, all limits on: output, actuator, disturbance, and the output of the same sea "
            "without control, its name with _uncontrolled"
        ),
    ]

    @computed_field(description="reduction lost to limits of angle and rate, mean over the seeds")
    @property
    def saturation_loss(self) -> Number:
        """Return the reduction lost to limits of angle and rate, mean over the seeds."""
        return float(np.mean(self.linear - self.limited))


@dataclass(frozen=True)
class PairedDifference:
    """Reduction of the chosen controller minus that of another on the same seas, with its 95 % interval."""

    baseline: Annotated[str, Field(description="name of the other controller")]
    stage: Annotated[str, Field(description="linear, limited or stalled")]
    mean: Number
    lower: Number
    upper: Number
    seeds: int


@dataclass(frozen=True, eq=False)
class ManoeuvreResponse:
    """One controller through a demand with the nonlinear model: a course or speed change, a zigzag."""

    name: str
    controller: Annotated[str, Field(description="name of the controller")]
    record: Annotated[StoredRecord, Field(description="demand and response")]
    output: Annotated[str, Field(description="symbol of the output")]
    overshoot: Annotated[Number, Field(description="share of the change")]
    settling: Annotated[Number, Field(description="s to stay within 5 %; null: never")]
    stable_draws: Annotated[int, Field(description="ships drawn from the fit's covariance with a stable loop")]
    draws: Annotated[int, Field(description="ships drawn from the fit's covariance")]
    worst_overshoot: Annotated[Number, Field(description="over the ships drawn; null: none drawn")]
    sampled_outputs: Annotated[
        StoredArray, Field(description="outputs of some of the ships drawn, on the record's time, shape (k, n)")
    ]
