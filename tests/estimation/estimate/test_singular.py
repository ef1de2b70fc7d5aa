"""Directions that no record can tell are named."""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.example_series.series import SENSOR_NOISE, with_sensor_noise
from seatrial.estimation.estimate.plausibility import refuse_singular, weakest_direction
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre


@pytest.fixture(scope="module")
def record() -> Record:
    clean = manoeuvre(
        waterjet(), programme("zigzag:20/20"), inputs={"v_j": 1.866}, slew_rate=math.radians(4.0), duration=200.0
    )
    return with_sensor_noise(clean, np.random.default_rng(2), 2)


def curvature(model: Model, record: Record) -> tuple[np.ndarray, tuple[str, ...], np.ndarray]:
    """Information about the coefficients at the truth, initial state unknown."""
    problem = OutputError(
        model, cut_segments(model, [record], tuple(SENSOR_NOISE), None), np.array([*SENSOR_NOISE.values()])
    )
    return (
        problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1],
        problem.free,
        problem.start(),
    )


def freed(*names: str) -> Model:
    model = waterjet()
    return model.with_parameters(model.parameters.freed(*names))


@pytest.mark.parametrize(
    ("extra", "named"),
    [
        (("A_j", "m_x", "m_y", "J_z"), {"A_j", "m_x", "N_v", "N_r", "Y_v"}),
        (("x_T", "J_z"), {"x_T", "J_z", "N_v", "N_r", "N_rr"}),
    ],
)
def test_scalings_of_the_equations_are_found(record: Record, extra: tuple[str, ...], named: set[str]) -> None:
    """All forces and inertias times one number, or the yaw row alone: every trajectory is the same."""
    curved = curvature(freed(*extra), record)
    share, direction = weakest_direction(*curved)
    assert share < 1e-13
    assert named <= set(direction.split()[1::2])
    with pytest.raises(
        InputError, match=r"do not determine the direction .* fix one of these parameters under \[model"
    ):
        refuse_singular(*curved)


@pytest.mark.parametrize("extra", [(), ("A_j",)])
def test_what_can_be_stated_is_not_refused(record: Record, extra: tuple[str, ...]) -> None:
    refuse_singular(*curvature(freed(*extra), record))


def test_relative_changes_along_a_scaling_are_equal(record: Record) -> None:
    direction = weakest_direction(*curvature(freed("x_T", "J_z"), record))[1].split()
    changes = dict(zip(direction[1::2], map(float, direction[::2]), strict=True))
    np.testing.assert_allclose([changes[n] for n in ("N_v", "N_r", "N_rr", "x_T")], 1.0, atol=0.06)


def test_a_parameter_without_influence_is_named_alone() -> None:
    hessian = np.diag([1.0, 0.0, 2.0])
    assert weakest_direction(hessian, ("a", "b", "c"), np.ones(3)) == (0.0, "b")
