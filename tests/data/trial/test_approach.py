"""The approach condition: speed and held inputs before the rudder first moves, the median over records."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.check.phases import first_execution
from seatrial.data.trial.records import APPROACH_SECONDS, approach_condition
from seatrial.physics.models import model_named

EXECUTE = 5.0  # s, when the rudder is put over


def run(speed: float) -> Record:
    """A straight run at `speed` [m/s] that slows down after the execute."""
    time = np.arange(0.0, 20.0, 0.1)
    after = time >= EXECUTE
    channels = {"u": np.where(after, 0.5 * speed, speed), "delta": np.where(after, 0.3, 0.0), "v_j": 1.8 + 0.0 * time}
    return Record.from_arrays("run", time, channels)


def test_the_execute_is_where_the_rudder_moves() -> None:
    assert run(1.0).time[first_execution(run(1.0))] == pytest.approx(EXECUTE)


def test_the_approach_is_the_median_over_records_of_what_comes_before() -> None:
    condition = approach_condition([run(speed) for speed in (1.0, 1.2, 9.0)], model_named("waterjet"))
    samples = 10 * APPROACH_SECONDS + 1  # of them the last one is the execute's own
    assert condition["u"] == pytest.approx(1.2 * (1.0 - 0.5 / samples))
    assert condition["v_j"] == pytest.approx(1.8) and "delta" not in condition
