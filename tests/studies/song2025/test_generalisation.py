"""Columns sailed beside the truth; RMSE and CC as measures."""

import math

import numpy as np
import pytest

from seatrial_studies.song2025.craft_models import (
    CORRECTED,
    PRINTED,
    TRUTH,
    CoefficientSet,
    drift_angle,
    reference_record,
)
from seatrial_studies.song2025.discrimination import discrimination
from seatrial_studies.song2025.generalisation import (
    compare_run,
    compare_runs,
    hull_and_jet_forces,
    prediction_accuracy,
    steady_drift_angle,
)
from seatrial_studies.song2025.published import TABLE_4, PublishedManoeuvre, Table2Column

ORIGINAL, IMPROVED = CORRECTED[1], CORRECTED[2]


@pytest.fixture(scope="module")
def zigzag():
    return reference_record(PublishedManoeuvre.ZIGZAG_35)


@pytest.fixture(scope="module")
def series():
    return reference_record(PublishedManoeuvre.CONSECUTIVE)


def test_the_truth_predicts_itself(zigzag):
    seen = compare_run(TRUTH, PublishedManoeuvre.ZIGZAG_35, zigzag)
    assert seen.steered_accuracy is not None and seen.replayed_accuracy is not None
    assert max(seen.steered_accuracy.rmse.values()) == 0.0
    assert max(seen.replayed_accuracy.rmse.values()) < 1e-5


def test_the_mended_column_replayed_has_table_4_s_correlations(series):
    seen = compare_run(IMPROVED, PublishedManoeuvre.CONSECUTIVE, series)
    assert seen.replayed_accuracy is not None
    printed = TABLE_4[PublishedManoeuvre.CONSECUTIVE]
    for channel in ("v", "r"):
        assert seen.replayed_accuracy.cc[channel] == pytest.approx(printed.cc[channel], abs=5e-4)
    assert seen.replayed_accuracy.rmse["v"] == pytest.approx(printed.rmse["v"], abs=0.0015)


def test_with_the_helmsman_in_the_loop_those_correlations_are_out_of_reach(series):
    seen = compare_run(IMPROVED, PublishedManoeuvre.CONSECUTIVE, series)
    assert seen.steered_accuracy is not None
    assert seen.steered_accuracy.cc["r"] < 0.0


def test_no_printed_column_finishes_a_zigzag():
    for seen in compare_runs(PRINTED, (PublishedManoeuvre.ZIGZAG_20,)):
        assert not seen.steered.is_completed


def test_the_original_column_drifts_round_though_its_sign_is_mended():
    (seen,) = compare_runs((ORIGINAL,), (PublishedManoeuvre.ZIGZAG_20,))
    assert not seen.steered.is_completed
    assert seen.largest_drift > 90.0


def test_a_turn_with_35_degrees_is_outside_the_quadratic_model():
    assert steady_drift_angle(TRUTH, 35.0) == pytest.approx(44.3, abs=0.1)
    assert steady_drift_angle(TRUTH, 20.0) < 20.0
    assert steady_drift_angle(TRUTH, -20.0) == pytest.approx(-steady_drift_angle(TRUTH, 20.0), rel=1e-9)


def test_forces_are_mass_times_acceleration(zigzag):
    of_truth, p = hull_and_jet_forces(TRUTH.craft(), zigzag), TRUTH.craft().parameters
    r_dot = np.gradient(zigzag["r"], zigzag.dt)
    inertia = p["I_z"].value + p["J_z"].value
    assert inertia * r_dot[1:-1] == pytest.approx(of_truth["N"][1:-1], abs=0.02 * np.ptp(of_truth["N"]))


def test_accuracy_is_of_the_common_stretch(zigzag):
    assert max(prediction_accuracy(zigzag, zigzag.rows(slice(0, 900))).rmse.values()) == 0.0


def test_drift_is_positive_with_the_bow_into_a_turn_to_starboard():
    assert drift_angle(reference_record(PublishedManoeuvre.TURN_35))[-1] == pytest.approx(41.4, abs=0.1)


def test_a_column_that_diverges_has_no_accuracy():
    truth = reference_record(PublishedManoeuvre.TURN_35)
    seen = compare_run(CoefficientSet(Table2Column.IMPROVED, ("N_v",)), PublishedManoeuvre.TURN_35, truth)
    assert seen.replayed_accuracy is None and seen.steered_accuracy is None
    assert math.isfinite(seen.divergence_time) and "diverges" in seen.steered.ending


def test_correlation_does_not_see_a_coefficient_that_is_wrong_by_half(series):
    seen = discrimination(series)
    assert sum(c**2 for c in seen.changes.values()) == pytest.approx(1.0)
    assert max(abs(c) for c in seen.changes.values()) > 0.5
    assert max(seen.cc_loss.values()) < 6e-6
    assert all(seen.accuracy.rmse[c] < 0.02 * noise for c, noise in seen.sensor_noise.items())
