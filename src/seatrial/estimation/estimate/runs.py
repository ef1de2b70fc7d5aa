"""The runs that one estimate is made from, and what else is measured of the ship."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from seatrial.core.values import ForcePoints, Record
from seatrial.data.trial import Feedback, Role, Trial, TrialRecord
from seatrial.data.trial.feedback_table import refuse_unusable_feedback
from seatrial.data.trial.priors import JointPrior
from seatrial.estimation.problem.output_error import DataTerm


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of one ship, all at one sampling rate, and what else is measured of it.

    Attributes:
        records: one for each run, in the notation table's frames, signs and units.
        sessions: of each record, the name of the group with which it shares offsets.
        length: of the ship [m].
        noise: channel -> known standard deviation, SI; that of other channels is estimated.
        forces: tables of static force points that are fitted with the runs.
        feedback: the controller that was on in some of them; None: none is declared.
        carried: information from records that are no longer kept.
        joint_priors: what earlier results say of several coefficients together.
    """

    records: tuple[Record, ...]
    sessions: tuple[str, ...]
    length: float
    noise: Mapping[str, float] = field(default_factory=dict)
    forces: tuple[ForcePoints, ...] = ()
    feedback: Feedback | None = None
    carried: tuple[DataTerm, ...] = ()
    joint_priors: tuple[JointPrior, ...] = ()

    @classmethod
    def one_session_each(cls, records: Sequence[Record], length: float) -> "Runs":
        """Return the runs as sessions of their own, named as the records; length: of the ship [m]."""
        return cls(tuple(records), tuple(record.name for record in records), length)

    def selected(self, indices: Sequence[int]) -> "Runs":
        """Return the runs at these positions; everything else stays."""
        records, sessions = (tuple(column[i] for i in indices) for column in (self.records, self.sessions))
        return replace(self, records=records, sessions=sessions)

    def __len__(self) -> int:
        return len(self.records)


def training_runs(trial: Trial, records: Sequence[TrialRecord]) -> Runs:
    """Return the training runs among the records, with the trial's known noise, force points and controller.

    Raises:
        InputError: the records do not hold what is declared of the controller.
    """
    train = [r for r in records if r.role is Role.TRAIN]
    if trial.feedback is not None:
        refuse_unusable_feedback(trial.feedback, [r.record for r in train], f"{trial.path}: " if trial.path else "")
    sessions = tuple(r.session for r in train)
    return Runs(
        tuple(r.record for r in train), sessions, trial.ship.length, trial.noise, trial.forces, trial.feedback,
        joint_priors=trial.joint_priors,
    )  # fmt: skip
