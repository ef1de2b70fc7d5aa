"""Errors and findings: messages for bad input, and findings with the worst first."""

import pickle

from seatrial.core.values import Finding, InputError, Severity, worst_first


def test_a_message_that_quotes_a_long_text_is_cut_in_its_middle() -> None:
    text = str(InputError(f"there is no file '{'x' * 4000}'; check the name"))
    assert text.startswith("there is no file 'xxx")
    assert " … " in text
    assert text.endswith("xxx'; check the name")
    assert len(text) < 700


def test_what_would_steer_a_terminal_is_escaped() -> None:
    assert str(InputError("no column '\x1b[2J\u202e'")) == r"no column '\x1b[2J\u202e'"


def test_a_message_survives_the_way_between_processes() -> None:
    assert str(pickle.loads(pickle.dumps(InputError("a 'b'; c")))) == "a 'b'; c"


def test_errors_come_first_and_findings_of_one_severity_keep_their_order() -> None:
    severities = [Severity.INFO, Severity.WARNING, Severity.ERROR, Severity.ERROR]
    findings = [Finding(severity, code, "a sentence") for code, severity in zip("abcd", severities, strict=True)]
    assert [finding.code for finding in worst_first(findings)] == ["c", "d", "b", "a"]
