"""What identify prints of a fit: verdict, estimates and held-out runs with marks, and nothing that was not examined."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from tests.reporting.complete_fit import baselines, complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_study import fabricated_study

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.result_output import print_fit, print_study
from seatrial.cli.screen import Detail, printing
from seatrial.core.text.words import sentence
from seatrial.core.values import Finding, Severity
from seatrial.data.folder.model_file import model_text
from seatrial.data.folder.result_folder import model_of_fit


def printed(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().out


def test_estimates_carry_unit_meaning_and_where_the_known_value_lies(capsys: pytest.CaptureFixture[str]) -> None:
    fit = fabricated_fit()
    first = replace(fit.coefficients[0], unit="kg", meaning="mass of something", fixed=False, lower=1.0, upper=2.0)
    inside, outside, none = replace(first, truth=1.5), replace(first, truth=2.5), replace(first, lower=None)
    open_sign = replace(first, truth=None, lower=-1.0)
    print_fit(replace(fit, coefficients=(inside, outside, none, open_sign)))
    rows = [line for line in printed(capsys).splitlines() if line.endswith("mass of something")]
    assert [next(m for m in ("inside", "OUTSIDE", "no interval", "sign open") if m in row) for row in rows] == [
        "inside", "OUTSIDE", "no interval", "sign open",
    ]  # fmt: skip
    assert all(" kg " in row for row in rows)


def test_notes_are_counted_and_shown_when_required(capsys: pytest.CaptureFixture[str]) -> None:
    findings = [Finding(Severity.WARNING, "one", "a warning"), Finding(Severity.INFO, "two", "a note")]
    print_warnings(findings)
    text = printed(capsys)
    assert "no errors, 1 warning, 1 note; --verbose shows notes" in text and "a note" not in text
    with printing(Detail.VERBOSE):
        print_warnings(findings)
    assert "note    [two] a note" in printed(capsys)
    print_warnings(findings[1:])
    assert "no errors, no warnings, 1 note; --verbose shows notes" in printed(capsys)
    print_warnings([])
    assert printed(capsys) == ""


def test_a_held_out_run_shows_errors_noise_and_measures_with_their_marks(capsys: pytest.CaptureFixture[str]) -> None:
    print_fit(complete_fit(fabricated_fit()))
    lines = printed(capsys).splitlines()
    (overshoot,) = [line.split() for line in lines if line.startswith("  1st overshoot, deg")]
    assert overshoot[3:8] == ["8.31", "8.42", "[8.08,", "8.71]", "(inside)"]
    (heading,) = [line.split() for line in lines if line.startswith("  heading, deg")]
    assert "1.40" in heading, "what process noise alone leaves"
    assert any(line.startswith("  Extrapolation index 1.9:") for line in lines)


def test_measures_that_are_not_determined_have_no_mark(capsys: pytest.CaptureFixture[str]) -> None:
    fit = complete_fit(fabricated_fit())
    (held,) = fit.validation
    loose = replace(held, measures={"advance_L": replace(held.measures["overshoot_1_deg"], is_determined=False)})
    print_fit(replace(fit, predictions=(*(p for p in fit.predictions if p is not held), loose)))
    (row,) = [line.split() for line in printed(capsys).splitlines() if line.startswith("  advance over ground, L")]
    assert row[4:] == ["8.31", "not", "determined"]


def test_with_verbose_it_prints_what_the_estimate_rests_on(capsys: pytest.CaptureFixture[str]) -> None:
    fit = complete_fit(fabricated_fit())
    print_fit(fit)
    short = printed(capsys)
    with printing(Detail.VERBOSE):
        print_fit(fit)
    text = printed(capsys)
    assert fit.identifiability is not None and fit.noise_model is not None
    details = (
        sentence(fit.identifiability.structural[0].text), sentence(fit.noise_model.text),
        "Prediction some samples ahead", "Frequency response: records and model",
    )  # fmt: skip
    assert all(detail in text and detail not in short for detail in details)


def test_with_quiet_nothing_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with printing(Detail.QUIET):
        print_fit(complete_fit(fabricated_fit()))
        print_study(fabricated_study(fabricated_fit()))
    assert printed(capsys) == ""


def test_what_was_not_examined_is_not_printed(capsys: pytest.CaptureFixture[str]) -> None:
    fit = fabricated_fit()
    print_fit(replace(fit, predictions=tuple(replace(p, measures={}) for p in fit.predictions)))
    text = printed(capsys)
    assert "Held out: zigzag_25_25" in text
    assert not any(word in text for word in ("determine", "not identifiable", "process noise", "extrapolation", "tied"))


def test_other_estimators_stand_in_one_table(capsys: pytest.CaptureFixture[str]) -> None:
    plain = fabricated_fit()
    print_fit(plain)
    assert "Other estimators" not in printed(capsys)
    print_fit(replace(plain, baselines=baselines(plain)))
    lines = printed(capsys).splitlines()
    (head,) = [k for k, line in enumerate(lines) if line.startswith("Other estimators")]
    assert "prove nothing about coefficients" in lines[head + 2]
    assert lines[head + 3].split() == ["errors,", "median,", "%", "worst,", "%"]
    assert lines[head + 5].split() == ["weak", "form", "5.0", "5.0"]
    assert lines[head + 7].endswith("diverges in 1 of 4 runs, zigzag_25_25 first")
    assert lines[head + 8].endswith("failed: run a is too short")


def test_a_study_answers_first_and_counts_its_checks(capsys: pytest.CaptureFixture[str]) -> None:
    print_study(fabricated_study(fabricated_fit()))
    lines = printed(capsys).splitlines()
    assert lines[3:5] == [
        "claims: 1 confirmed, 1 holds in its own setting, 1 refuted, 1 unknowable",
        "checks: 1 holding, 1 failing, 1 withdrawn",
    ]
    assert any(" fails " in line and line.endswith("few runs") for line in lines)
    assert lines[2] == "Not all of them: the fit has two optima."
    assert any("holds in its own setting (search box about the truth)" in line for line in lines)


def test_a_warning_of_the_fit_goes_with_its_model_file_and_is_printed_where_that_simulates(
    run_command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lasting = Finding(Severity.WARNING, "held-coupling", "alpha is held at 0")
    other = Finding(Severity.WARNING, "closure", "the log is off")
    file = model_of_fit(replace(fabricated_fit(), findings=(lasting, other)))
    assert file.provenance.warnings == ("[held-coupling] alpha is held at 0",)
    path = tmp_path / "model.toml"
    path.write_text(model_text(file))
    manoeuvre = ("--manoeuvre", "turning-circle:35", "--set", "v_j=1.866", "--duration", "20")
    assert run_command("simulate", path, *manoeuvre, "--out", tmp_path / "turn.csv") == 0
    text = capsys.readouterr().out
    assert "of the fit: [held-coupling] alpha is held at 0" in text
    assert "the log is off" not in text
