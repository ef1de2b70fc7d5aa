"""Steering models against their step responses in closed form."""

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.numerics.kernels.integrate import replay
from seatrial.physics.models.nomoto import nomoto, nomoto2

DT, ROWS, STEP = 0.05, 2001, 0.2


def step_response(model: Model) -> Array:
    """Yaw rate after a rudder step of 0.2 rad from rest; r_rest starts where r' - K T_3 delta / (T_1 T_2) puts it."""
    n = len(model.states)
    y, failed = np.empty((ROWS, 1)), np.full(1, -1)
    replay(model.compiled.rates, model.compiled.outputs, np.full((ROWS, 1), STEP),
           np.array([[0, 0, ROWS]]), np.ones(1), np.array([0, ROWS]), 0, 1, DT, 1, np.zeros((1, n)),
           model.parameters.values[None].copy(), np.ones((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)),
           np.array([0]), 0, y, failed)  # fmt: skip
    return y[:, 0]


def test_first_order() -> None:
    t = DT * np.arange(ROWS)
    model = nomoto().with_values({"K": 0.15, "T": 8.0})
    np.testing.assert_allclose(step_response(model), 0.15 * STEP * (1 - np.exp(-t / 8.0)), atol=1e-9)


def test_second_order_with_its_zero() -> None:
    """r / delta = K (1 + T_3 s) / ((1 + T_1 s)(1 + T_2 s))."""
    t, K, T_1, T_2, T_3 = DT * np.arange(ROWS), 0.15, 20.0, 3.0, 5.0
    model = nomoto2().with_values({"K": K, "T_1": T_1, "T_2": T_2, "T_3": T_3})
    slow, fast = (T_1 - T_3) / (T_1 - T_2), (T_2 - T_3) / (T_1 - T_2)
    exact = K * STEP * (1 - slow * np.exp(-t / T_1) + fast * np.exp(-t / T_2))
    np.testing.assert_allclose(step_response(model), exact, atol=1e-8)
