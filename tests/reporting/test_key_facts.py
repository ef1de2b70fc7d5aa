"""The five rows: what each says, and when it is a warning."""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.results import ChannelScore, Divergence, Fit, Measure, WindowBaseline, WindowScore
from seatrial.core.results.fit import Collinearity
from seatrial.core.values import Record, Severity
from seatrial.numerics.optimise import Status
from seatrial.reporting.first_screen import KeyFact
from seatrial.reporting.key_facts import first_screen, key_facts
from seatrial.reporting.runs import _ranged
from seatrial.reporting.windows import baseline_sentence, shortest_judged


def rows(fit: Fit) -> dict[str, KeyFact]:
    return {fact.name: fact for fact in key_facts(fit)}


def with_windows(fit: Fit, own: float, other: float, inside: float = 0.96) -> Fit:
    score = {"psi_deg": ChannelScore(own, 90.0, 0.9, inside)}
    baseline = WindowBaseline("constant course and speed", {"psi_deg": ChannelScore(other, 10.0, 0.1)})
    window = WindowScore("5 L", 60.0, 4, score, (baseline,))
    runs = tuple(replace(p, windows=(window,)) if p.role == "validation" else p for p in fit.predictions)
    return replace(fit, predictions=runs)


def test_there_are_five_rows_and_what_is_missing_each_with_its_section(fit: Fit) -> None:
    facts = key_facts(fit)
    assert len(facts) == 6 and facts[-2].name == "Not in the training runs"
    assert {f.section for f in facts} <= {"prediction", "identifiability", "findings", "", "method"}


def test_a_baseline_that_is_better_is_a_warning(fit: Fit) -> None:
    better, worse = rows(with_windows(fit, 1.0, 3.0)), rows(with_windows(fit, 3.0, 1.0))
    assert better["Closest baseline"].is_good and "this fit is best" in better["Closest baseline"].text
    fact = worse["Closest baseline"]
    assert fact.is_good is False
    assert "3.0° by this fit, 1.0° by constant course and speed; better without this fit" in fact.text
    assert rows(fit)["Baseline"].text == "none compared"


def test_coverage_counts_values_and_samples(fit: Fit) -> None:
    fact = rows(with_windows(fit, 1.0, 3.0, inside=0.82))["Inside 95 % intervals"]
    assert "82 % of the samples of heading, in windows of 5 L" in fact.text
    assert fact.is_good is False
    p = next(p for p in fit.predictions if p.role == "validation")
    one = replace(p, measures={"overshoot_1_deg": Measure(8.0, 8.1, 7.5, 8.6)})
    alone = replace(fit, predictions=(one,))
    assert rows(alone)["Inside 95 % intervals"].text == "1 of 1 measured manoeuvring values"


def test_runs_simulated_whole_that_leave_their_bands_are_counted_beside_the_windows(fit: Fit) -> None:
    kept = with_windows(fit, 1.0, 3.0)
    (p,) = kept.validation
    apart = np.abs(p.measured["psi"] - p.simulated["psi"])
    for quantile, text in ((0.3, "simulated whole, 30 % of the heading of a run"), (0.7, "simulated whole, 70 % of")):
        half = np.full(len(apart), float(np.quantile(apart, quantile)))
        fact = rows(replace(kept, predictions=(replace(p, half_width={"psi": half}),)))["Inside 95 % intervals"]
        assert text in fact.text and (fact.is_good is False) == (quantile < 0.5)
    wide = replace(p, half_width={"psi": np.full(len(apart), 10.0)})
    fact = rows(replace(kept, predictions=(wide,)))["Inside 95 % intervals"]
    assert "simulated whole" not in fact.text and fact.is_good is None and "times as wide as the error" in fact.text


def test_bands_much_wider_than_the_error_are_no_tick(fit: Fit) -> None:
    """By hand: r^2 = 0.99 is an error of a tenth of the motion, so that a band of 0.61 of it is 6.1 times the error."""
    kept = with_windows(fit, 1.0, 3.0)
    (p,) = kept.validation
    (w,) = p.windows
    for band, is_good in ((0.2, True), (0.61, None)):
        scores = {"psi_deg": ChannelScore(0.1, 90.0, 0.99, inside_band=1.0, band_share=band)}
        judged = replace(p, windows=(replace(w, scores=scores),), half_width={})
        fact = rows(replace(kept, predictions=(judged,)))["Inside 95 % intervals"]
        assert fact.is_good is is_good
        assert ("cautious: bands 6.1 times as wide as the error" in fact.text) == (is_good is None)


