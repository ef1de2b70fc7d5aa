"""yu2014 repeated quickly: the print audited, both readings calibrated, fitted called fitted, what beats the paper."""

import math

import numpy as np
import pytest

from seatrial.core.results import CheckStatus, Study, Verdict
from seatrial.physics.hydro.excitation import G
from seatrial.physics.loops.loop_states import state_space
from seatrial.physics.loops.structures import Preamplifier
from seatrial.physics.sea.spectrum import ittc
from seatrial_studies import yu2014
from seatrial_studies.study_file import read_study
from seatrial_studies.yu2014.audit import audit
from seatrial_studies.yu2014.published import (
    DESIGN_ROW,
    DESIGN_SEA,
    HULL_FACTOR,
    PUBLISHED,
    PUBLISHED_VALUES,
    TABLE_1,
    TARGET,
    ControllerResult,
    FinObjective,
    SeaCondition,
    objective_values,
    performance,
    roll_response,
)
from seatrial_studies.yu2014.reproduction import fit_table_1, rms_variation, simulate_histories
from seatrial_studies.yu2014.searches import (
    FIVE_FREE,
    HELD_OUT_SEAS,
    MS_LIMIT,
    SEEDS,
    GeneticSearchSetting,
    compare_weights,
    compare_with_published,
    five_gain_Ms,
    hardest_sea,
    minimise_roll,
    search_over_seeds,
)

PRINTED, WASHOUT = Preamplifier.PRINTED, Preamplifier.WASHOUT


@pytest.fixture(scope="module")
def study() -> Study:
    return yu2014.study(quick=True, seed=0, report_progress=None)


@pytest.fixture(scope="module")
def found():
    return audit(0)


@pytest.mark.parametrize("reading", Preamplifier)
def test_calibrated_the_paper_s_gains_reduce_as_printed_where_they_were_set(reading: Preamplifier) -> None:
    assert roll_response(performance(reading)).reduction == pytest.approx(DESIGN_ROW.genetic.reduction, abs=1e-6)


def test_the_readings_differ_in_what_the_loop_bears(found) -> None:
    assert found.roll_responses[PRINTED].Ms == pytest.approx(5.45, abs=0.02)
    assert found.roll_responses[WASHOUT].Ms == pytest.approx(1.32, abs=0.01)


def test_at_90_degrees_speed_changes_nothing_but_the_lift() -> None:
    slow, fast = (performance(WASHOUT, SeaCondition(speed, 90.0)) for speed in (18.0, 22.0))
    assert roll_response(fast).uncontrolled == pytest.approx(roll_response(slow).uncontrolled, rel=1e-9)
    assert roll_response(fast).reduction == pytest.approx(82.96, abs=2.0)


def test_objectives_are_those_of_the_print() -> None:
    variances = np.array([[2.0, 0.5 * TARGET, 3.0], [2.0, 3.0 * TARGET, 3.0], [np.inf, np.inf, np.inf]])
    made = objective_values(variances, FinObjective.PRINTED)
    assert made[:2, 1] == pytest.approx([0.25 * TARGET**2, 4.0 * TARGET**2])
    assert made[:2, 0].tolist() == [2.0, 2.0]
    assert objective_values(variances, FinObjective.ONE_SIDED)[:2, 1] == pytest.approx([0.0, 4.0 * TARGET**2])
    assert np.all(np.isinf(made[2]))


def test_the_target_was_rounded_and_the_chord_too(found) -> None:
    assert found.target_rounded == pytest.approx(150.31, abs=0.005)
    assert found.target == pytest.approx(150.36, abs=0.005)
    assert found.fin_inertia.mass == pytest.approx(3064.932)
    assert found.fin_inertia.inertia == pytest.approx(791.1611, abs=1e-4)
    assert found.fin_inertia.consistent_inertia > 1.01 * found.fin_inertia.inertia


def test_only_codes_of_17_bits_hold_the_printed_gains(found) -> None:
    assert found.shortest_code_bits == 17


def test_table_1_contradicts_itself_and_what_is_said_of_it(found) -> None:
    assert DESIGN_ROW.genetic.uncontrolled == pytest.approx(1.62, abs=0.005)
    assert [round(c.uncontrolled, 2) for c in (TABLE_1[4].traditional, TABLE_1[4].genetic)] == [1.53, 1.82]
    assert found.contradictory_rows == ("18 / 135", "22 / 45", "22 / 90", "22 / 135")
    assert (found.lower_reductions, found.larger_rates) == (1, 5)


