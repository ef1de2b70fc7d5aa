"""The step of the search divides every hold, and leaves the errors of ships what they are at the sensors' rate."""

import numpy as np
import pytest
from tests.estimation.design.conftest import BOTH, with_inputs
from tests.estimation.design.test_thruster_craft import task as thruster_task

from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.search import binary_sequence_inputs, search_step
from seatrial.estimation.design.task import DesignTask, draw_ships


def worst_errors(task: DesignTask, dt: float) -> np.ndarray:
    """Of another sequence than the one by which the step was chosen."""
    evaluator = ManoeuvreEvaluator(task, draw_ships(task, 0), dt)
    return evaluator.evaluate(binary_sequence_inputs(task.shortest_hold, 0.4, 3, evaluator)).relative_errors.max(axis=1)


def test_steps_divide_every_hold_and_leave_the_errors_what_they_are(craft: DesignTask) -> None:
    task = with_inputs(craft, BOTH, {})
    step = search_step(task, draw_ships(task, 0))
    spans = np.array([task.request.duration, *(a.hold for a in task.request.actuators)])
    assert np.array_equal(spans / step, np.round(spans / step))
    assert step >= 5.0 / task.request.rate, "a fifth of the samples at most"
    right = worst_errors(task, 1.0 / task.request.rate)
    divided, undivided = (np.max(np.abs(worst_errors(task, dt) / right - 1.0)) for dt in (step, 1.6))
    assert divided < 0.05
    assert undivided > 2.0 * divided, "orders change between steps of 1.6 s"


def test_a_quick_craft_takes_shorter_steps() -> None:
    """Steps of a quarter of the hold would lose ships that the sensors' rate does not."""
    task = thruster_task()
    assert search_step(task, draw_ships(task, 0)) == pytest.approx(0.2)
    assert np.isnan(worst_errors(task, 0.5)).sum() > np.isnan(worst_errors(task, 0.1)).sum()
