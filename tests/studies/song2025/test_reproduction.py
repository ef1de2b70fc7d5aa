"""song2025 with our own coefficients: the chain, planted bad data, other speeds, printed regressors, controllers."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.regress import Pipeline
from seatrial_studies.controller_cost import controller_rows
from seatrial_studies.song2025.generalisation import (
    compare_craft,
    heading_controller_costs,
    heading_task,
    speed_predictions,
)
from seatrial_studies.song2025.published import CORRECTED, TRUTH, MotionEquation, PublishedManoeuvre, reference_record
from seatrial_studies.song2025.reproduction import (
    BAD_SHARE,
    cleaning_ablation,
    estimator_result,
    lasso_choice,
    printed_systems,
    with_dropouts,
    with_duplicates,
    with_outliers,
)
from seatrial_studies.study_file import read_study


@pytest.fixture(scope="module")
def series() -> Record:
    return reference_record(PublishedManoeuvre.CONSECUTIVE)


def test_our_own_coefficients_are_simulated_with_all_that_lasso_kept(series: Record) -> None:
    result = estimator_result(Pipeline(), series)
    run = compare_craft(
        "ours", result.craft, PublishedManoeuvre.ZIGZAG_20, reference_record(PublishedManoeuvre.ZIGZAG_20)
    )
    assert run.replayed_accuracy is not None and min(run.replayed_accuracy.cc.values()) > 0.98
    assert set(result.test) == {"u", "v", "r"}
    for name, value in result.candidates.items():
        assert result.craft.parameters[name].value == value


def test_printed_regressors_give_the_forces_where_they_are_theirs(series: Record) -> None:
    """X_H has no speed U beside its squares, so that its coefficients are the truth's, dimensional."""
    surge = printed_systems(series)[0]
    p = TRUTH.craft().parameters
    q = 0.5 * p["rho"].value * p["L"].value * p["d"].value
    found = np.linalg.lstsq(surge.matrix, surge.target)[0]
    wanted = q * np.array([p["X_uu"].value, p["X_vv"].value, p["X_rr"].value * p["L"].value ** 2])
    assert found == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("is_scaled", [True, False])
def test_lasso_on_the_printed_regressors_names_every_term_once(series: Record, is_scaled: bool) -> None:
    kept, dropped, penalties = lasso_choice(series, is_scaled=is_scaled)
    assert len(kept) + len(dropped) == 13 and not set(kept) & set(dropped)
    assert set(penalties) == set(MotionEquation)


def test_bad_data_are_planted_as_they_say(series: Record) -> None:
    count = round(BAD_SHARE * len(series))
    spiked, dropped, frozen = (
        make(series, np.random.default_rng(1)) for make in (with_outliers, with_dropouts, with_duplicates)
    )
    assert np.sum(spiked["u"] != series["u"]) == count
    assert np.sum(dropped["u"] == 0.0) == count
    same = np.all([frozen[c][1:] == frozen[c][:-1] for c in ("u", "v", "r", "x0")], axis=0)
    assert abs(int(same.sum()) - count) <= 0.1 * count


def test_cleaning_repairs_planted_outliers(series: Record) -> None:
    made = cleaning_ablation(series, quick=True, seed=0)
    (outliers,) = made.planted
    assert outliers.cleaned.median_error < 0.1 * outliers.uncleaned.median_error
    assert len(made.steps) == 2


def test_the_truth_predicts_itself_at_every_speed() -> None:
    for prediction in speed_predictions({"truth": TRUTH.craft(), "paper": CORRECTED[2].craft()}, (0.5, 2.0)):
        assert prediction.speed == pytest.approx(0.8 * prediction.factor, rel=1e-3)
        assert prediction.errors["truth"] < 1e-6 < prediction.errors["paper"] < 0.3


def test_a_controller_tuned_on_the_truth_costs_least() -> None:
    motion = heading_task().simulate(TRUTH.craft(), np.array([3.8, 45.0]))
    assert 5.0 < motion.output_rms < 15.0 and 5.0 < motion.actuator_rms < 20.0
    costs = heading_controller_costs({"original": CORRECTED[1].craft()})
    assert costs[0].excess == pytest.approx(0.0, abs=1e-9)
    assert costs[1].excess > 0.01
    assert len(controller_rows({"turn": costs})) == 2


def test_every_symbol_has_a_meaning_and_every_figure_a_place() -> None:
    declared = read_study("song2025")
    assert len(declared.paper_figures) == 10
    assert all(meaning and value for _, meaning, _, value in declared.symbols)
