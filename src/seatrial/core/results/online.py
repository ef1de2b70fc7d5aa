"""An estimate while the record is still growing, and gains proposed on board. Plain values, SI."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import ListedArray, Number, ReportedFinding, StoredRecord
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.values import Array

# Gains proposed on board: the sea and the craft that the last minutes show, and the gains that fit both. SI.


@dataclass(frozen=True)
class HeadingRange:
    """Headings to the waves between two ends, rad, 0 following, pi head."""

    lower: float
    upper: float
    probability: Annotated[float, Field(description="0 to 1")]


@dataclass(frozen=True)
class SeaEstimate:
    """The sea that the motions of a stretch show."""

    height: Annotated[IntervalEstimate, Field(description="significant wave height, m")]
    period: Annotated[IntervalEstimate, Field(description="peak period, s")]
    heading: Annotated[IntervalEstimate, Field(description="to the waves, rad, 0 following, pi head")]
    headings: Annotated[
        tuple[HeadingRange, ...],
        Field(description="the fewest headings that hold 95 %, the likeliest range first; several: it is ambiguous"),
    ]
    is_heading_determined: Annotated[bool, Field(description="one range, and a narrow one")]


@dataclass(frozen=True)
class CraftFactor:
    """One property of the craft over that of the loop file's model."""

    name: Annotated[str, Field(description="gain of the actuator's effect, natural frequency, damping")]
    factor: IntervalEstimate


@dataclass(frozen=True)
class GainMargins:
    """Margins of the proposed gains, over the draws of sea and craft that the stretch allows."""

    Ms: Annotated[IntervalEstimate, Field(description="the largest |S|")]
    gain_margin: Annotated[IntervalEstimate, Field(description="factor by which the loop gain may grow; null: any")]
    phase_margin: Annotated[IntervalEstimate, Field(description="rad; null: any")]
    delay_margin: Annotated[IntervalEstimate, Field(description="s of dead time until the loop is unstable; null: any")]
    reduction: Annotated[IntervalEstimate, Field(description="of the output's rms, 0 to 1")]
    saturation: Annotated[IntervalEstimate, Field(description="share of actuator amplitudes beyond the limit, 0 to 1")]
    stable_draws: int
    draws: int


@dataclass(frozen=True)
class Proposal:
    """What is proposed after a stretch of record: gains, or none and why. Nothing is ever set by it."""

    loop: Annotated[str, Field(description="name of the loop")]
    start: Annotated[Number, Field(description="s on the stream's clock, of the stretch it rests on")]
    stop: Annotated[Number, Field(description="s on the stream's clock")]
    gains: Annotated[dict[str, float], Field(description="name -> value; empty: none are proposed")]
    reasons: Annotated[tuple[str, ...], Field(description="why these gains, or why none, sentence by sentence")]
    gain_units: dict[str, str] = field(default_factory=dict)
    is_new: Annotated[bool, Field(description="whether the gains differ from those proposed before")] = False
    U: Annotated[Number, Field(description="m/s, mean of the stretch")] = float("nan")
    sea: Annotated[SeaEstimate | None, Field(description="null: none could be estimated")] = None
    craft: tuple[CraftFactor, ...] = ()
    margins: Annotated[GainMargins | None, Field(description="null: no gains are proposed")] = None

    @computed_field(description="whether gains are proposed")
    @property
    def has_gains(self) -> bool:
        """Return whether gains are proposed."""
        return bool(self.gains)


# An estimate while the record is still growing: what is estimated by now. Plain values, SI.


@dataclass(frozen=True, eq=False)
class Sample:
    """One row of a stream: time [s] on its own clock and the layout's columns in SI, conventions as declared.

    values: (k,), in the order of the layout's columns; NaN where a cell was empty or no number.
    """

    time: float
    values: Array


class EstimatorPhase(StrEnum):
    """How the numbers of a snapshot come about.

    WAITING: too few samples; values are the start, standard errors infinite.
    WINDOW: the criterion of `identify` over all samples, re-linearised as the record grows.
    RECURSIVE: a filter that carries the same information on, sample by sample.
    """

    WAITING = "waiting"
    WINDOW = "window"
    RECURSIVE = "recursive"


