"""A short trial of the waterjet craft, small enough to be designed in a test."""

import math

import pytest

from seatrial.core.results import Actuator, TrialLimits
from seatrial.core.values import Ship
from seatrial.data.example_series.series import JET_VELOCITY, SENSOR_NOISE
from seatrial.estimation.design.task import DesignTask
from seatrial.physics.models import model_named

NOZZLE = Actuator("delta", -math.radians(35.0), math.radians(35.0), math.radians(4.0), 15.0)
JET = Actuator("v_j", 1.4, 2.4, 0.2, 30.0)


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
        rate=5.0,
        duration=180.0,
        actuators=(NOZZLE,),
        limits=TrialLimits(),
        held={"v_j": JET_VELOCITY},
        draws=3,
    )
