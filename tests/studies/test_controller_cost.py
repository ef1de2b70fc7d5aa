"""Controllers tuned on wrong coefficients: against the closed-form optimum of a scalar plant, and on the ship."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial_studies.controller_cost import (
    TRUTH,
    WITHOUT_CONTROL,
    ControlledMotion,
    ControlTask,
    controller_costs,
    controller_rows,
    pitch_control_task,
    pitch_controller_costs,
    tuned_gains,
)
from seatrial_studies.heave_pitch_search import simulate_search_data

WEIGHT = 0.5


def scalar_task() -> ControlTask[float]:
    """x' = -a x + w - u, u = k x, w white of unit density: var(x) = 1 / (2 (a + k)), var(u) = k^2 var(x)."""

    def simulate(a: float, gains: Array) -> ControlledMotion:
        damping = a + float(gains[0])
        if damping <= 0.0:
            return ControlledMotion(math.inf, math.inf)
        return ControlledMotion(math.sqrt(0.5 / damping), abs(float(gains[0])) * math.sqrt(0.5 / damping))

    return ControlTask(simulate, np.array([1.0]), WEIGHT)


def optimal_gain(a: float) -> float:
    """Least (1 + W^2 k^2) / (a + k): W^2 k^2 + 2 W^2 a k - 1 = 0."""
    return -a + math.sqrt(a**2 + WEIGHT**-2)


@pytest.mark.parametrize("a", [0.2, 1.0, 3.0])
def test_tuned_gains_are_the_closed_form_optimum(a: float) -> None:
    assert tuned_gains(scalar_task(), a)[0] == pytest.approx(optimal_gain(a), rel=1e-6)


def test_the_cost_of_wrong_coefficients_is_that_of_the_closed_form() -> None:
    truth, wrong = 1.0, 1.6
    best, other = controller_costs({"wrong": wrong}, truth, scalar_task())

    def cost(k: float) -> float:
        return 0.5 * (1.0 + (WEIGHT * k) ** 2) / (truth + k)

    assert best.method == TRUTH and best.excess == pytest.approx(0.0, abs=1e-12)
    expected = cost(optimal_gain(wrong)) / cost(optimal_gain(truth)) - 1.0
    assert other.excess == pytest.approx(expected, rel=1e-4) and expected > 0.001
    assert other.predicted.output_rms < other.actual.output_rms


def test_a_controller_that_runs_away_on_the_truth_is_said_to() -> None:
    costs = controller_costs({"wrong": 5.0}, -0.5, scalar_task())
    best, wrong = controller_rows({"g": costs})
    assert "runs away" in wrong and best[-1] == pytest.approx(0.0, abs=1e-9)


def test_the_fin_damps_pitch_and_wrong_coefficients_cost_more_than_none() -> None:
    truth = simulate_search_data(135, np.random.default_rng(0), samples=3).truth
    still = pitch_control_task(135, 2.27, 0).simulate(truth, np.zeros(2))
    wrong = truth * np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 1.0])
    costs = pitch_controller_costs({135: {"pitch damping three times": wrong}}, {135: truth}, 2.27, 0)
    best, idle, other = costs[135]
    assert idle.method == WITHOUT_CONTROL and idle.actual == still and idle.excess > other.excess
    assert best.actual.output_rms < 0.9 * still.output_rms
    assert other.excess > 1e-3 and best.excess == pytest.approx(0.0, abs=1e-12)
    assert [row[:2] for row in controller_rows({"135°": costs[135]})] == [
        ("135°", TRUTH), ("135°", WITHOUT_CONTROL), ("135°", "pitch damping three times"),
    ]  # fmt: skip
