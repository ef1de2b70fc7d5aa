"""A controller written from gains.toml alone does what the page says, by a simulator of its own."""

import tomllib

import numpy as np
import pytest
from benchmarks.controllers_at_sea import (
    CRAFTS,
    Craft,
    largest_sensitivity,
    simulate,
)
from benchmarks.second_simulator import DEGREE, OVERSHOOT, PEAK, QUICK, SETTLING, tuning_of

from seatrial.data.folder.gains_file import gains_toml


@pytest.mark.parametrize("craft", CRAFTS[:1], ids=lambda c: c.name)
def test_page_and_simulator_agree(craft: Craft) -> None:
    _, tuning = tuning_of(craft.loop_file(), effort=QUICK)
    text, change = gains_toml(tuning), tuning.manoeuvres[0]
    T = tomllib.loads(text)["discrete"]["sample_s"]
    made = simulate(
        craft, text, lambda t: craft.change * DEGREE if t >= 0.5 * T else 0.0, float(change.record.time[-1])
    )
    share = made.heading / (craft.change * DEGREE)
    assert 100.0 * change.overshoot == pytest.approx(100.0 * max(0.0, share.max() - 1.0), abs=OVERSHOOT)
    settled = made.dt * (np.flatnonzero(np.abs(share - 1.0) > 0.05)[-1] + 1) - T
    assert change.settling == pytest.approx(settled, rel=0.01 * SETTLING)
    assert tuning.chosen.Ms == pytest.approx(largest_sensitivity(craft, text), abs=PEAK)
    assert change.overshoot < 0.02
