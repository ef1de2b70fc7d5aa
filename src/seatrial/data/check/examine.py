"""One record repaired and checked, in one pass."""

from dataclasses import dataclass

from seatrial.core.values import Finding, Record, worst_first
from seatrial.data.check.channels import channel_findings, lag_findings
from seatrial.data.check.conventions import with_standard_signs
from seatrial.data.check.dropped_rows import dropped_rows_findings
from seatrial.data.check.feedback import feedback_findings
from seatrial.data.check.kinematic_consistency import kinematic_consistency_findings
from seatrial.data.check.repair import repair
from seatrial.data.check.rudder import rudder_findings
from seatrial.data.check.run_phases import phase_findings
from seatrial.data.check.timestamps import rebuild_time_base
from seatrial.data.check.velocity_conventions import velocity_convention_findings
from seatrial.data.check.yaw_rate_consistency import yaw_rate_findings

_CHECKS_WITH_STANDARD_SIGNS = (
    velocity_convention_findings, kinematic_consistency_findings, yaw_rate_findings, rudder_findings, lag_findings,
    phase_findings,
    feedback_findings,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class ExaminedRecord:
    """A record repaired once, and all that was found on the way.

    Attributes:
        record: evenly sampled and complete, conventions as declared.
        findings: of the checks and of the repairs, gravest first.
    """

    record: Record
    findings: tuple[Finding, ...]


def examined_record(record: Record) -> ExaminedRecord:
    """Repair a record as it was read and check it.

    The declared conventions are judged, never changed: ERROR where the data contradict them clearly, WARNING where
    they may.

    Raises:
        InputError: a channel holds no value, too few samples remain, or a positive direction is unknown.
    """
    even, time_findings = rebuild_time_base(record)
    complete, repair_findings = repair(even)
    declared = with_standard_signs(complete)
    findings = [
        *channel_findings(record), *time_findings, *repair_findings, *dropped_rows_findings(record, even, complete)
    ]  # fmt: skip
    for check in _CHECKS_WITH_STANDARD_SIGNS:
        findings += check(declared)
    return ExaminedRecord(complete, tuple(worst_first(findings)))


def examine(record: Record) -> tuple[Finding, ...]:
    """Return what `examined_record` finds.

    Raises:
        InputError: as `examined_record`.
    """
    return examined_record(record).findings