@dataclass(frozen=True)
class CoefficientChange:
    """A change of the ship: what samples behind an instant say against those before (Willsky & Jones 1976).

    Changes that follow one another closely, as along a ramp, are one: `since` and `before` are of the first.
    """

    since: Annotated[Number, Field(description="s on the stream's clock, likeliest instant of the change")]
    between: Annotated[tuple[Number, Number], Field(description="s on the stream's clock, interval of that instant")]
    reported_at: Annotated[
        Number, Field(description="s on the stream's clock: what is estimated rests on later samples")
    ]
    evidence: Annotated[Number, Field(description="nats by which a change is likelier than none")]
    most_changed: Annotated[str, Field(description="coefficient that changed most, in its standard errors")]
    before: Annotated[dict[str, Number], Field(description="coefficient -> value before the change, SI")]
    error_before: Annotated[dict[str, Number], Field(description="coefficient -> standard error of that value, SI")]
    is_believed: Annotated[
        bool,
        Field(
            description="false: others, or residuals that are not white, followed so closely that the model is off, "
            "not the ship"
        ),
    ] = True


@dataclass(frozen=True)
class SampleCounts:
    """What happened to the samples of a stream."""

    accepted: Annotated[int, Field(description="used")] = 0
    late: Annotated[int, Field(description="older than one already used")] = 0
    repeated: Annotated[int, Field(description="same time stamp again")] = 0
    not_finite: Annotated[
        int, Field(description="a required channel was no number; the rest of the sample is used")
    ] = 0
    missing: Annotated[int, Field(description="time steps without a sample")] = 0
    jumps: Annotated[int, Field(description="breaks of the clock, each starting a new run")] = 0
    garbled: Annotated[int, Field(description="lines or sentences that could not be read")] = 0
    checksum: Annotated[int, Field(description="NMEA sentences with a wrong checksum")] = 0
    dropped: Annotated[int, Field(description="beyond the rate or size allowed (a flood)")] = 0
    truncated: Annotated[int, Field(description="times the file became shorter while it was read")] = 0
    last_problem: Annotated[str, Field(description="the latest problem, in a sentence")] = ""


@dataclass(frozen=True)
class OnlineCoefficient:
    """One free coefficient, SI."""

    name: str
    unit: str
    estimate: Number
    standard_error: Annotated[Number, Field(description="null: nothing known (infinite)")]
    is_identified: Annotated[bool, Field(description="false where the samples so far do not identify it")]


@dataclass(frozen=True, eq=False)
class Snapshot:
    """What is estimated at one moment.

    `names`, `units`, `value`, `standard_error` and `unidentified` are written as `coefficients`: units and values in
    the order of the names, shape (k,); `unidentified` names those that the samples so far do not identify (standard
    error beyond the value, or a tied direction).
    """

    time: Annotated[Number, Field(description="s on the stream's clock; null: no sample came")]
    samples: Annotated[int, Field(description="all samples so far, of all runs")]
    runs: Annotated[int, Field(description="runs begun so far")]
    phase: EstimatorPhase
    names: Annotated[tuple[str, ...], Field(exclude=True)]
    units: Annotated[tuple[str, ...], Field(exclude=True)]
    value: Annotated[ListedArray, Field(exclude=True)]
    standard_error: Annotated[ListedArray, Field(exclude=True)]
    noise: Annotated[dict[str, Number], Field(description="channel -> rms of its residuals, SI")] = field(
        default_factory=dict
    )
    unidentified: Annotated[tuple[str, ...], Field(exclude=True)] = ()
    advice: Annotated[
        str, Field(description="which manoeuvre would help, in a sentence; empty if every coefficient is identified")
    ] = ""
    change: Annotated[CoefficientChange | None, Field(description="the last one; null: none was seen")] = None
    unwatched: Annotated[str, Field(description="why changes are not watched, in a sentence; empty if they are")] = ""
    findings: tuple[ReportedFinding, ...] = ()
    counts: SampleCounts = SampleCounts()
    recent: Annotated[tuple[StoredRecord, ...], Field(exclude=True)] = ()
    """The run so far, thinned, for people to look at; empty: not kept."""
    proposal: Annotated[
        Proposal | None, Field(description="gains for the sea and the craft of the latest stretch; null: none required")
    ] = None

    @computed_field
    @property
    def coefficients(self) -> tuple[OnlineCoefficient, ...]:
        """Return the free coefficients."""
        return tuple(
            OnlineCoefficient(name, unit, float(value), float(error), name not in self.unidentified)
            for name, unit, value, error in zip(self.names, self.units, self.value, self.standard_error, strict=True)
        )


NO_SAMPLE = Snapshot(float("nan"), 0, 0, EstimatorPhase.WAITING, (), (), np.empty(0), np.empty(0))
"""What is estimated where no sample came."""