def test_a_fit_that_is_best_over_the_longest_windows_only_does_not_claim_all(fit: Fit) -> None:
    kept = with_windows(fit, 1.0, 3.0)
    (p,) = kept.validation
    (longest,) = p.windows
    rival = WindowBaseline("NARX", {"psi_deg": ChannelScore(0.5, 90.0, 0.9)})
    short = replace(longest, window="1 L", seconds=12.0, baselines=(rival,))
    both = replace(kept, predictions=(replace(p, windows=(short, longest)),))
    fact = rows(both)["Closest baseline"]
    assert "best in every quantity over the longest windows, not in heading over 1 L (NARX)" in fact.text
    assert fact.is_good is None


def test_an_interval_that_cannot_fail_is_no_tick(fit: Fit) -> None:
    (p,) = fit.validation
    wide = {"overshoot_1_deg": Measure(8.0, 8.1, -30.0, 40.0)}
    one = replace(fit, predictions=(replace(p, measures=wide, windows=()),))
    fact = rows(one)["Inside 95 % intervals"]
    assert fact.text == "too wide to test anything: 1 manoeuvring value"
    assert fact.is_good is False
    both = replace(p, windows=(), measures=wide | {"overshoot_2_deg": Measure(8.0, 8.1, 7.0, 9.0)})
    fact = rows(replace(fit, predictions=(both,)))["Inside 95 % intervals"]
    assert fact.text == "1 of 1 measured manoeuvring values; too wide to test anything: 1 manoeuvring value"
    assert fact.is_good is True
    missed = replace(p, windows=(), measures={"overshoot_1_deg": Measure(50.0, 8.1, -30.0, 40.0)})
    assert rows(replace(fit, predictions=(missed,)))["Inside 95 % intervals"].is_good is False


def test_a_band_wider_than_the_motion_is_no_tick(fit: Fit) -> None:
    scored = with_windows(fit, 1.0, 3.0, inside=1.0)
    (p,) = scored.validation
    scores = {key: replace(score, band_share=1.2) for key, score in p.windows[0].scores.items()}
    wide = replace(p, measures={}, windows=(replace(p.windows[0], scores=scores),))
    fact = rows(replace(scored, predictions=(wide,)))["Inside 95 % intervals"]
    assert fact.text.startswith("too wide to test anything: the band of heading")
    assert fact.is_good is False


def test_warnings_name_findings_and_a_search_that_did_not_converge(fit: Fit) -> None:
    codes = [f.code for f in fit.findings if f.severity is not Severity.INFO]
    assert rows(fit)["Warnings"].text == ", ".join(codes) and not rows(fit)["Warnings"].is_good
    quiet = replace(fit, findings=())
    assert rows(quiet)["Warnings"].text == "none" and rows(quiet)["Warnings"].is_good


def test_the_picture_is_the_worst_held_out_run_with_its_heading(fit: Fit) -> None:
    screen = first_screen(fit, 9.8)
    assert "zigzag_25_25" in screen.caption and screen.figure.count('"label"') == 1 and "ψ [deg]" in screen.figure
    assert first_screen(replace(fit, predictions=()), 9.8).figure == ""


def test_the_band_of_a_run_without_a_track_is_not_compared_with_one(fit: Fit) -> None:
    assert first_screen(fit, 9.8).caption.endswith("as wide as the track is long.")
    bare = [replace(p, measured=p.measured.without("x0", "y0")) for p in fit.predictions]
    assert first_screen(replace(fit, predictions=tuple(bare)), 9.8).caption.endswith("Pale: 95 % band.")


def test_the_extrapolation_index_names_what_it_compares(fit: Fit) -> None:
    (run,) = [p.measured for p in fit.validation]
    assert _ranged([run]) == "yaw rate, drift, rudder or speed"
    still = np.zeros(len(run))
    waves = Record.from_arrays("waves", run.time, {"zeta": still, "z": still})
    decay = Record.from_arrays("decay", run.time, {"phi": still})
    assert _ranged([waves]) == "heave, pitch or elevation of the waves" and _ranged([decay]) == "roll angle"


def test_a_search_that_did_not_converge_comes_first(fit: Fit) -> None:
    stalled = replace(fit, solution=replace(fit.solution, status=Status.STALLED))
    assert key_facts(stalled)[0].name == "Warnings" and "did not converge" in key_facts(stalled)[0].text
    assert first_screen(stalled, 9.8).verdict.startswith("Do not use the coefficients: the search did not converge")
    assert rows(stalled)["Identifiability"].is_good is False


def test_collinear_coefficients_are_not_determined_one_by_one(fit: Fit) -> None:
    assert fit.identifiability is not None
    tied = replace(fit.identifiability, collinearity=(Collinearity("N_v", 140.0, "N_r", -0.99),))
    fact = rows(replace(fit, identifiability=tied))["Identifiability"]
    assert fact.is_good is False and "N_v only together with others (variance inflation up to 140)" in fact.text


