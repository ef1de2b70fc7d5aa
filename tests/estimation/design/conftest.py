"""A short trial of the waterjet craft, small enough to be designed in a test."""

import math
from dataclasses import replace

import pytest

from seatrial.core.results import TrialLimits
from seatrial.core.values import Ship
from seatrial.data.example_series import JET_VELOCITY, SENSOR_NOISE
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.task import DesignTask
from seatrial.physics.models import model_named

NOZZLE_RANGE = InputRange(
    lower=-math.radians(35.0), upper=math.radians(35.0), unit="rad", rate=math.radians(4.0), hold=15.0
)
JET_RANGE = InputRange(lower=1.4, upper=2.4, unit="m/s", rate=0.2, hold=30.0)
NOZZLE, JET = NOZZLE_RANGE.actuator("delta"), JET_RANGE.actuator("v_j")
BOTH = {"delta": NOZZLE_RANGE, "v_j": JET_RANGE}


def with_inputs(task: DesignTask, inputs: dict[str, InputRange], held: dict[str, float]) -> DesignTask:
    """The task with other inputs to move and to hold."""
    return replace(task, request=replace(task.request, inputs=inputs, held=held))


def with_limits(task: DesignTask, limits: TrialLimits) -> DesignTask:
    """The task within other limits."""
    drift, room = (None if math.isinf(limit) else limit for limit in (limits.drift, limits.sea_room))
    request = replace(task.request, drift=drift, sea_room=room, every_ship=limits.for_every_ship)
    return replace(task, request=request)


@pytest.fixture(scope="session")
def craft() -> DesignTask:
    """Three minutes, the nozzle alone, four coefficients, drift free."""
    model = model_named("waterjet")
    model = model.with_parameters(model.parameters.only_free(("X_uu", "Y_v", "N_v", "N_r")))
    return DesignTask(
        question="how?",
        ship=Ship("craft", {"L": 9.8}),
        model=model,
        sensors=SENSOR_NOISE,
        request=DesignRequest(
            duration=180.0, rate=5.0, inputs={"delta": NOZZLE_RANGE}, held={"v_j": JET_VELOCITY}, draws=3
        ),
    )
