"""An estimate while the record is still being made: what is known by now. Plain values, SI."""

from dataclasses import dataclass, field
from enum import StrEnum

from seatrial.core.values import Array, Finding


@dataclass(frozen=True, eq=False)
class Sample:
    """One row of a stream: time [s] on its own clock and the layout's columns in SI, conventions as declared.

    values: (k,), in the order of the layout's columns; NaN where a cell was empty or no number.
    """

    time: float
    values: Array


class EstimatorPhase(StrEnum):
    """How the numbers of a snapshot come about.

    WAITING: too little has been seen; values are the start, standard errors infinite.
    WINDOW: the criterion of `identify` over everything seen, re-linearised as the record grows.
    RECURSIVE: a filter that carries the same information on, sample by sample.
    """

    WAITING = "waiting"
    WINDOW = "window"
    RECURSIVE = "recursive"


@dataclass(frozen=True)
class CoefficientChange:
    """Whether the latest stretch tells other coefficients than what came before (Hausman 1978, Econometrica 46).

    Attributes:
        since: s of samples seen when the latest stretch began; statistic: chi-squared of `freedom` degrees.
        p: probability of as much by chance; is_told: p is small enough to say so, corrected for repeated looking.
        most: the coefficient that has moved most, in its standard errors.
    """

    since: float
    statistic: float
    degrees_of_freedom: int
    p: float
    is_significant: bool
    most_changed: str


@dataclass(frozen=True)
class SampleCounts:
    """What happened to the samples of a stream.

    Attributes:
        accepted: used; late: older than one already used; repeated: same time stamp again; not_finite: a needed channel
            was no number (the rest of the sample is used); missing: time steps for which nothing came; jumps: breaks of
            the clock, each beginning a new run; garbled: lines or sentences that could not be read; checksum: NMEA
            sentences with a wrong checksum; dropped: beyond the rate or size allowed (a flood); truncated: times the
            file became shorter while it was read.
        last: the latest trouble in words.
    """

    accepted: int = 0
    late: int = 0
    repeated: int = 0
    not_finite: int = 0
    missing: int = 0
    jumps: int = 0
    garbled: int = 0
    checksum: int = 0
    dropped: int = 0
    truncated: int = 0
    last_problem: str = ""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """What is known at one moment.

    Attributes:
        time: s on the stream's clock; samples: seen so far, all runs; runs: begun so far.
        names, units: of the free coefficients, k; value, standard_error: (k,), infinite where nothing is known.
        noise: channel -> residual rms, SI.
        untold: coefficients that the data so far do not tell (standard error beyond the value, or a tied direction);
        advice: which manoeuvre would help, in a sentence; empty if nothing is untold.
    """

    time: float
    samples: int
    runs: int
    phase: EstimatorPhase
    names: tuple[str, ...]
    units: tuple[str, ...]
    value: Array
    standard_error: Array
    noise: dict[str, float] = field(default_factory=dict)
    unidentified: tuple[str, ...] = ()
    advice: str = ""
    change: CoefficientChange | None = None
    findings: tuple[Finding, ...] = ()
