"""Rate, dead time and lag of a steering gear from its own record of order and angle."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import PATROL_BOAT, write_loop_file

from seatrial.control.actuator_log import actuator_response, logged_records, simulated_angles
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import ActuatorSpread
from seatrial.core.values import Channel, InputError, Record, RecordKind
from seatrial.data.read import write_record_csv

RATE, DEAD_TIME, LAG = math.radians(4.0), 0.7, 0.9


def logged(seed: int, *, rate: float = RATE, step: float = 0.2, largest: float = 12.0) -> Record:
    """A gear integrated by Euler in steps of 2 ms between orders that change every few seconds; 0.1 deg of noise."""
    rng = np.random.default_rng(seed)
    fine, count = 0.002, 100_000
    orders = np.repeat(np.radians(rng.uniform(-largest, largest, count // 2613 + 1)), 2613)[:count]
    angle, angles, late = 0.0, np.empty(count), round(DEAD_TIME / fine)
    for k in range(count):
        angles[k] = angle
        target = orders[k - late] if k >= late else 0.0
        angle += fine * min(max((target - angle) / LAG, -rate), rate)
    kept = slice(0, None, round(step / fine))
    noisy = angles[kept] + math.radians(0.1) * rng.standard_normal(len(angles[kept]))
    series = {"delta_ref": orders[kept], "delta": noisy}
    channels = {name: Channel.from_notation(name, values) for name, values in series.items()}
    return Record(f"gear {seed}", fine * np.arange(count)[kept], channels, RecordKind.MEASURED)


def test_the_response_is_found_within_its_interval() -> None:
    inside = []
    for seed in range(6):
        found = actuator_response([logged(seed)], "delta")
        assert found.rate == pytest.approx(RATE, rel=0.05)
        assert found.dead_time == pytest.approx(DEAD_TIME, abs=0.1)
        assert found.lag == pytest.approx(LAG, rel=0.1)
        inside += [
            abs(found.rate - RATE) <= found.rate_error, abs(found.dead_time - DEAD_TIME) <= found.dead_time_error,
            abs(found.lag - LAG) <= found.lag_error,
        ]  # fmt: skip
    assert sum(inside) >= 16


def test_a_rate_that_is_never_reached_is_not_stated() -> None:
    found = actuator_response([logged(3, rate=math.radians(200.0), largest=3.0)], "delta")
    assert math.isnan(found.rate) and "no largest rate is reached" in found.sentence("delta")
    assert found.lag == pytest.approx(LAG, rel=0.2)


def test_an_order_straight_between_samples_is_followed_exactly_at_the_end() -> None:
    time = np.arange(0.0, 60.0, 0.1)
    moved = simulated_angles(time, np.full(len(time), 0.2), 0.0, 0.02, 1.0, 0.5)
    assert moved[-1] == pytest.approx(0.2) and np.diff(moved).max() <= 0.02 * 0.1 * (1.0 + 1e-12)


def test_a_log_without_orders_says_which_column_to_declare() -> None:
    record = logged(0)
    with pytest.raises(InputError, match="declare the column of the order as alpha_f_ref"):
        actuator_response([record], "alpha_f")


def test_a_loop_is_simulated_with_what_the_log_shows(tmp_path: Path) -> None:
    write_record_csv(logged(1), tmp_path / "gear.csv")
    assert len(logged_records(tmp_path / "gear.csv")) == 1
    undeclared = ('rate = { value = 8, unit = "deg/s" }\ndead_time = 0.5', 'log = "gear.csv"')
    task = tuning_task(write_loop_file(tmp_path, PATROL_BOAT, undeclared))
    assert task.constraints.rate == pytest.approx(RATE, rel=0.03)
    assert task.loop.sampling is not None and task.loop.sampling.dead_time == pytest.approx(DEAD_TIME, abs=0.1)
    (lag,) = task.loop.servo
    assert -1.0 / lag.poles[0].real == pytest.approx(LAG, rel=0.15)
    assert task.uncertainty.dead_time is not None and task.uncertainty.dead_time > task.loop.sampling.dead_time
    assert "by its log" in task.plant
    spread = task.uncertainty.actuator
    assert spread.rate < ActuatorSpread().rate and spread.stall == ActuatorSpread().stall
    assert spread.dead_time * task.loop.sampling.dead_time == pytest.approx(
        task.uncertainty.dead_time - task.loop.sampling.dead_time
    )


def test_what_the_file_declares_is_kept(tmp_path: Path) -> None:
    write_record_csv(logged(1), tmp_path / "gear.csv")
    task = tuning_task(write_loop_file(tmp_path, PATROL_BOAT, ("dead_time = 0.5", 'dead_time = 0.5\nlog = "gear.csv"')))
    assert task.constraints.rate == pytest.approx(math.radians(8.0))
    assert task.loop.sampling is not None and task.loop.sampling.dead_time == 0.5
    assert task.uncertainty.actuator == ActuatorSpread()
