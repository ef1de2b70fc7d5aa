"""Positions of few digits come in steps; a sensor that stopped does not."""

import numpy as np
from tests.data.check.ship import with_values, zigzag

from seatrial.data.check.channels import channel_findings

STEP = 10.0  # m


def test_positions_in_steps_of_ten_metres_are_no_stuck_sensor() -> None:
    record = zigzag(noise=1.0)
    coarse = STEP * np.rint(np.linspace(0.0, 30.0 * STEP, len(record)) / STEP)
    (finding,) = [f for f in channel_findings(with_values(record, x0=coarse)) if "'x0'" in f.message]
    assert finding.code == "resolution" and "steps of 10 m" in finding.message


def test_a_coarse_sensor_that_stops_is_stuck() -> None:
    record = zigzag(noise=1.0)
    coarse = STEP * np.rint(np.linspace(0.0, 30.0 * STEP, len(record)) / STEP)
    coarse[1000:2000] = coarse[1000]
    codes = {f.code for f in channel_findings(with_values(record, x0=coarse)) if "'x0'" in f.message}
    assert codes == {"stuck"}
