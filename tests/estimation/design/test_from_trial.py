"""What the trial file asks reaches the search; a model file takes the place of the trial's values."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.task import design_task
from seatrial.physics.models import model_named

NOZZLE = InputRange(lower=-0.6, upper=0.6, unit="rad", rate=0.07, hold=5.0)
REQUEST = DesignRequest(
    duration=300.0, rate=5.0, inputs={"delta": NOZZLE}, held={"v_j": 1.866}, draws=3, prior_percent=20.0
)


def trial(**changes: object) -> Trial:
    noise = {"u": 0.02, "psi": 0.003}
    made = Trial(Ship("craft", {"L": 9.8}), (), model_named("waterjet"), noise=noise, design_request=REQUEST)
    return replace(made, **changes)


def test_the_brief_becomes_a_task() -> None:
    task = design_task(trial(question="how?"))
    assert (
        task.question,
        task.request.duration,
        task.request.rate,
        task.request.draws,
        task.request.relative_spread,
    ) == ("how?", 300.0, 5.0, 3, 0.2)
    assert task.request.actuators == (NOZZLE.actuator("delta"),)
    assert task.sensors == {"u": 0.02, "psi": 0.003}
    assert task.covariance is None
    assert task.initial_state[0] == pytest.approx(0.8, rel=0.01)


def test_a_model_file_takes_the_place_of_the_trial_s_values() -> None:
    model = model_named("waterjet").with_values({"Y_v": -0.25})
    covariance = np.eye(11) * 1e-6
    task = design_task(trial(), ModelFile(model, covariance))
    assert task.model.parameters["Y_v"].value == -0.25
    assert task.covariance is not None and np.array_equal(task.covariance, covariance)
    assert design_task(trial(), ModelFile(model)).covariance is None


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"design_request": None}, r"there is no table \[design\]"),
        ({"noise": {}}, r"give \[noise\]"),
        ({"noise": {"thrust": 1.0}}, r"\[noise\] thrust is nothing that model 'waterjet' shows"),
        ({"design_request": replace(REQUEST, held={})}, "needs the input 'v_j'"),
        ({"model": model_named("waterjet").with_values({"X_rr": 0.0})}, "coefficient 'X_rr' is zero"),
    ],
)
def test_what_cannot_be_designed_is_refused(changes: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        design_task(trial(**changes))


def test_a_model_file_of_other_equations_is_refused() -> None:
    with pytest.raises(InputError, match="holds the equations 'nomoto', the trial 'waterjet'"):
        design_task(trial(), ModelFile(model_named("nomoto")))