def test_rounding_leaves_the_implied_roll_open_by_the_printed_digits() -> None:
    low, high = ControllerResult(0.50, 1.0, 50.0).uncontrolled_bounds
    assert (low, high) == pytest.approx((0.495 / 0.50005, 0.505 / 0.49995))


def test_a_step_of_a_tenth_of_a_second_does_not_carry_the_gyro(found) -> None:
    assert found.runge_kutta_growth == pytest.approx(43.86, abs=0.01)


def test_the_fin_rate_beside_its_print_is_that_of_the_loop(found) -> None:
    for reading in Preamplifier:
        integral, rate = found.fin_rate_readings[reading]
        assert rate == pytest.approx(roll_response(performance(reading)).rate, rel=1e-9)
        assert integral < rate


def test_fits_are_as_good_as_they_say_and_no_better_than_the_table_allows() -> None:
    made = fit_table_1(WASHOUT, following_is_zero=True)
    assert 0.16 < made.log_error < 0.19
    assert 0.2 < made.baseline_log_error < 0.28
    for i, row in enumerate(TABLE_1):
        of = roll_response(performance(WASHOUT, made.sea(row.heading, row.speed), made.K_q))
        assert made.row_result(made.genetic, i).roll == pytest.approx(made.level * of.roll, rel=1e-9)
        assert made.row_result(made.genetic, i).reduction == pytest.approx(of.reduction, rel=1e-9)


def test_histories_have_the_variances_of_the_spectrum() -> None:
    made = fit_table_1(WASHOUT, following_is_zero=True)
    free, genetic = [], []
    for seed in range(12):
        drawn = simulate_histories(made, seed)
        free.append(np.mean(drawn.uncontrolled**2))
        genetic.append([np.mean(y**2) for y in drawn.genetic])
    of = roll_response(performance(WASHOUT, made.sea(DESIGN_ROW.heading, DESIGN_ROW.speed), made.K_q))
    expected = made.level * np.array([of.uncontrolled, of.roll, of.rate])
    ours = np.sqrt([np.mean(free), *np.mean(genetic, axis=0)])
    assert ours == pytest.approx(expected, rel=0.08)


def test_one_record_varies_as_a_gaussian_process_does() -> None:
    """Against records of 1000 s drawn with random amplitudes."""
    rng, dt, n = np.random.default_rng(0), 0.5, 2**15
    w = 2.0 * np.pi * np.fft.rfftfreq(n, dt)
    w[0] = 1e-6
    loop = performance(WASHOUT).loop
    slope = (w**2 / G) ** 2 * HULL_FACTOR.slope_factor(w, math.pi / 2) ** 2 * ittc(PUBLISHED.height).density(w)
    size = np.abs(loop.disturbance.frequency_response(w) / (1.0 + loop.open_loop(w))) * np.sqrt(slope)
    rms = []
    for _ in range(25):
        drawn = np.fft.irfft(size * (rng.normal(size=len(w)) + 1j * rng.normal(size=len(w))), n)
        rms += list(drawn[:32000].reshape(16, 2000).std(axis=1))
    seen = np.std(rms) / np.mean(rms)
    assert rms_variation(WASHOUT) == pytest.approx(seen, rel=4.0 / math.sqrt(2.0 * len(rms)))


def test_the_search_is_the_same_again_and_scatters() -> None:
    first, again = (search_over_seeds(GeneticSearchSetting(WASHOUT), 4, 0) for _ in range(2))
    assert first.gains.tobytes() == again.gains.tobytes()
    assert first.relative_spread.max() > 0.5
    assert first.distance_to_published > 0.05
    states = state_space(performance(WASHOUT).loop)
    for gains, peak in zip(first.gains, first.Ms, strict=True):
        assert np.linalg.eigvals(states.closed_loop_matrix(gains)).real.max() < 0.0
        assert peak >= 1.0


def test_beaten_answers_are_beaten() -> None:
    made = search_over_seeds(GeneticSearchSetting(PRINTED), 4, 0)
    of = performance(PRINTED)
    J = objective_values(of.evaluate(made.gains).variances, FinObjective.PRINTED)
    assert np.allclose(
        made.objective_ratios, J / objective_values(of.evaluate(PUBLISHED_VALUES).variances, FinObjective.PRINTED)[0]
    )
    among = (J[:, None] < J[None]).all(axis=2).any(axis=0)
    assert np.all(made.is_dominated[among])


