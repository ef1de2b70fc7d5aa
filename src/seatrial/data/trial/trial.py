"""A trial: what a trial file says, validated. Values only."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from seatrial.core.equations import Model
from seatrial.core.results import Actuator, TrialLimits
from seatrial.core.values import Finding, ForcePoints, Record, Ship
from seatrial.data.read import Layout
from seatrial.data.trial.settings import EstimateSettings, ModelFamily
from seatrial.physics.hydro.excitation import Excitation
from seatrial.physics.sea.spectrum import Spectrum


class Role(StrEnum):
    """What a run is for."""

    TRAIN = "train"
    VALIDATE = "validate"
    LEAVE_OUT = "leave_out"


def run_name(path: Path) -> str:
    """The name of a run's file without its ending, ``.gz`` included."""
    return Path(path.name.removesuffix(".gz")).stem


@dataclass(frozen=True)
class Trimming:
    """Which part of a record is used, and at what rate.

    Attributes:
        from_s, to_s: s on the record's own clock; None keeps the end.
        skip_acceleration: drop what lies before 90 % of the speed at the first rudder execution.
        from_release: drop what lies before the largest roll angle of a decay.
        rate: Hz after resampling; None keeps the record's own.
    """

    from_s: float | None = None
    to_s: float | None = None
    skip_acceleration: bool = False
    rate: float | None = None
    from_release: bool = False


@dataclass(frozen=True)
class WaveEncounter:
    """How a run met the waves: ship speed [m/s], heading [rad, 0 following, pi head], and what they do to her.

    `spectrum`: of the sea, where its elevation was not recorded.
    """

    excitation: Excitation
    U: float
    beta: float
    spectrum: Spectrum | None = None


@dataclass(frozen=True)
class TrialRun:
    """One record file of the trial: where it lies, how to parse it, what it is for, what it shares offsets with.

    raw: the record as it was read where it has been read already; the file is then left alone.
    """

    path: Path
    layout: Layout
    role: Role
    session: str
    trimming: Trimming = Trimming()
    source: str = ""
    waves: WaveEncounter | None = None
    raw_record: Record | None = field(default=None, compare=False, repr=False)

    @property
    def name(self) -> str:
        """The file's name without its ending."""
        return run_name(self.path)


@dataclass(frozen=True)
class DesignRequest:
    """What a manoeuvre that is to be designed must keep to, SI.

    Attributes:
        duration: s; rate: Hz at which the sensors are recorded.
        actuators: inputs that may be moved; held: the other inputs, constant, in the record's signs.
        limits: what the trial may not leave.
        speed: approach speed u [m/s]; None: where surge balances.
        criterion: ``worst`` or ``mean`` relative standard error.
        draws: ships drawn from the prior; prior: by what share coefficients without a prior may differ.
    """

    duration: float
    rate: float
    actuators: tuple[Actuator, ...]
    held: Mapping[str, float] = field(default_factory=dict)
    limits: TrialLimits = field(default_factory=TrialLimits)
    speed: float | None = None
    criterion: str = "worst"
    draws: int = 24
    prior_fraction: float = 0.3


class StreamSource(StrEnum):
    """Where the samples of a stream come from; NMEA 0183 sentences or lines of columns."""

    FILE = "file"
    STDIN = "stdin"
    UDP = "udp"
    NMEA_FILE = "nmea-file"
    NMEA_STDIN = "nmea-stdin"
    NMEA_UDP = "nmea-udp"


@dataclass(frozen=True)
class Stream:
    """Samples that come while the record is being made, SI.

    Attributes:
        feed: where they come from; layout: which column is what; rate: Hz, nominal.
        name: of the runs it makes, as the stem of a file names a record's.
        file: of a feed from a file; host, port: on which UDP is listened to.
        waves: how the ship meets them, for an elevation in the stream.
        whole: s over which the batch criterion is kept; forgetting: s after which the past counts 1/e, None for ever.
        longest_gap: s without a sample after which a new run begins.
        page: port of the local page, 0 none; journal: where what was admitted is kept, None beside the result.
    """

    source: StreamSource
    layout: Layout
    rate: float
    name: str = "stream"
    file: Path | None = None
    host: str = "127.0.0.1"
    port: int = 0
    waves: WaveEncounter | None = None
    batch_window: float = 3600.0
    forgetting_time: float | None = None
    longest_gap: float = 30.0
    page_port: int = 0
    journal: Path | None = None


@dataclass(frozen=True, eq=False)
class Trial:
    """Ship, runs and their roles, model, assumptions.

    Attributes:
        model: with the ship's particulars, the parameter set, fixed and start values, freedom, bounds and priors set.
        noise: channel -> known standard deviation, SI; empty: estimated.
        truth: parameter -> true value where the records are simulated.
        accept: codes of error findings the user takes upon himself.
        reference_point: m forward of midship to which the model's u, v, x0, y0 refer.
        forces: static force points that are fitted beside the runs.
        family: models to compare; None: the family of the house.
        design: the manoeuvre that is to be designed; None: none is.
        follow: the stream that is to be followed; None: none is.
        findings: what is odd about the trial itself: priors beyond their range, force points of unexpected sign.
        path: the trial file; None for a trial made in Python.
    """

    ship: Ship
    runs: tuple[TrialRun, ...]
    model: Model
    estimate: EstimateSettings = field(default_factory=EstimateSettings)
    noise: Mapping[str, float] = field(default_factory=dict)
    truth: Mapping[str, float] = field(default_factory=dict)
    accept: tuple[str, ...] = ()
    reference_point: float = 0.0
    question: str = ""
    path: Path | None = None
    forces: tuple[ForcePoints, ...] = ()
    family: ModelFamily | None = None
    design_request: DesignRequest | None = None
    stream: Stream | None = None
    findings: tuple[Finding, ...] = ()

    def runs_with_role(self, role: Role) -> tuple[TrialRun, ...]:
        """The runs of one role, in order of their files."""
        return tuple(run for run in self.runs if run.role is role)
