"""What the trial file asks reaches the search; a model file takes the place of the trial's values."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Actuator
from seatrial.core.values import InputError, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial
from seatrial.data.trial.trial import Brief
from seatrial.estimation.design.asked import task_of
from seatrial.physics.models import model_named

NOZZLE = Actuator("delta", -0.6, 0.6, 0.07, 5.0)
BRIEF = Brief(300.0, 5.0, (NOZZLE,), {"v_j": 1.866}, draws=3, prior=0.2)


def trial(**changes: object) -> Trial:
    noise = {"u": 0.02, "psi": 0.003}
    made = Trial(Ship("craft", {"L": 9.8}), (), model_named("waterjet"), noise=noise, design=BRIEF)
    return replace(made, **changes)


def test_the_brief_becomes_a_task() -> None:
    task = task_of(trial(question="how?"))
    assert (task.question, task.duration, task.rate, task.draws, task.spread) == ("how?", 300.0, 5.0, 3, 0.2)
    assert task.actuators == (NOZZLE,)
    assert task.sensors == {"u": 0.02, "psi": 0.003}
    assert task.covariance is None
    assert task.start[0] == pytest.approx(0.8, rel=0.01)


def test_a_model_file_takes_the_place_of_the_trial_s_values() -> None:
    model = model_named("waterjet").with_values({"Y_v": -0.25})
    covariance = np.eye(11) * 1e-6
    task = task_of(trial(), ModelFile(model, covariance))
    assert task.model.parameters["Y_v"].value == -0.25
    assert task.covariance is not None and np.array_equal(task.covariance, covariance)
    assert task_of(trial(), ModelFile(model)).covariance is None


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"design": None}, r"there is no table \[design\]"),
        ({"noise": {}}, r"give \[noise\]"),
        ({"noise": {"thrust": 1.0}}, r"\[noise\] thrust is nothing that model 'waterjet' shows"),
        ({"design": replace(BRIEF, held={})}, "needs the input 'v_j'"),
        ({"model": model_named("waterjet").with_values({"X_rr": 0.0})}, "coefficient 'X_rr' is zero"),
    ],
)
def test_what_cannot_be_designed_is_refused(changes: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        task_of(trial(**changes))


def test_a_model_file_of_other_equations_is_refused() -> None:
    with pytest.raises(InputError, match="holds the equations 'nomoto', the trial 'waterjet'"):
        task_of(trial(), ModelFile(model_named("nomoto")))
