"""The five rows: what each says, and when it is a warning."""

from dataclasses import replace

from seatrial.core.results import ChannelScore, Fit, Measure, WindowBaseline, WindowScore
from seatrial.core.values import Severity
from seatrial.reporting.first_screen import KeyFact
from seatrial.reporting.key_facts import first_screen, key_facts


def rows(fit: Fit) -> dict[str, KeyFact]:
    return {fact.name: fact for fact in key_facts(fit)}


def with_windows(fit: Fit, own: float, other: float, inside: float = 0.96) -> Fit:
    score = {"psi_deg": ChannelScore(own, 90.0, 0.9, inside)}
    baseline = WindowBaseline("constant course and speed", {"psi_deg": ChannelScore(other, 10.0, 0.1)})
    window = WindowScore("5 L", 60.0, 4, score, (baseline,))
    runs = tuple(replace(p, windows=(window,)) if p.role == "validation" else p for p in fit.predictions)
    return replace(fit, predictions=runs)


def test_there_are_five_rows_each_with_its_section(fit: Fit) -> None:
    facts = key_facts(fit)
    assert len(facts) == 5 and {f.section for f in facts} <= {"prediction", "identifiability", "findings", "", "method"}


def test_a_baseline_that_is_better_is_a_warning(fit: Fit) -> None:
    better, worse = rows(with_windows(fit, 1.0, 3.0)), rows(with_windows(fit, 3.0, 1.0))
    assert better["Closest baseline"].is_good and "this fit is best" in better["Closest baseline"].text
    fact = worse["Closest baseline"]
    assert fact.is_good is False
    assert "3.0° by this fit, 1.0° by constant course and speed; better without this fit" in fact.text
    assert rows(fit)["Baseline"].text == "none compared"


def test_coverage_counts_values_and_samples(fit: Fit) -> None:
    fact = rows(with_windows(fit, 1.0, 3.0, inside=0.82))["Inside 95 % intervals"]
    assert "82 % of the samples of heading" in fact.text and fact.is_good is False
    p = next(p for p in fit.predictions if p.role == "validation")
    one = replace(p, measures={"overshoot_1_deg": Measure(8.0, 8.1, 7.5, 8.6)})
    alone = replace(fit, predictions=(one,))
    assert rows(alone)["Inside 95 % intervals"].text == "1 of 1 measured manoeuvring values"


def test_warnings_name_findings_and_a_search_that_did_not_converge(fit: Fit) -> None:
    codes = [f.code for f in fit.findings if f.severity is not Severity.INFO]
    assert rows(fit)["Warnings"].text == ", ".join(codes) and not rows(fit)["Warnings"].is_good
    quiet = replace(fit, findings=())
    assert rows(quiet)["Warnings"].text == "none" and rows(quiet)["Warnings"].is_good


def test_the_picture_is_the_worst_held_out_run_with_its_heading(fit: Fit) -> None:
    screen = first_screen(fit, 9.8)
    assert "zigzag_25_25" in screen.caption and screen.figure.count('"label"') == 1 and "ψ [deg]" in screen.figure
    assert first_screen(replace(fit, predictions=()), 9.8).figure == ""
