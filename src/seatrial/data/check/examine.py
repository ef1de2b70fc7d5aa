"""All checks on one record."""

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.channels import channel_findings, lag_findings
from seatrial.data.check.conventions import canonical_record, with_standard_signs
from seatrial.data.check.kinematic_consistency import kinematic_consistency_findings
from seatrial.data.check.repair import repair
from seatrial.data.check.rudder import rudder_findings
from seatrial.data.check.run_phases import phase_findings
from seatrial.data.check.timestamps import rebuild_time_base
from seatrial.data.check.velocity_conventions import velocity_convention_findings
from seatrial.data.check.yaw_rate_consistency import yaw_rate_findings

_SEVERITY_ORDER = {Severity.ERROR: 0, Severity.WARNING: 1, Severity.INFO: 2}
_CHECKS_WITH_STANDARD_SIGNS = (
    velocity_convention_findings,
    kinematic_consistency_findings,
    yaw_rate_findings,
    rudder_findings,
    lag_findings,
    phase_findings,
)


def examine(record: Record) -> tuple[Finding, ...]:
    """Everything the checks find on a record as it was read, gravest first.

    The declared conventions are judged, never changed: ERROR where the data contradict them clearly, WARNING where
    they may. Includes the findings of `timebase` and `repair`.

    Raises:
        InputError: a channel holds no value, or a positive direction is unknown.
    """
    clean, mended = repaired_record(record)
    declared = with_standard_signs(clean)
    found = [*channel_findings(record), *mended]
    for check in _CHECKS_WITH_STANDARD_SIGNS:
        found += check(declared)
    return tuple(sorted(found, key=lambda finding: _SEVERITY_ORDER[finding.severity]))


def repaired_record(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """`timebase`, then `repair`: evenly sampled and complete, conventions as declared.

    Raises:
        InputError: see `timebase` and `repair`.
    """
    even, stamped = rebuild_time_base(record)
    clean, mended = repair(even)
    return clean, stamped + mended


def prepared_record(record: Record, reference_point: float = 0.0) -> tuple[Record, tuple[Finding, ...]]:
    """`timebase`, `repair` and `canonical` in a row: what a model can be compared with.

    Raises:
        InputError: see `timebase`, `repair` and `canonical`.
    """
    clean, findings = repaired_record(record)
    return canonical_record(clean, reference_point), findings
