"""A craft with thrusters in its users' terms, against what follows from its coefficients by hand."""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.values import Record
from seatrial.estimation.identify.characteristics import craft_measures, thruster_craft
from seatrial.estimation.predict.draws import perturbed_models
from seatrial.physics.models import model_named

VALUES = {
    "k_f": 1.6, "p_f": 2.0, "k_J": 0.0, "k_b": 1.6, "p_b": 2.0, "k_4": 0.0, "X_u": 0.0, "X_uu": -0.8, "N_r": 0.0,
    "N_rr": -0.2, "N_ur": 0.0, "Y_uv": 0.0, "Y_NT": 0.1, "M_r": 0.15, "tau": 0.06, "tau_down": 0.06,
}  # fmt: skip


@pytest.fixture(scope="module")
def model() -> Model:
    return model_named("thrusters").with_values(VALUES)


@pytest.fixture(scope="module")
def basis(model: Model) -> IntervalBasis:
    """Every free coefficient known to 2 %."""
    return IntervalBasis(np.diag([(0.02 * p.value) ** 2 for p in model.parameters.free]), math.inf)


def run() -> Record:
    time = 0.1 * np.arange(50)
    return Record.from_arrays("run", time, {
        "u": np.full(50, 0.5), "psi": np.zeros(50), "command_1": np.full(50, 0.55), "command_2": np.full(50, -0.25),
    })  # fmt: skip


def test_top_speed_and_yaw_rate_balance_thrust_and_damping(model: Model, basis: IntervalBasis) -> None:
    """2 k_f = -X_uu u^2; arms of 0.3 m: 0.3 (k_f + k_b) = -N_rr r^2, with the same thrust ahead and astern."""
    measures = craft_measures(model, basis, 1.0)
    assert measures["top_speed"].value == pytest.approx(2.0, rel=5e-3)
    assert measures["yaw_rate_deg_s"].value == pytest.approx(math.degrees(math.sqrt(4.8)), rel=2e-3)
    # M_u du/dt = 3.2 - 0.8 u^2: u = 2 tanh(1.6 t); thrust with the square of a lagging command is 1.5 tau late
    expected = math.atanh(1.0 - math.exp(-1.0)) / 1.6 + 1.5 * 0.06
    assert measures["surge_time_constant_s"].value == pytest.approx(expected, abs=0.01)


def test_an_interval_of_top_speed_is_that_of_thrust_over_drag(model: Model, basis: IntervalBasis) -> None:
    """u = sqrt(2 k_f / -X_uu): a standard deviation of sqrt(2) 2 % / 2."""
    top = craft_measures(model, basis, 1.0)["top_speed"]
    assert top.lower is not None and top.upper is not None
    assert 0.5 * (top.upper - top.lower) == pytest.approx(1.96 * 2.0 * 0.02 / math.sqrt(2.0), rel=0.05)
    assert len(perturbed_models(model, basis)) == sum(p.value != 0.0 for p in model.parameters.free)


def test_thrust_curve_commands_and_matrices_follow_from_the_coefficients(model: Model, basis: IntervalBasis) -> None:
    craft = thruster_craft(model, [run()], basis, 1.0)
    assert craft is not None and craft.force_unit == "N/kg" and craft.compass is None
    (curve,) = craft.curves
    share = np.array(curve.share)
    assert np.allclose(curve.thrust, 1.6 * share * np.abs(share))
    assert curve.upper[-1] - curve.thrust[-1] == pytest.approx(1.96 * 0.02 * 1.6, rel=1e-3)
    assert sorted(curve.time_share)[-2:] == [0.5, 0.5] and curve.speed == 0.5
    matrices = {m.name: np.array(m.values) for m in craft.matrices}
    assert matrices["D_u"][0, 0] == 0.8 and matrices["D_r"][2, 2] == 0.2
    assert np.allclose(matrices["B"], [[1.0, 1.0], [0.1 * 0.3, -0.1 * 0.3], [0.3, -0.3]])


def test_other_models_have_no_such_chapter() -> None:
    assert thruster_craft(model_named("waterjet"), [], IntervalBasis(np.zeros((0, 0)), 1.0), 1.0) is None
