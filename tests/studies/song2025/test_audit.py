"""Every misprint shows in a simulation or a count of our own; corrected, it does not."""

import math

import numpy as np
import pytest

from seatrial.data.example_series import JET_VELOCITY
from seatrial_studies.song2025.audit import (
    assumed_parameter_sets,
    audit,
    equation_14_systems,
    table_1_mass,
)
from seatrial_studies.song2025.published import (
    APPROACH_SPEED,
    TABLE_3,
    TRUTH,
    MotionEquation,
    PublishedManoeuvre,
    reference_record,
)


@pytest.fixture(scope="module")
def seen():
    return audit(assumed_parameter_sets()[1:3])


def test_with_the_printed_n_v_the_turn_reverses_and_no_zigzag_finishes(seen):
    corrected, printed = seen.reversed_turn.yaw_rates
    assert corrected == pytest.approx(2.21, abs=0.01)
    assert printed < 0.0
    assert seen.reversed_turn.completed_zigzags == (3, 0)


def test_with_the_printed_y_vv_sway_is_driven_and_every_run_diverges(seen):
    assert all(math.isfinite(s) for s in seen.undamped_sway.divergence_times.values())
    assert seen.undamped_sway.critical_drift == pytest.approx(24.6, abs=0.1)


def test_with_y_vv_turned_table_4_s_correlations_come_back(seen):
    assert all(cc > 0.995 for cc in seen.undamped_sway.corrected_cc.values())


def test_the_signs_are_misprints_whatever_was_chosen(seen):
    assert [of.confirms_misprints for of in seen.sign_checks] == [True, True]


def test_choices_move_one_parameter_each():
    values = assumed_parameter_sets()
    assert values[0] == {}
    assert all(len(v) == 1 for v in values[1:])
    assert len({tuple(v.items()) for v in values}) == len(values)


def test_alpha_v_makes_turns_differ_by_side(seen):
    starboard, port = seen.asymmetry.jet_yaw_rates
    assert starboard > 1.05 * -port > 0.0
    left, right = seen.asymmetry.corrected_yaw_rates
    assert left == pytest.approx(-right, rel=1e-9)


def test_with_even_forces_every_turn_diverges(seen):
    assert all(math.isfinite(s) for s in seen.asymmetry.hull_divergence_times)


def test_without_parentheses_accelerations_are_off_by_orders(seen):
    assert all(factor > 1e5 for factor in seen.parenthesis_factors.values())


def test_only_the_corrected_regression_gives_the_truth(seen):
    for of in seen.equation_14_fits:
        worst = max(abs(e) for e in of.errors.values())
        assert worst < 1e-9 if of.variant.endswith("corrected") else worst > 90.0, of.variant


def test_the_wrong_sign_of_ur_hardly_shows_in_the_residual(seen):
    of = next(r for r in seen.equation_14_fits if "u r" in r.variant)
    assert of.residual < 0.01
    assert of.errors["Y_r"] < -300.0


def test_the_norm_of_the_inverse_makes_equations_27_and_28_one(seen):
    assert seen.equation_27_readings.with_inverse == pytest.approx(
        np.linalg.cond(seen.table_3_conditions.correlations[MotionEquation.SWAY]), rel=1e-6
    )
    assert seen.equation_27_readings.without_inverse < 25.0


def test_sway_holds_yaw_s_features_so_that_table_3_s_labels_cannot_be(seen):
    ours = seen.table_3_conditions
    assert TABLE_3[MotionEquation.SWAY] < TABLE_3[MotionEquation.YAW] < ours.labels_exchanged[MotionEquation.SWAY]
    for of in (ours.plain, ours.improved):
        assert of[MotionEquation.SWAY] >= of[MotionEquation.YAW]
    yaw_in_sway = ours.correlations[MotionEquation.SWAY][[0, 1, 4]][:, [0, 1, 4]]
    assert yaw_in_sway == pytest.approx(ours.correlations[MotionEquation.YAW], rel=1e-9)
    assert ours.labels_exchanged[MotionEquation.SURGE] == TABLE_3[MotionEquation.SWAY]


def test_fresh_water_gives_the_printed_mass(seen):
    fresh, salt = seen.table_1_masses
    assert fresh.block == pytest.approx(5540.0, abs=5.0)
    assert salt.block > 5660.0
    assert (fresh.nondimensional, salt.nondimensional) == pytest.approx((0.16249, 0.158528), abs=5e-6)


def test_thrust_balances_resistance_at_the_series_jet_velocity(seen):
    assert seen.thrust.jet_velocity == pytest.approx(JET_VELOCITY, abs=5e-4)
    p = TRUTH.craft().parameters
    v_j = seen.thrust.jet_velocity
    assert p["rho"].value * p["A_j"].value * v_j * (v_j - APPROACH_SPEED) == pytest.approx(seen.thrust.thrust)


def test_table_4_s_yaw_error_in_the_35_zigzag_exceeds_the_yaw_rate(seen):
    of = next(i for i in seen.table_4_implications if (i.run, i.channel) == (PublishedManoeuvre.ZIGZAG_35, "r"))
    assert of.largest < 0.0957
    assert of.amplitude_ratio > 3.5
    assert all(i.amplitude_ratio < 1.8 for i in seen.table_4_implications if i is not of)


def test_identifications_hold_with_any_motion():
    for of in equation_14_systems(reference_record(PublishedManoeuvre.TURN_35)).values():
        found = of.solve()
        truth = TRUTH.craft().parameters
        assert found == pytest.approx({n: truth[n].value for n in found}, rel=1e-6)


def test_mass_is_in_proportion_to_density():
    assert table_1_mass(2.0).block == pytest.approx(2.0 * table_1_mass(1.0).block)
