"""The five rows: what each says, and when it is a warning."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import ChannelScore, Divergence, Fit, Measure, Prediction, WindowBaseline, WindowScore
from seatrial.core.results.fit import Collinearity
from seatrial.core.text.words import enumeration
from seatrial.core.values import Record, Severity
from seatrial.numerics.optimise import Status
from seatrial.reporting.key_facts import first_screen, key_facts, whole_run_shares
from seatrial.reporting.prediction_chapter import baseline_sentence, ranged_motions, shortest_judged
from seatrial.reporting.section import KeyFact


def rows(fit: Fit) -> dict[str, KeyFact]:
    return {fact.name: fact for fact in key_facts(fit)}


def with_windows(fit: Fit, own: float, other: float, inside: float = 0.96) -> Fit:
    score = {"psi_deg": ChannelScore(own, 90.0, 0.9, inside)}
    baseline = WindowBaseline("constant course and speed", {"psi_deg": ChannelScore(other, 10.0, 0.1)})
    window = WindowScore("5 L", 60.0, 4, score, (baseline,))
    runs = tuple(replace(p, windows=(window,)) if p.role == "validation" else p for p in fit.predictions)
    return replace(fit, predictions=runs)


def test_there_are_six_rows_and_what_is_missing_each_with_its_section(fit: Fit) -> None:
    facts = key_facts(fit)
    assert len(facts) == 7 and facts[-2].name == "Not in the training runs"
    assert {f.section for f in facts} <= {"prediction", "identifiability", "coefficients", "findings", "", "method"}


def test_known_values_outside_their_intervals_are_named(fit: Fit) -> None:
    first, *others = fit.coefficients
    assert rows(fit)["Known values"].is_good
    moved = replace(first, truth=2.0 * first.estimate)
    fact = rows(replace(fit, coefficients=(moved, *others)))["Known values"]
    assert fact.is_good is False and fact.text.endswith(f"; outside: {first.name}")
    unknown = tuple(replace(c, truth=None) for c in fit.coefficients)
    assert "Known values" not in rows(replace(fit, coefficients=unknown))


def test_a_baseline_that_is_better_is_a_warning(fit: Fit) -> None:
    better, worse = rows(with_windows(fit, 1.0, 3.0)), rows(with_windows(fit, 3.0, 1.0))
    text = "constant course and speed 3.0°, this fit 1.0° in heading over 5 L"
    assert better["Closest baseline"].is_good and better["Closest baseline"].text == text
    fact = worse["Closest baseline"]
    assert fact.is_good is False and fact.text.endswith("; the baseline is better")
    assert rows(fit)["Baseline"].text == "none compared"


def test_a_baseline_that_is_better_within_sensor_noise_is_no_warning(fit: Fit) -> None:
    assert fit.noise_model is not None
    for noise, is_good in ((0.5, False), (2.5, None)):
        measured = replace(fit.noise_model, measurement={"psi": math.radians(noise)})
        scored = replace(with_windows(fit, 3.0, 2.9), noise_model=measured)
        fact = rows(scored)["Closest baseline"]
        assert fact.is_good is is_good and fact.text.endswith(": both within sensor noise") == (is_good is None)
        assert (baseline_sentence(scored, {"psi_deg": ("heading", "deg")}) == "") == (is_good is None)


def test_coverage_counts_values_and_samples(fit: Fit) -> None:
    fact = rows(with_windows(fit, 1.0, 3.0, inside=0.82))["Inside 95 % intervals"]
    assert "82 % of heading over 5 L" in fact.text
    assert fact.is_good is False
    p = next(p for p in fit.predictions if p.role == "validation")
    one = replace(p, measures={"overshoot_1_deg": Measure(8.0, 8.1, 7.5, 8.6)})
    alone = replace(fit, predictions=(one,))
    assert rows(alone)["Inside 95 % intervals"].text == "1 of 1 measure"


def test_runs_simulated_whole_that_leave_their_bands_are_no_tick(fit: Fit) -> None:
    kept = replace(with_windows(fit, 1.0, 3.0), noise_model=None)
    (p,) = kept.validation
    apart = np.abs(p.measured["psi"] - p.simulated["psi"])
    for quantile, is_good in ((0.3, False), (0.7, False), (0.95, True)):
        half = np.full(len(apart), float(np.quantile(apart, quantile)))
        fact = rows(replace(kept, predictions=(replace(p, half_width={"psi": half}),)))["Inside 95 % intervals"]
        assert ("simulated whole" in fact.text) == (not is_good)
        assert is_good or fact.text.endswith(f"; {100.0 * quantile:.0f} % of heading, simulated whole")
        assert fact.is_good is is_good
    wide = replace(p, half_width={"psi": np.full(len(apart), 10.0)})
    fact = rows(replace(kept, predictions=(wide,)))["Inside 95 % intervals"]
    assert fact.is_good is None and "times as wide as the error" in fact.text


def test_samples_scatter_about_the_band_of_a_whole_run_by_their_noise(fit: Fit) -> None:
    """By hand: errors that are noise of the compass alone, 95 % of which lie within 1.96 standard deviations."""
    assert fit.noise_model is not None
    (p,) = fit.validation
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(p.measured))
    psi = p.measured.channel("psi")
    scattered = replace(p, simulated=p.simulated.with_channel("psi", psi.with_values(psi.values + noise)),
                        half_width={"psi": np.full(len(noise), 1e-6)})  # fmt: skip
    noisy = replace(fit, predictions=(scattered,), noise_model=replace(fit.noise_model, measurement={"psi": 0.01}))
    assert whole_run_shares(noisy)["heading"] == pytest.approx(0.95, abs=0.02)
    assert whole_run_shares(replace(noisy, noise_model=None))["heading"] == pytest.approx(0.0, abs=0.01)


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
        assert ("bands 6.1 times as wide as the error" in fact.text) == (is_good is None)


def test_a_fit_that_is_best_over_the_longest_windows_only_does_not_claim_all(fit: Fit) -> None:
    kept = with_windows(fit, 1.0, 3.0)
    (p,) = kept.validation
    (longest,) = p.windows
    rival = WindowBaseline("NARX", {"psi_deg": ChannelScore(0.5, 90.0, 0.9)})
    short = replace(longest, window="1 L", seconds=12.0, baselines=(rival,))
    both = replace(kept, predictions=(replace(p, windows=(short, longest)),))
    fact = rows(both)["Closest baseline"]
    assert fact.text.endswith("; a baseline is better in heading over 1 L")
    assert fact.is_good is None


def test_an_interval_that_cannot_fail_is_no_tick(fit: Fit) -> None:
    (p,) = fit.validation
    wide = {"overshoot_1_deg": Measure(8.0, 8.1, -30.0, 40.0)}
    one = replace(fit, predictions=(replace(p, measures=wide, windows=()),))
    fact = rows(one)["Inside 95 % intervals"]
    assert fact.text == "too wide to test: 1 measure"
    assert fact.is_good is False
    both = replace(p, windows=(), measures=wide | {"overshoot_2_deg": Measure(8.0, 8.1, 7.0, 9.0)})
    fact = rows(replace(fit, predictions=(both,)))["Inside 95 % intervals"]
    assert fact.text == "1 of 1 measure; too wide to test: 1 measure"
    assert fact.is_good is True
    missed = replace(p, windows=(), measures={"overshoot_1_deg": Measure(50.0, 8.1, -30.0, 40.0)})
    assert rows(replace(fit, predictions=(missed,)))["Inside 95 % intervals"].is_good is False


def test_a_band_wider_than_the_motion_is_no_tick(fit: Fit) -> None:
    scored = with_windows(fit, 1.0, 3.0, inside=1.0)
    (p,) = scored.validation
    scores = {key: replace(score, band_share=1.2) for key, score in p.windows[0].scores.items()}
    wide = replace(p, measures={}, windows=(replace(p.windows[0], scores=scores),))
    fact = rows(replace(scored, predictions=(wide,)))["Inside 95 % intervals"]
    assert fact.text.startswith("too wide to test: the band of heading")
    assert fact.is_good is False


def test_warnings_name_findings_and_a_search_that_did_not_converge(fit: Fit) -> None:
    codes = [f.code for f in fit.findings if f.severity is not Severity.INFO]
    assert rows(fit)["Warnings"].text == enumeration(codes) and not rows(fit)["Warnings"].is_good
    quiet = replace(fit, findings=())
    assert rows(quiet)["Warnings"].text == "none" and rows(quiet)["Warnings"].is_good


def test_the_picture_is_the_worst_held_out_run_with_its_heading(fit: Fit) -> None:
    screen = first_screen(fit, 9.8)
    assert "zigzag_25_25" in screen.caption and screen.figure.count('"label"') == 2 and "ψ [deg]" in screen.figure
    assert first_screen(replace(fit, predictions=()), 9.8).figure == ""


def test_the_extrapolation_index_names_what_it_compares(fit: Fit) -> None:
    (run,) = [p.measured for p in fit.validation]
    assert ranged_motions([run]) == "yaw rate, drift, rudder or speed"
    still = np.zeros(len(run))
    waves = Record.from_arrays("waves", run.time, {"zeta": still, "z": still})
    decay = Record.from_arrays("decay", run.time, {"phi": still})
    assert (
        ranged_motions([waves]) == "heave, pitch or elevation of the waves" and ranged_motions([decay]) == "roll angle"
    )


def test_a_search_that_did_not_converge_comes_first(fit: Fit) -> None:
    stalled = replace(fit, solution=replace(fit.solution, status=Status.STALLED))
    assert key_facts(stalled)[0].name == "Warnings" and key_facts(stalled)[0].text.startswith(
        "begin with not-converged"
    )
    assert first_screen(stalled, 9.8).verdict.startswith("Do not use the coefficients: the search did not converge")
    assert rows(stalled)["Identifiability"].is_good is False


def test_the_least_certain_coefficient_is_named_with_its_interval(fit: Fit) -> None:
    fact = rows(fit)["Identifiability"]
    widths = {c.name: 0.5 * (c.upper - c.lower) / abs(c.estimate) for c in fit.coefficients
              if not c.fixed and c.lower is not None and c.upper is not None and not c.is_sign_open}  # fmt: skip
    widest = max(widths, key=lambda name: widths[name])
    assert f"; least certain: {widest} ± {100.0 * widths[widest]:.2g} %" in fact.text


def test_collinear_coefficients_with_narrow_intervals_are_determined(fit: Fit) -> None:
    assert fit.identifiability is not None
    tied = replace(fit.identifiability, collinearity=(Collinearity("N_v", 140.0, "N_r", -0.99),))
    assert rows(replace(fit, identifiability=tied))["Identifiability"] == rows(fit)["Identifiability"]


def test_windows_that_diverge_have_no_better_baseline(fit: Fit) -> None:
    lost = with_windows(fit, math.inf, 1.0)
    run = lost.validation[0]
    windows = tuple(replace(w, diverged=3) for w in run.windows)
    lost = replace(lost, predictions=(replace(run, windows=windows),))
    fact = rows(lost)["Closest baseline"]
    assert fact.is_good is False and "the model diverges in 3 of 4 windows of 5 L" in fact.text
    assert windows[0].better_baselines({}) == {}
    text = baseline_sentence(lost, {"psi_deg": ("heading", "deg")})
    assert "diverges in 3 of 4 windows" in text and "without this fit" not in text


def test_windows_shorter_than_a_roll_period_are_no_reproach(fit: Fit) -> None:
    better = with_windows(fit, 1.0, 0.5)
    labels = {"psi_deg": ("heading", "deg")}
    seconds = max(w.seconds for p in better.validation for w in p.windows)
    assert "do not rely on it" in baseline_sentence(better, labels, seconds)
    assert baseline_sentence(better, labels, 1.01 * seconds) == ""
    assert shortest_judged(fit) == 0.0


def test_one_run_diverges(fit: Fit) -> None:
    (run, *_) = fit.validation
    lost = replace(run, divergence=Divergence(70.0, 65.0, "r"))
    assert rows(replace(fit, predictions=(lost,)))["Error, held out"].text == "1 run diverges"


def test_a_velocity_that_a_baseline_predicts_better_is_no_best_in_every_quantity(fit: Fit) -> None:
    scored = with_windows(fit, 1.0, 3.0)
    (p,) = scored.validation
    window = p.windows[0]
    (rival, *_) = window.baselines
    own, others = window.scores["psi_deg"], rival.scores["psi_deg"]
    baseline = replace(rival, scores=rival.scores | {"r": replace(others, rms=0.01)})
    both = replace(window, scores=window.scores | {"r": replace(own, rms=0.02)}, baselines=(baseline,))
    fact = rows(replace(scored, predictions=(replace(p, windows=(both,)),)))["Closest baseline"]
    assert fact.text.endswith("; a baseline is better in r")
    assert fact.is_good is False


def test_fitted_runs_that_are_missed_are_a_row_of_their_own(fit: Fit) -> None:
    assert fit.noise_model is not None
    fit = replace(fit, noise_model=replace(fit.noise_model, disturbance="none"))
    first, *others = (p for p in fit.predictions if p.role == "training")
    spread = math.degrees(float(np.nanstd(first.measured["psi"])))
    close = [replace(p, rms={"psi_deg": 0.1}) for p in (*others, *fit.validation)]
    assert "Error, fitted" not in rows(replace(fit, predictions=(replace(first, rms={"psi_deg": 0.1}), *close)))
    missed = replace(first, rms={"psi_deg": 0.8 * spread}, noise_floor={})
    fact = rows(replace(fit, predictions=(missed, *close)))["Error, fitted"]
    assert fact.is_good is False and fact.section == "training"
    assert fact.text == f"{first.record} {0.8 * spread:.2g}° in heading; model error: docs/bad-fit.md, By symptom"
    more = (missed, replace(missed, record="b"), replace(missed, record="c"))
    assert "; 1 more; " in rows(replace(fit, predictions=(*more, *close)))["Error, fitted"].text
    noise = replace(fit.noise_model, measurement={**fit.noise_model.measurement, "psi": math.radians(0.7 * spread)})
    assert "Error, fitted" not in rows(replace(fit, predictions=(missed, *close), noise_model=noise))


def test_a_fitted_run_that_the_disturbance_carries_off_is_no_model_error(fit: Fit) -> None:
    assert fit.noise_model is not None
    first, *others = (p for p in fit.predictions if p.role == "training")
    spread = math.degrees(float(np.nanstd(first.measured["psi"])))
    close = [replace(p, rms={"psi_deg": 0.1}) for p in (*others, *fit.validation)]
    missed = replace(first, rms={"psi_deg": 0.9 * spread}, noise_floor={"psi_deg": 0.8 * spread})
    gusty = replace(fit, predictions=(missed, *close), noise_model=replace(fit.noise_model, disturbance="white"))
    fact = rows(gusty)["Error, fitted"]
    assert fact.is_good is None and fact.text.endswith("; the estimated disturbance leaves as much")


def test_a_held_out_run_that_is_luckier_than_the_fitted_ones_does_not_stand_for_them(fit: Fit) -> None:
    def missed_by(share: float, p: Prediction) -> Prediction:
        return replace(p, rms={"psi_deg": share * float(np.degrees(np.std(p.measured["psi"])))})

    (p,) = fit.validation
    others = [prediction for prediction in fit.predictions if prediction is not p]
    for share, is_named in ((0.09, False), (0.2, True)):
        trained = [missed_by(share, prediction) for prediction in others]
        fact = rows(replace(fit, predictions=(missed_by(0.05, p), *trained))).get("Error, fitted")
        assert (fact is not None) == is_named and (fact is None or fact.text.endswith(": well"))
