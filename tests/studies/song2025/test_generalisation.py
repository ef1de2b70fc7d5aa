"""What coefficients are worth beyond their record: other manoeuvres, forces, drift, sensitivities."""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import InputError, Record
from seatrial.data.example_series import SENSOR_NOISE
from seatrial.estimation.information.covariance import collinearity
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import theoretical_coefficients
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.steer import manoeuvre
from seatrial_studies.song2025.generalisation import (
    compare_run,
    discrimination,
    hull_and_jet_forces,
    indirect_sensitivity,
    orthogonal_parts,
    prediction_accuracy,
    steady_drift_angle,
    unique_sensitivity,
)
from seatrial_studies.song2025.published import (
    CORRECTED,
    PRINTED,
    TABLE_4,
    TRUTH,
    CoefficientSet,
    PublishedManoeuvre,
    Table2Column,
    drift_angle,
    reference_record,
    simulate_manoeuvre,
)

# Columns simulated beside the truth; RMSE and CC as measures.

ORIGINAL, IMPROVED = CORRECTED[1], CORRECTED[2]


@pytest.fixture(scope="module")
def zigzag():
    return reference_record(PublishedManoeuvre.ZIGZAG_35)


@pytest.fixture(scope="module")
def series():
    return reference_record(PublishedManoeuvre.CONSECUTIVE)


def test_the_truth_predicts_itself(zigzag):
    seen = compare_run(TRUTH, PublishedManoeuvre.ZIGZAG_35, zigzag)
    assert seen.steered.record is not None and seen.replayed_accuracy is not None
    assert max(prediction_accuracy(zigzag, seen.steered.record).rmse.values()) == 0.0
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
    assert seen.steered.record is not None
    assert prediction_accuracy(series, seen.steered.record).cc["r"] < 0.0


def test_no_printed_column_finishes_a_zigzag():
    for column in PRINTED:
        assert not simulate_manoeuvre(column.craft(), PublishedManoeuvre.ZIGZAG_20).is_completed


def test_the_original_column_drifts_round_though_its_sign_is_mended():
    run = PublishedManoeuvre.ZIGZAG_20
    seen = compare_run(ORIGINAL, run, reference_record(run))
    assert not seen.steered.is_completed
    assert np.max(np.abs(drift_angle(seen.replayed))) > 90.0


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
    assert seen.replayed_accuracy is None and seen.steered.record is None
    assert len(seen.replayed) < len(truth) and "diverges" in seen.steered.ending


def test_correlation_does_not_see_a_coefficient_that_is_wrong_by_half(series):
    seen = discrimination(series)
    assert sum(c**2 for c in seen.changes.values()) == pytest.approx(1.0)
    assert max(abs(c) for c in seen.changes.values()) > 0.5
    assert max(seen.cc_loss.values()) < 6e-6
    assert all(rmse < 0.02 * SENSOR_NOISE[c] for c, rmse in seen.accuracy.rmse.items())


# Sensitivities against closed forms, and the point of it: strong coefficients that no record can tell apart.

K, T, DELTA = 0.1, 10.0, 0.2
REST = {"r": 0.0}


def step(rate: float = 20.0, duration: float = 60.0) -> Record:
    time = np.arange(int(duration * rate) + 1) / rate
    return Record.from_arrays("step", time, {"delta": np.full(len(time), DELTA)})


@pytest.fixture(scope="module")
def zigzag_20() -> Record:
    return manoeuvre(waterjet(), programme("zigzag:20/20"), dt=0.1, inputs={"v_j": 1.866}, slew_rate=math.radians(4.0))


def twins() -> Model:
    """T r' + r = (a + b) delta: two coefficients that only ever act together."""
    sheet = Sheet("twins", "made here", "two gains")
    (r,) = sheet.states("r")
    delta = sheet.input("delta")
    a, b, c = (sheet.parameter(n, value, free=True) for n, value in (("a", 0.06), ("b", 0.04), ("c", 10.0)))
    sheet.rate(r, ((a + b) * delta - r) / c, "made here")
    return sheet.model()


