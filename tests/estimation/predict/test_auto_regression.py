"""Regressions without physics: exact where the truth is of their kind, held where they would run away."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.predict.window_scores import Features, fit_auto_regression, linear_features, quadratic_features
from seatrial.estimation.predict.windows import Windows
from seatrial.physics.models import model_named
from seatrial.physics.models.nomoto import nomoto


@pytest.fixture(scope="module")
def record() -> Record:
    """A linear system with two commands: du/dt = c1 + c2 - 0.5 u, dr/dt = 0.4 (c1 - c2) - r; track integrated."""
    dt, (c1, c2) = 0.1, np.repeat(np.random.default_rng(1).uniform(-1, 1, (2, 40)), 20, axis=1)
    u, r = np.zeros((2, len(c1)))
    for k in range(1, len(c1)):
        u[k] = u[k - 1] + dt * (c1[k - 1] + c2[k - 1] - 0.5 * u[k - 1])
        r[k] = r[k - 1] + dt * (0.4 * (c1[k - 1] - c2[k - 1]) - r[k - 1])
    psi = np.concatenate([[0.0], np.cumsum(0.5 * dt * (r[1:] + r[:-1]))])
    rates = [u * np.cos(psi), u * np.sin(psi)]
    x0, y0 = (np.concatenate([[0.0], np.cumsum(0.5 * dt * (q[1:] + q[:-1]))]) for q in rates)
    channels = {"command_1": c1, "command_2": c2, "u": u, "r": r, "psi": psi, "x0": x0, "y0": y0}
    return Record.from_arrays("linear", dt * np.arange(len(u)), channels)


@pytest.mark.parametrize("features", [linear_features, quadratic_features])
def test_a_linear_system_is_predicted(record: Record, features: Features) -> None:
    regression = fit_auto_regression(model_named("thrusters"), [record], features, 1.0)
    assert regression is not None
    windows = Windows.cut([record], 10.0)
    for piece, predicted in zip(windows.pieces, regression.predict(windows, 1.0), strict=True):
        for channel, limit in (("u", 1e-3), ("r", 1e-3), ("psi", 1e-2), ("x0", 1e-2), ("y0", 1e-2)):
            assert np.max(np.abs(predicted[channel] - piece[channel])[10:]) < limit


def test_noise_of_the_beginning_is_no_merit(record: Record) -> None:
    noisy = record.with_channel(
        "u", record.channel("u").with_values(record["u"] + 0.1 * np.random.default_rng(2).standard_normal(len(record)))
    )
    regression = fit_auto_regression(model_named("thrusters"), [noisy], linear_features, 4.0)
    assert regression is not None
    windows = Windows.cut([noisy], 10.0)
    errors = [q["u"][:40] - p["u"][:40] for p, q in zip(windows.pieces, regression.predict(windows, 4.0), strict=True)]
    assert np.sqrt(np.mean(np.square(errors))) > 0.08


def test_a_difference_equation_is_recovered(rng: np.random.Generator) -> None:
    delta, r = rng.standard_normal(400), np.zeros(400)
    for k in range(2, 400):
        r[k] = 1.2 * r[k - 1] - 0.4 * r[k - 2] + 0.05 * delta[k - 1] + 0.02
    record = Record.from_arrays("arx", 0.5 * np.arange(400.0), {"r": r, "delta": delta, "psi": np.zeros(400)})
    arx = fit_auto_regression(nomoto(), [record], linear_features, 5.0)
    assert arx is not None
    assert arx.channels == ("r",)
    # of the step r(k) - r(k - 1): last r, the one before, last rudder, the one before
    np.testing.assert_allclose(arx.weights[:-1, 0] / arx.scale, [0.2, -0.4, 0.05, 0.0], atol=1e-6)


def test_what_runs_away_is_held_at_the_training_runs(record: Record) -> None:
    regression = fit_auto_regression(model_named("thrusters"), [record], linear_features, 1.0)
    assert regression is not None
    full = np.ones(len(record))
    driven = record.with_channel("command_1", record.channel("command_1").with_values(50.0 * full))
    (predicted,) = regression.predict(Windows.of_record(driven), 1.0)
    assert predicted["u"].max() == record["u"].max()


def test_without_a_velocity_there_is_none(record: Record) -> None:
    assert fit_auto_regression(model_named("thrusters"), [record.without("u", "r")], linear_features, 1.0) is None
