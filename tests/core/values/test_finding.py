"""Findings in order."""

from seatrial.core.values import Finding, Severity, worst_first


def test_errors_come_first_and_findings_of_one_severity_keep_their_order() -> None:
    severities = [Severity.INFO, Severity.WARNING, Severity.ERROR, Severity.ERROR]
    findings = [Finding(severity, code, "a sentence") for code, severity in zip("abcd", severities, strict=True)]
    assert [finding.code for finding in worst_first(findings)] == ["c", "d", "b", "a"]