@pytest.mark.parametrize("change", [0.1, -0.1, 0.5])
def test_a_state_proportional_to_the_coefficient_has_sensitivity_one(change: float) -> None:
    found = indirect_sensitivity(nomoto(), step(), ["K"], change=change, initial=REST)
    assert found.states == ("r",) and found.matrix == pytest.approx(np.ones((1, 1)), rel=1e-12)


def test_a_time_constant_in_closed_form() -> None:
    """Of r = K delta (1 - exp(-t/T)) for T to 1.1 T: the change never turns its sign."""
    found = indirect_sensitivity(nomoto(), step(), ["T"], initial=REST)
    base, moved = (60.0 - tau * (1.0 - math.exp(-60.0 / tau)) for tau in (T, 1.1 * T))
    assert found.total[0] == pytest.approx((base - moved) / base / 0.1, rel=1e-4)


def test_a_small_change_gives_the_exact_slopes(zigzag_20: Record) -> None:
    """The mean magnitude of differences and their root mean square differ by form only: one state, one shape."""
    model, tiny = waterjet(), 1e-6
    scales = {"u": 1.0, "v": 1.0, "r": 1.0}
    exact = unique_sensitivity(model, zigzag_20, ["Y_v"], scales)
    base, moved = (
        replay(model.with_values({"Y_v": model.parameters["Y_v"].value * f}), zigzag_20).matrix(("u", "v", "r"))
        for f in (1.0, 1.0 + tiny)
    )
    slopes = (moved - base) / tiny
    assert exact.matrix[0] == pytest.approx(np.sqrt(np.mean(slopes**2, axis=0)), rel=1e-4)
    found = indirect_sensitivity(model, zigzag_20, ["Y_v"], change=tiny)
    weights = np.r_[0.5, np.ones(len(base) - 2), 0.5]
    expected = weights @ np.abs(slopes) / (weights @ np.abs(base))
    assert found.matrix[0] == pytest.approx(expected, rel=1e-6)


def test_total_is_the_sum_over_states(zigzag_20: Record) -> None:
    found = indirect_sensitivity(waterjet(), zigzag_20)
    assert found.names == COEFFICIENTS and found.states == ("u", "v", "r")
    assert found.total == pytest.approx(found.matrix.sum(axis=1)) and np.all(found.matrix >= 0.0)
    assert indirect_sensitivity(waterjet(), zigzag_20, states=["r"]).matrix[:, 0] == pytest.approx(
        found.matrix[:, 2], rel=1e-12
    )


def test_twins_are_strong_alone_and_nothing_beyond_each_other() -> None:
    found, exact = (
        indirect_sensitivity(twins(), step(), initial=REST),
        unique_sensitivity(twins(), step(), initial=REST),
    )
    assert found.total[:2] == pytest.approx([0.6, 0.4], rel=1e-9)
    assert np.all(exact.total[:2] > 0.3)
    assert np.all(exact.unique[:2] < 1e-9 * exact.total[:2])
    assert exact.unique[2] > 0.5 * exact.total[2]


def test_the_unique_part_is_the_total_where_nothing_else_adjusts() -> None:
    exact = unique_sensitivity(nomoto(), step(), ["T"], initial=REST)
    assert exact.unique == pytest.approx(exact.total)


def test_most_of_what_a_zigzag_shows_of_the_quadratic_sway_terms_others_can_stand_in_for(zigzag_20: Record) -> None:
    """By the indirect method Y_vr does far more than X_vv; beyond what the others can undo, it does not."""
    found, exact = indirect_sensitivity(waterjet(), zigzag_20), unique_sensitivity(waterjet(), zigzag_20)
    place = {name: i for i, name in enumerate(found.names)}
    assert found.total[place["Y_vr"]] > 20.0 * found.total[place["X_vv"]]
    assert exact.unique[place["Y_vr"]] < 1.5 * exact.unique[place["X_vv"]]
    assert np.all(exact.unique < exact.total)


def test_two_coefficients_hide_the_same_share_of_each_other(zigzag_20: Record) -> None:
    """1 / (1 - rho^2) of two columns, whatever their lengths."""
    pair = unique_sensitivity(waterjet(), zigzag_20, ["N_v", "N_r"])
    first, second = (pair.total / pair.unique) ** 2
    assert first == pytest.approx(second, rel=1e-9) and first > 2.0


