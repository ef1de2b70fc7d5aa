"""Without a table [design] a manoeuvre is like the recorded ones."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError, Record, Ship
from seatrial.data.trial import Role, Trial, TrialRun
from seatrial.estimation.design.task import recorded_request
from seatrial.physics.models import model_named

TIME = 0.5 * np.arange(600)


def _trial(rudder_deg: float) -> Trial:
    generator = np.random.default_rng(3)
    delta = np.radians(rudder_deg) * np.clip(4.0 * np.sin(0.1 * TIME), -1.0, 1.0)
    noise = np.radians(0.2) * generator.standard_normal(TIME.size)
    record = Record.from_arrays("run", TIME, {"delta": delta, "psi": 0.3 * np.sin(0.1 * TIME) + noise})
    return Trial(Ship("craft", {"L": 30.0}), (TrialRun(record, Role.TRAIN),), model_named("nomoto"))


def test_orders_go_as_far_as_recorded_and_sensors_are_as_good() -> None:
    request, sensors = recorded_request(_trial(20.0))
    (rudder,) = request.actuators
    assert (request.duration, request.rate) == (pytest.approx(299.5), 1.0)
    assert np.degrees([rudder.lower, rudder.upper]) == pytest.approx([-20.0, 20.0], abs=0.1)
    assert np.degrees(rudder.rate) == pytest.approx(8.0, rel=0.2)
    assert np.degrees(sensors["psi"]) == pytest.approx(0.2, rel=0.2)


def test_a_trial_without_moving_inputs_or_records_is_refused() -> None:
    with pytest.raises(InputError, match="no input moves"):
        recorded_request(_trial(0.0))
    with pytest.raises(InputError, match=r"no table \[design\]"):
        recorded_request(replace(_trial(20.0), runs=()))