def test_windows_that_diverge_have_no_better_baseline(fit: Fit) -> None:
    lost = with_windows(fit, math.inf, 1.0)
    run = lost.validation[0]
    windows = tuple(replace(w, diverged=3) for w in run.windows)
    lost = replace(lost, predictions=(replace(run, windows=windows),))
    fact = rows(lost)["Closest baseline"]
    assert fact.is_good is False and "the model diverges in 3 of 4 windows of 5 L" in fact.text
    assert windows[0].better_baselines == {}
    text = baseline_sentence(lost.validation, {"psi_deg": ("heading", "deg")})
    assert "diverges in 3 of 4 windows" in text and "without this fit" not in text


def test_windows_shorter_than_a_roll_period_are_no_reproach(fit: Fit) -> None:
    better = with_windows(fit, 1.0, 0.5)
    labels = {"psi_deg": ("heading", "deg")}
    seconds = max(w.seconds for p in better.validation for w in p.windows)
    assert "do not rely on it" in baseline_sentence(better.validation, labels, seconds)
    assert baseline_sentence(better.validation, labels, 1.01 * seconds) == ""
    assert shortest_judged(fit) == 0.0


def test_what_process_noise_leaves_stands_with_the_error(fit: Fit) -> None:
    (run, *_) = fit.validation
    floor = replace(run, noise_floor={"psi_deg": 0.5 * run.rms["psi_deg"]})
    assert (
        "process noise as estimated, model error in it, would leave"
        in rows(replace(fit, predictions=(floor,)))["Error, held out (rms)"].text
    )


def test_one_run_diverges(fit: Fit) -> None:
    (run, *_) = fit.validation
    lost = replace(run, divergence=Divergence(70.0, 65.0, "r"))
    assert rows(replace(fit, predictions=(lost,)))["Error, held out (rms)"].text == "1 run diverges"


def test_a_velocity_that_a_baseline_predicts_better_is_no_best_in_every_quantity(fit: Fit) -> None:
    scored = with_windows(fit, 1.0, 3.0)
    (p,) = scored.validation
    window = p.windows[0]
    (rival, *_) = window.baselines
    own, others = window.scores["psi_deg"], rival.scores["psi_deg"]
    baseline = replace(rival, scores=rival.scores | {"r": replace(others, rms=0.01)})
    both = replace(window, scores=window.scores | {"r": replace(own, rms=0.02)}, baselines=(baseline,))
    fact = rows(replace(scored, predictions=(replace(p, windows=(both,)),)))["Closest baseline"]
    assert fact.text.endswith(f"; without this fit r by {rival.name} is better")
    assert fact.is_good is False


def test_fitted_runs_that_are_missed_are_a_row_of_their_own(fit: Fit) -> None:
    first, *rest = (p for p in fit.predictions if p.role == "training")
    spread = math.degrees(float(np.nanstd(first.measured["psi"])))
    close = [replace(p, rms={"psi_deg": 0.1}) for p in (*rest, *fit.validation)]
    assert "Error, fitted (rms)" not in rows(replace(fit, predictions=(replace(first, rms={"psi_deg": 0.1}), *close)))
    missed = replace(first, rms={"psi_deg": 0.8 * spread}, noise_floor={})
    fact = rows(replace(fit, predictions=(missed, *close)))["Error, fitted (rms)"]
    assert fact.is_good is False and fact.section == "training"
    cause = "model error, not extrapolation: docs/bad-fit.md, By symptom"
    assert fact.text.startswith(f"missed although fitted: {first.record} by ")
    assert fact.text.endswith(f"(poorly); {cause}")
    worse = replace(first, record="b", rms={"psi_deg": 0.9 * spread}, noise_floor={"psi_deg": 0.8 * spread})
    both = rows(replace(fit, predictions=(missed, worse, replace(missed, record="c"), *close)))["Error, fitted (rms)"]
    assert both.text.startswith("missed although fitted: b by ") and "; 1 more; the process noise" in both.text
    assert both.text.endswith(f"; disturbances or {cause}")


def test_a_held_out_run_that_is_luckier_than_the_fitted_ones_does_not_stand_for_them(fit: Fit) -> None:
    (p,) = fit.validation
    others = [one for one in fit.predictions if one is not p]
    small = {"psi_deg": 0.05 * float(np.degrees(np.std(p.measured["psi"]))), "position_m": 0.1}
    lucky = replace(p, rms=small)
    for factor, is_said in ((1.4, False), (1.6, True)):
        trained = [replace(one, rms={"psi_deg": factor * small["psi_deg"], "position_m": 0.2}) for one in others]
        fact = rows(replace(fit, predictions=(lucky, *trained)))["Error, held out (rms)"]
        assert ("although fitted, is missed by more: " in fact.text) == is_said