def test_orthogonal_parts_are_those_of_the_inverted_information(rng: np.random.Generator) -> None:
    columns = rng.standard_normal((200, 4)) @ rng.standard_normal((4, 4))
    information = columns.T @ columns
    left = orthogonal_parts(columns)
    assert left == pytest.approx(1.0 / np.sqrt(np.diag(np.linalg.inv(information))), rel=1e-8)
    factors = [c.variance_inflation for c in collinearity(information, tuple("abcd"))]
    assert (np.linalg.norm(columns, axis=0) / left) ** 2 == pytest.approx(factors, rel=1e-8)


def test_a_column_of_zeros_has_no_part_of_its_own(rng: np.random.Generator) -> None:
    columns = np.column_stack([rng.standard_normal(9), np.zeros(9)])
    assert orthogonal_parts(columns) == pytest.approx([np.linalg.norm(columns[:, 0]), 0.0])


def test_scales_weigh_states_but_units_do_not(zigzag_20: Record) -> None:
    """A state's scale ten times larger counts ten times less; all ten times larger changes no ratio."""
    noise = {"u": 0.02, "v": 0.02, "r": 0.002}
    one, ten = (
        unique_sensitivity(waterjet(), zigzag_20, scales={s: f * x for s, x in noise.items()}) for f in (1.0, 10.0)
    )
    assert one.unique == pytest.approx(10.0 * ten.unique, rel=1e-6)
    assert one.states == ("u", "v", "r") and one.matrix == pytest.approx(10.0 * ten.matrix)


def test_linear_models_go_the_exact_way() -> None:
    """Started at rest, all motion is the fin's and proportional to its lift slope."""
    time = np.arange(600) / 10.0
    record = Record.from_arrays("fin", time, {"delta_f1": 0.2 * np.sin(0.9 * time)})
    model = theoretical_coefficients(135).applied_to(heave_pitch()).with_values({"lift_1": 2e6, "x_f1": -25.0})
    still = dict.fromkeys(model.states, 0.0)
    assert indirect_sensitivity(model, record, ["lift_1"], initial=still).matrix == pytest.approx(
        np.ones((1, 4)), rel=1e-9
    )
    exact = unique_sensitivity(model, record, ["lift_1", "a33", "b55"], initial=still)
    assert exact.states == model.states and np.all((exact.unique < exact.total) & (exact.unique > 0.0))


def test_what_cannot_be_asked_is_refused(zigzag_20: Record) -> None:
    model = waterjet()
    with pytest.raises(InputError, match="a relative change of 0 is none"):
        indirect_sensitivity(model, zigzag_20, change=0.0)
    with pytest.raises(InputError, match="'Y_v' of model 'waterjet' is zero"):
        indirect_sensitivity(model.with_values({"Y_v": 0.0}), zigzag_20)
    with pytest.raises(InputError, match="'w' is no state"):
        indirect_sensitivity(model, zigzag_20, states=["w"])
    with pytest.raises(InputError, match="unknown parameter 'Y_vvv'"):
        indirect_sensitivity(model, zigzag_20, ["Y_vvv"])
    with pytest.raises(InputError, match="scale of 'r' is not positive"):
        unique_sensitivity(model, zigzag_20, scales={"u": 1.0, "r": 0.0})
    still = Record.from_arrays(
        "still", zigzag_20.time, {"delta": 0.0 * zigzag_20.time, "v_j": np.full(len(zigzag_20), 1.866)}
    )
    with pytest.raises(InputError, match="state 'v' does not move in record 'still'"):
        indirect_sensitivity(model, still, initial={"u": 0.9, "v": 0.0, "r": 0.0})


def test_a_divergence_names_the_coefficient(zigzag_20: Record) -> None:
    with pytest.raises(InputError, match=r"with 'Y_vv' changed by -300 %: the simulation of record .* diverges"):
        indirect_sensitivity(waterjet(), zigzag_20, ["Y_vv"], change=-3.0)
