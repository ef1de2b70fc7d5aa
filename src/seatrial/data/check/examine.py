"""All checks on one record."""

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.channels import channel_findings, lag_findings
from seatrial.data.check.closure import closure_findings
from seatrial.data.check.conventions import canonical, signed
from seatrial.data.check.frames import frame_findings
from seatrial.data.check.mend import repair
from seatrial.data.check.phases import phase_findings
from seatrial.data.check.rates import rate_findings
from seatrial.data.check.rudder import rudder_findings
from seatrial.data.check.stamps import timebase

_ORDER = {Severity.ERROR: 0, Severity.WARNING: 1, Severity.INFO: 2}
_DYNAMIC = (frame_findings, closure_findings, rate_findings, rudder_findings, lag_findings, phase_findings)


def examine(record: Record) -> tuple[Finding, ...]:
    """Everything the checks find on a record as it was read, gravest first.

    The declared conventions are judged, never changed: ERROR where the data contradict them clearly, WARNING where
    they may. Includes the findings of `timebase` and `repair`.

    Raises:
        InputError: a channel holds no value, or a positive direction is unknown.
    """
    clean, mended = mended_record(record)
    declared = signed(clean)
    found = [*channel_findings(record), *mended]
    for check in _DYNAMIC:
        found += check(declared)
    return tuple(sorted(found, key=lambda finding: _ORDER[finding.severity]))


def mended_record(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """`timebase`, then `repair`: evenly sampled and complete, conventions as declared.

    Raises:
        InputError: see `timebase` and `repair`.
    """
    even, stamped = timebase(record)
    clean, mended = repair(even)
    return clean, stamped + mended


def prepared(record: Record, reference_point: float = 0.0) -> tuple[Record, tuple[Finding, ...]]:
    """`timebase`, `repair` and `canonical` in a row: what a model can be compared with.

    Raises:
        InputError: see `timebase`, `repair` and `canonical`.
    """
    clean, findings = mended_record(record)
    return canonical(clean, reference_point), findings
