"""A craft with two thrusters starts at rest: its design finishes, beats sequences, and knows no drift angle."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError, Ship
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.design import design
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.search import standard_manoeuvres
from seatrial.estimation.design.task import DesignTask, draw_ships
from seatrial.physics.models.thrusters import thrusters

NOISE = {"u": 0.03, "v": 0.03, "r": 0.01, "psi": 0.01, "x0": 0.1, "y0": 0.1}
SHARE = InputRange(lower=-1.0, upper=1.0, unit="1", rate=5.0, hold=2.0)


def task(drift: float | None = None) -> DesignTask:
    request = DesignRequest(
        duration=24.0, rate=10.0, inputs={"command_1": SHARE, "command_2": SHARE}, draws=2, sea_room=30.0, drift=drift
    )
    return DesignTask("which commands?", Ship("catamaran", {"L": 1.0}), thrusters(), NOISE, request)


def test_half_a_minute_identifies_all_coefficients_better_than_sequences_and_single_steps() -> None:
    result = design(task(), 0, confirmation_runs=0, generations=25)
    assert result.designed.executed["u"][0] == 0.0
    assert result.designed.worst < 0.5
    assert result.designed.worst < min(m.worst for m in result.baselines)
    assert result.designed.distance < 30.0
    assert math.isnan(result.designed.drift)
    assert "drift" not in str(result.summary())
    assert not {"drift", "straying"} & {f.code for f in result.findings}


def test_each_command_alone_is_stepped_ahead_and_astern() -> None:
    evaluator = ManoeuvreEvaluator(task(), draw_ships(task(), 0), 0.2)
    (steps,) = (m for m in standard_manoeuvres(evaluator) if m.name == "steps one by one")
    inputs = steps.inputs_for(evaluator)
    ends = inputs[29::30]  # the last sample of each of four steps of 6 s
    assert ends == pytest.approx(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]))


def test_coefficients_near_zero_count_by_their_size() -> None:
    one = task()
    ships = draw_ships(one, 0)
    errors = ManoeuvreEvaluator(one, ships, 0.2).evaluate(np.ones((120, 2)) * [1.0, 0.5]).relative_errors
    loss = one.model.parameters.free_names.index("k_J")
    values = ships.parameters[:, one.model.parameters.index("k_J")]
    assert values[0] == 0.0
    is_simulated = np.isfinite(errors[:, loss])
    assert is_simulated[0]
    assert 0.0 < np.max(values) < one.model.parameters["k_J"].scale
    assert np.max(errors[is_simulated, loss]) < 2.0 * errors[0, loss]


def test_a_limit_of_drift_is_refused() -> None:
    with pytest.raises(InputError, match="drift means nothing for a craft that turns on the spot"):
        task(drift=0.5)
