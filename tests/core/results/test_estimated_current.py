"""The current of a run is that of its own session, and none where nothing was estimated of it."""

from dataclasses import replace

import pytest
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Offset
from seatrial.core.results.prediction import estimated_current


def test_a_run_has_the_current_of_its_session() -> None:
    """0.3 m/s north and 0.4 m/s east are 0.5 m/s."""
    offsets = (
        Offset("current_north", "day 1", "m/s", 0.1, 0.01), Offset("current_east", "day 1", "m/s", 0.0, 0.01),
        Offset("current_north", "day 2", "m/s", 0.3, 0.02), Offset("current_east", "day 2", "m/s", 0.4, None),
    )  # fmt: skip
    run = fabricated_fit().predictions[0]
    second = estimated_current(replace(run, session="day 2"), offsets)
    assert second is not None
    assert second.speed == pytest.approx(0.5) and (second.north_error, second.east_error) == (0.02, 0.0)
    assert estimated_current(replace(run, session="day 3"), offsets) is None
    assert estimated_current(run, offsets) is None
