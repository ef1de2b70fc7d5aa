"""Long records are compared on fewer rows, which show the same faults."""

import numpy as np
from tests.data.check.ship import with_values, zigzag

from seatrial.core.values import Record, Severity
from seatrial.data.check import examine
from seatrial.data.check.phases import MOST_ROWS, comparison_stretch

COUNT = 4 * MOST_ROWS


def long_zigzag(turning: float, period: float) -> Record:
    """A ship whose heading swings only in the last third."""
    time = 0.1 * np.arange(COUNT)
    heading = turning * np.sin(2.0 * np.pi * time / period) * np.clip((time - time[-1] * 2 / 3) / 100.0, 0.0, 1.0)
    speed = np.full(COUNT, 2.0)
    x, y = np.cumsum(2.0 * np.cos(heading)) * 0.1, np.cumsum(2.0 * np.sin(heading)) * 0.1
    return Record.from_arrays("long", time, {"x0": x, "y0": y, "psi": heading, "u": speed, "v": 0.0 * speed})


def test_a_record_of_usual_length_is_compared_as_it_is() -> None:
    record = zigzag()
    assert comparison_stretch(record) is record


def test_slow_turning_is_averaged_and_stays_consistent() -> None:
    record = comparison_stretch(long_zigzag(0.05, 120.0))
    assert len(record) == MOST_ROWS and record.is_uniform
    np.testing.assert_allclose(record.duration, 0.1 * COUNT, rtol=1e-3)
    east = np.gradient(record["y0"], record.dt)
    np.testing.assert_allclose(east, record["u"] * np.sin(record["psi"]), atol=1e-3)


def test_of_quick_turning_the_liveliest_stretch_is_taken() -> None:
    record = comparison_stretch(long_zigzag(1.5, 60.0))
    assert len(record) <= MOST_ROWS and record.time[0] > 0.1 * COUNT / 5


def test_a_wrong_sign_in_a_long_record_is_found() -> None:
    record = long_zigzag(1.5, 60.0)
    wrong = with_values(record, psi=-record["psi"])
    assert [f.code for f in examine(wrong) if f.severity is Severity.ERROR] == ["wrong-sign"]
    assert [f.code for f in examine(record) if f.severity is Severity.ERROR] == []
