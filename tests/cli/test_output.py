"""What identify prints of a fit: intervals, what the records cannot tell, and nothing of what was not examined."""

from dataclasses import replace

import pytest
from tests.reporting.complete_fit import baselines, complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_study import fabricated_study

from seatrial.cli.output import print_fit, print_study, progress_reporter


def printed(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().out


def test_intervals_floor_extrapolation_and_what_is_not_identifiable_are_printed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    fit = complete_fit(fabricated_fit())
    print_fit(fit)
    text = printed(capsys)
    assert "overshoot_1_deg: 8.42 [8.083, 8.715], measured 8.31" in text
    assert "process noise alone: heading 1.4 deg" in text and "extrapolation index 1.90: beyond" in text
    assert "the records determine about 6 of 11 free coefficients" in text
    assert fit.identifiability is not None and fit.identifiability.structural[0].text in text
    assert fit.noise_model is not None and fit.noise_model.text in text
    ahead = "samples ahead 1 (0.2 s) to 10 (2 s), held-out runs, rms: r 0.012 to 0.115 deg/s, psi 0.012 to 0.115 deg"
    assert ahead in text
    assert "frequency response, model inside the records' 95 % region: v/delta" in text


def test_what_was_not_examined_is_not_printed(capsys: pytest.CaptureFixture[str]) -> None:
    fit = fabricated_fit()
    print_fit(replace(fit, predictions=tuple(replace(p, measures={}) for p in fit.predictions)))
    text = printed(capsys)
    assert "validation zigzag_25_25: rms" in text
    assert not any(word in text for word in ("determine", "not identifiable", "noise alone", "extrapolation", "tied"))


def test_other_estimators_stand_in_one_table(capsys: pytest.CaptureFixture[str]) -> None:
    plain = fabricated_fit()
    print_fit(plain)
    assert "other estimators" not in printed(capsys)
    print_fit(replace(plain, baselines=baselines(plain)))
    lines = printed(capsys).splitlines()
    (head,) = [k for k, line in enumerate(lines) if line.startswith("other estimators")]
    assert "errors, %" in lines[head]
    assert lines[head + 2].split()[:5] == ["weak", "form", "5", "5", "0.8"]
    assert lines[head + 4].endswith("diverges in 1 of 4 runs, zigzag_25_25 first")
    assert lines[head + 5].endswith("failed: run a is too short")
    assert "[lasso-dropped] ridge: Lasso drops" in lines[head + 6]
    assert "prove nothing about coefficients" in lines[head + 7]


def test_a_study_ends_with_the_three_counts_of_its_checks(capsys: pytest.CaptureFixture[str]) -> None:
    print_study(fabricated_study(fabricated_fit()))
    lines = printed(capsys).splitlines()
    assert lines[-2:] == [
        "claims: 1 confirmed, 1 holds in its own setting, 1 refuted, 1 unknowable",
        "checks: 1 holding, 1 failing, 1 withdrawn",
    ]
    assert any(line.strip().startswith("FAILS") and line.endswith("few runs") for line in lines)
    assert lines[1] == "Not all of them: the fit has two optima."
    assert any(". Setting: search box about the truth" in line for line in lines)


def test_off_a_terminal_each_phase_is_reported_once(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_reporter() as report_progress:
        for count in range(1, 40):
            report_progress(f"12 segments, evaluation {count}: {1e3 / count:.6g}")
        for name in ("cubic", "linear"):
            report_progress(f"family: {name}")
        report_progress("13 segments, evaluation 1: 5")
    assert capsys.readouterr().err.splitlines() == ["12 segments, evaluation 1: 1000", "family: cubic"]