def test_five_gains_keep_what_they_were_allowed() -> None:
    gains = minimise_roll(WASHOUT, 1.0, np.random.default_rng(0), FIVE_FREE)
    made = compare_with_published(WASHOUT, gains, DESIGN_SEA)
    assert made.rate_ratio <= 1.0 + 1e-9
    assert made.roll_ratio < 0.7
    assert five_gain_Ms(WASHOUT, gains) <= MS_LIMIT + 1e-9
    assert made.paper_reduction == pytest.approx(DESIGN_ROW.genetic.reduction, abs=1e-6)


def test_claims_that_rest_on_the_baseline_are_not_judged_by_it(study: Study) -> None:
    verdicts = {c.claim: c for c in study.claims}
    (energy,) = [c for name, c in verdicts.items() if "energy loss" in name]
    (optimal,) = [c for name, c in verdicts.items() if "optimal gains is found" in name]
    assert energy.verdict is Verdict.UNKNOWABLE
    assert "not printed" in energy.evidence
    assert optimal.verdict is Verdict.UNKNOWABLE
    assert "preamplifier" in optimal.evidence


def test_fitted_is_called_fitted_and_levels_are_said_not_to_match(study: Study) -> None:
    titles = [t.title for t in study.tables]
    assert "Table 1, the traditional PID, fitted" in titles
    for table in study.tables:
        if table.title.endswith(", fitted"):
            assert "not reproduced" in table.note
    assert "levels do not match" in next(t for t in study.tables if "one number of it" in t.title).note
    assert any("Kq" in str(row[0]) for t in study.tables if t.title == "Assumed" for row in t.rows)
    titles += [f.title for f in study.figures]
    assert read_study("yu2014").missing_counterparts(titles) == ()


def test_figures_3_to_7_are_there(study: Study) -> None:
    for number in range(3, 8):
        assert sum(f.title.startswith(f"Figure {number}:") for f in study.figures) == 1


def test_the_paper_is_beaten_and_misses_stay(study: Study) -> None:
    held = {c.name: c for c in study.checks}
    assert held["as printed: largest objective of better gains over the paper's"].value <= 0.62
    assert held["washout: best worst objective of three gains over the paper's, at its Ms"].holds
    assert held["washout, five gains: roll variance over the paper's, worse of two seas"].holds
    assert held[
        "washout, five gains, held out, JONSWAP 3.3 m, 9.1 s, long-crested: roll variance over the paper's"
    ].holds
    assert sum("held out" in name for name in held) == 2 * len(HELD_OUT_SEAS)
    assert all(c.holds == (c.value <= c.limit) for c in study.checks if isinstance(c.limit, float))


def test_energy_comes_first_and_no_verdict_hangs_on_time(study: Study) -> None:
    first = study.claims[0]
    assert "energy" in first.claim and "0.77/0.75/0.68/0.91/1.04/0.85" in first.evidence
    assert first.evidence.count("the nearest to that column") == 1 and "kW" in first.evidence
    times = [c for c in study.checks if "time" in c.name]
    assert len(times) == 2 and all(c.status is CheckStatus.WITHDRAWN for c in times)


def test_claims_are_judged_in_the_context_they_were_made_in(study: Study) -> None:
    settings = {c.claim: c.setting for c in study.claims if c.verdict is Verdict.HOLDS_IN_OWN_SETTING}
    assert sorted(settings.values()) == [*["18 kn, 90°, 3.3 m, where the PID was set"] * 2, "one speed"]
    (search,) = [c for c in study.claims if "random weights" in c.claim.lower()]
    assert search.verdict is Verdict.UNKNOWABLE and "against fixed, equal weights" in search.evidence
    (joint,) = [c for c in study.claims if "global" in c.claim]
    assert joint.verdict is Verdict.UNKNOWABLE and "all six conditions" in joint.evidence


def test_random_and_fixed_weights_are_compared_from_the_same_first_generations() -> None:
    compared = compare_weights(WASHOUT, 0)
    assert compared.J.shape == compared.volume.shape == (2, SEEDS.value)
    assert np.all(compared.J[0] != compared.J[1]) and np.all((compared.volume > 0.0) & (compared.volume < 1.0))
    assert not (compared.is_better and compared.is_worse)


def test_why_five_gains_leave_the_roll_of_quartering_long_crested_seas_is_said(study: Study) -> None:
    found = hardest_sea(WASHOUT, HELD_OUT_SEAS[-1], np.random.default_rng(0))
    assert found.band[1] < 0.5 * found.natural < found.design_band[0]
    assert found.least_ratio < 0.4
    failing = [c for c in study.checks if c.status is CheckStatus.FAILS]
    assert failing and not any("not known" in c.remark for c in failing)


def test_the_page_answers_its_question(study: Study) -> None:
    assert "cannot be decided" in study.answer[0] and "fixed ones in" in study.answer[1]
