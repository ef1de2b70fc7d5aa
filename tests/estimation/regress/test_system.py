"""Equations that share no coefficient stand apart; constant and collinear features are named."""

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.values import InputError
from seatrial.estimation.regress.estimators import RegressionSystem, build_systems, refuse_degenerate
from seatrial.estimation.regress.operators import Central, Centred, Euler, RegressionMotion, Weak
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.waterjet import waterjet


def test_surge_sway_and_yaw_of_the_craft_stand_apart() -> None:
    """Three systems, eleven coefficients."""
    made = build_systems(waterjet(), [RegressionMotion.from_record(waterjet(), zigzags())], Central())
    assert [s.equations for s in made] == [("u",), ("v",), ("r",)]
    assert [n for s in made for n in s.names] == list(waterjet().parameters.free_names)


def test_equations_that_share_coefficients_stand_together() -> None:
    """With the origin off G the side forces enter sway and yaw."""
    from seatrial.estimation.regress.estimators import _coupled_equations

    ship = mmg()
    states = [[ship.states[i] for i in equations] for equations, _ in _coupled_equations(ship)]
    assert ["v", "r"] in states or ["u", "v", "r"] in states


def test_a_straight_run_tells_nothing_of_sway_and_is_stated_so() -> None:
    """No drift, no yaw: the features are zero."""
    straight = zigzags().between(0.0, 9.0)
    with pytest.raises(InputError, match=r"feature of X_vv, X_rr is zero.*manoeuvre"):
        build_systems(waterjet(), [RegressionMotion.from_record(waterjet(), straight)], Euler())


def test_a_steady_turn_centred_is_constant() -> None:
    """A constant feature less its mean is nothing."""
    motion = RegressionMotion.from_record(waterjet(), zigzags())
    still = RegressionMotion(motion.time, np.tile(motion.states[300], (len(motion.time), 1)), motion.inputs)
    with pytest.raises(InputError, match="X_uu, X_vv, X_rr is zero"):
        build_systems(waterjet(), [still], Centred(Euler()))


def test_collinear_features_are_named_and_others_are_not() -> None:
    """b = 3 a; c has nothing to do with it."""
    a, c = np.sin(np.arange(50.0)), np.cos(np.arange(50.0))
    system = RegressionSystem(("v",), ("Y_a", "Y_b", "Y_c"), np.stack([a, 3.0 * a, c], axis=1), a)
    with pytest.raises(InputError, match="features of Y_a, Y_b are collinear"):
        refuse_degenerate(system)


def test_runs_that_are_too_short_are_refused() -> None:
    """One window over the whole run is one row; three samples make none."""
    motion = RegressionMotion.from_record(waterjet(), zigzags())
    with pytest.raises(InputError, match="1 row for the 3 coefficients X_uu, X_vv, X_rr"):
        build_systems(waterjet(), [motion], Weak(1e4))
    with pytest.raises(InputError, match="no run is long enough"):
        build_systems(waterjet(), [motion.rows(slice(0, 4))], Weak(20.0))
