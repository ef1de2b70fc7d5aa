"""Baselines without physics: exact where the truth is of their kind, constant where they must be."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.predict.black_box import (
    Features,
    black_box_errors,
    constant_velocity,
    fit_black_box,
    linear_features,
    quadratic_features,
)


@pytest.fixture(scope="module")
def record() -> Record:
    """A linear system with one command: du/dt = c - 0.5 u, dr/dt = 0.4 c - r, v at rest; track integrated."""
    dt, command = 0.1, np.repeat(np.random.default_rng(1).uniform(-1, 1, 40), 20)
    u, r = np.zeros((2, len(command)))
    for k in range(1, len(command)):
        u[k] = u[k - 1] + dt * (command[k - 1] - 0.5 * u[k - 1])
        r[k] = r[k - 1] + dt * (0.4 * command[k - 1] - r[k - 1])
    psi = np.concatenate([[0.0], np.cumsum(0.5 * dt * (r[1:] + r[:-1]))])
    rates = [u * np.cos(psi), u * np.sin(psi)]
    x0, y0 = (np.concatenate([[0.0], np.cumsum(0.5 * dt * (q[1:] + q[:-1]))]) for q in rates)
    channels = {"command_1": command, "u": u, "v": np.zeros_like(u), "r": r, "psi": psi, "x0": x0, "y0": y0}
    return Record.from_arrays("linear", dt * np.arange(len(u)), channels)


@pytest.mark.parametrize("features", [linear_features, quadratic_features])
def test_a_linear_system_is_predicted_by_regressions(record: Record, features: Features) -> None:
    box = fit_black_box([record], ("command_1",), features)
    errors = black_box_errors(box, [record], 10.0, 1.0)
    assert np.std(errors["u"]) < 0.02 * np.std(record["u"])
    assert np.std(errors["x0"]) < 0.1


def test_constant_velocity_misses_by_what_the_velocity_changes(record: Record) -> None:
    errors = black_box_errors(constant_velocity(("command_1",), record.dt), [record], 10.0, 1.0)
    rows = slice(10, 101)  # of the first window, behind its beginning
    np.testing.assert_allclose(errors["u"][rows], record["u"][5:10].mean() - record["u"][rows])
