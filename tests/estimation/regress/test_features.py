"""Features are what the equations say: rates are known terms plus features times coefficients."""

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.values import InputError, Record
from seatrial.estimation.regress.operators import RegressionMotion, features
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import DRAUGHT, LENGTH, MASS, RHO, TABLE_2, waterjet


def test_rates_are_known_terms_plus_features_times_coefficients() -> None:
    """Known terms do not change with the coefficients."""
    craft, other = waterjet(), waterjet().with_values({"Y_v": -0.1, "N_rr": 0.0})
    motion = RegressionMotion.from_record(craft, zigzags())
    one, two = features(craft, motion), features(other, motion)
    np.testing.assert_allclose(one.known_rates, two.known_rates, atol=1e-14)
    rates = one.known_rates + one.slope @ np.array(list(TABLE_2.values()))
    middle = np.gradient(motion.states[:, 1], motion.dt)
    np.testing.assert_allclose(rates[50:-50, 1], middle[50:-50], atol=2e-4)


def test_the_published_features_come_out_of_the_equations() -> None:
    """Song et al. 2025, eq. (14), sway: [v U, r U L, v|v|, |v| r L, r|r| L^2] rho L d / 2 over the mass."""
    craft, record = waterjet(), zigzags()
    motion = RegressionMotion.from_record(craft, record)
    u, v, r = (record[s] for s in "uvr")
    speed, r_L = np.hypot(u, v), LENGTH * r
    by_hand = np.stack([v * speed, r_L * speed, v * abs(v), abs(v) * r_L, r_L * abs(r_L)], axis=1)
    by_hand *= 0.5 * RHO * LENGTH * DRAUGHT / (MASS * 1.785)
    places = [craft.parameters.free_names.index(n) for n in ("Y_v", "Y_r", "Y_vv", "Y_vr", "Y_rr")]
    np.testing.assert_allclose(features(craft, motion).slope[:, 1, places], by_hand, atol=1e-9)


def test_a_coefficient_that_is_not_linear_is_named() -> None:
    """The time constant of Nomoto's equation divides the gain."""
    ship = nomoto()
    record = Record.from_arrays(
        "run",
        np.arange(20.0),
        {"u": np.ones(20), "r": np.sin(np.arange(20.0)), "psi": np.zeros(20), "delta": np.ones(20)},
    )
    with pytest.raises(InputError, match="model 'nomoto' is not linear in K, T"):
        features(ship.with_values({"T": 8.0, "K": 0.1}), RegressionMotion.from_record(ship, record))


def test_stretches_end_where_samples_were_taken_away() -> None:
    """A gap of two samples parts the motion."""
    motion = RegressionMotion.from_record(waterjet(), zigzags())
    kept = np.r_[0:40, 42:90]
    cut = RegressionMotion(motion.time[kept], motion.states[kept], motion.inputs[kept])
    assert cut.gapless_slices() == [slice(0, 40), slice(40, 88)]


def test_a_sample_without_a_value_is_named_and_two_samples_are_too_few() -> None:
    """Cleaning takes it away; regression does not guess."""
    record = zigzags()
    v = record["v"].copy()
    v[30] = np.nan
    with pytest.raises(InputError, match=r"channel .v. has no value at sample 31; use regress\.cleaning"):
        RegressionMotion.from_record(waterjet(), record.with_channel("v", record.channel("v").with_values(v)))
    with pytest.raises(InputError, match="has 2 samples; regression needs at least three"):
        RegressionMotion.from_record(waterjet(), record.rows(slice(0, 2)))
