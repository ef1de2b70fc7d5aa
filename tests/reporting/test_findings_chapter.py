"""The chapter on findings: the most severe first, notes behind a fold."""

from seatrial.core.values import Finding, Severity
from seatrial.reporting.section import finding_section


def test_notes_stand_behind_a_fold_and_warnings_do_not() -> None:
    warned = Finding(Severity.WARNING, "lag", "the rudder is late", advice="shift it")
    noted = [Finding(Severity.INFO, code, "a fact") for code in ("constant", "angle-wrap")]
    *shown, notes = finding_section([*noted, warned]).parts
    assert [part.points for part in shown] == [("the rudder is late",)] and not shown[0].is_folded
    assert notes.title == "2 notes" and notes.is_folded and len(notes.parts) == 2
    assert not any(part.is_folded for part in finding_section([warned]).parts)
    assert not finding_section([])
