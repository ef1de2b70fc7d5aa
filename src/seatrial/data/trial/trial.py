"""A trial: ship, runs, model and settings, from a trial file or made in Python."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Self

from seatrial.core.equations import Model
from seatrial.core.values import Finding, ForcePoints, Record, RecordKind, Ship
from seatrial.data.trial.craft_tables import Feedback
from seatrial.data.trial.design_request import DesignRequest
from seatrial.data.trial.priors import JointPrior
from seatrial.data.trial.run_data import RunFiles, SourceFile
from seatrial.data.trial.settings import CompareSettings, EstimateSettings, ModelFamily, ProposalSettings, Stream
from seatrial.physics.sea.spectrum import WaveEncounter

if TYPE_CHECKING:
    from seatrial.estimation.estimate.trial_problem import TrialProblem


class Role(StrEnum):
    """What a run is for."""

    TRAIN = "train"
    VALIDATE = "validate"
    LEAVE_OUT = "leave_out"


@dataclass(frozen=True)
class Trimming:
    """Which part of a record is used, and at what rate.

    Attributes:
        skip_acceleration: drop what lies before 90 % of the speed at the first rudder execution.
        from_release: drop what lies before the largest swing of a decay of roll, pitch or heave.
        rate: Hz after resampling; None keeps the record's own.
    """

    skip_acceleration: bool = False
    rate: float | None = None
    from_release: bool = False


@dataclass(frozen=True)
class Run:
    """One run of a trial.

    Attributes:
        data: the record as it was read, in the frames and signs that its channels declare, or its files.
        role: what the run is for.
        session: name of the group of runs that share offsets; empty: the run's own name.
        trimming: which part is used.
        source: where the data come from, for people.
        waves: how the ship met the waves; None: no waves, or the record holds their forces.
        kind: whether the record was measured or simulated; None: as the record itself says.
    """

    data: RunFiles | Record
    role: Role = Role.TRAIN
    session: str = ""
    trimming: Trimming = Trimming()
    source: str = ""
    waves: WaveEncounter | None = None
    kind: RecordKind | None = None

    def with_differences(self, symbols: Collection[str]) -> Self:
        """Return the run with what twins differ by as channels, where that is among these symbols."""
        return replace(self, data=self.data.with_differences(symbols)) if isinstance(self.data, RunFiles) else self

    def __post_init__(self) -> None:
        if not self.session:
            object.__setattr__(self, "session", self.name)

    @property
    def name(self) -> str:
        """Name of the record."""
        return self.data.name

    @property
    def files(self) -> tuple[SourceFile, ...]:
        """The files of the record; empty where the record is given."""
        return self.data.files if isinstance(self.data, RunFiles) else ()

    def raw_record(self) -> Record:
        """Return the record as it was read.

        Raises:
            InputError: its file cannot be read.
        """
        record = self.data if isinstance(self.data, Record) else self.data.read()
        return record if self.kind is None else replace(record, kind=self.kind)


@dataclass(frozen=True, eq=False)
class Trial:
    """Ship, runs and their roles, model, assumptions.

    Made by `load_trial` from a trial file, or in Python:

        runs = (Run(zigzag), Run(turning_circle, Role.VALIDATE))
        trial = Trial(ship, runs, model.with_ship(ship), estimate=EstimateSettings(robust=True))

    Attributes:
        model: with the ship's particulars, the parameter set, fixed and start values, freedom, bounds and priors set.
        noise: channel -> known standard deviation, SI; that of other channels is estimated.
        truth: parameter -> true value where the records are simulated.
        accept: codes of error findings to accept; the run is used despite them.
        reference_point: m forward of midship to which the model's u, v, x0, y0 refer.
        forces: static force points that are fitted with the runs.
        family: models to compare; None: the default family of the model.
        compare: settings of the regressions that a comparison sets beside the fit.
        feedback: the controller that was on in some runs; None: none is declared.
        design_request: the manoeuvre that is to be designed; None: none is.
        stream: the stream that is to be followed; None: none is.
        proposal: for which loop gains are proposed meanwhile; None: for none.
        joint_priors: what earlier results say of several coefficients together, besides the priors of each.
        findings: what is odd about the trial itself: priors beyond their range, force points of unexpected sign.
        path: the trial file; None for a trial made in Python.
    """

    ship: Ship
    runs: tuple[Run, ...]
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
    compare: CompareSettings = field(default_factory=CompareSettings)
    design_request: DesignRequest | None = None
    stream: Stream | None = None
    proposal: ProposalSettings | None = None
    findings: tuple[Finding, ...] = ()
    feedback: Feedback | None = None
    joint_priors: tuple[JointPrior, ...] = ()

    def __repr__(self) -> str:
        roles = ", ".join(f"{len(self.runs_with_role(role))} {role}" for role in Role if self.runs_with_role(role))
        file = f" of '{self.path.name}'" if self.path else ""
        return f"<Trial{file}: {self.ship.name}, model {self.model.name}; runs: {roles or 'none'}>"

    def runs_with_role(self, role: Role) -> tuple[Run, ...]:
        """The runs of one role, in order of their files."""
        return tuple(run for run in self.runs if run.role is role)

    def problem(self) -> "TrialProblem":
        """Return what `identify` minimises first, for any optimiser: residuals, Jacobian, bounds, fitness.

        Raises:
            InputError: the records do not pass the checks, show no excitation, or cannot be compared with the model.
        """
        from seatrial.estimation.estimate.trial_problem import trial_problem

        return trial_problem(self)
