"""A few series of the coverage benchmark: ships the fitted model does not know, intervals that hold their measures."""

import interval_coverage as coverage
import numpy as np
import pytest

from seatrial.estimation.estimate.settings import IntervalMethod

SERIES = 2


@pytest.mark.long
def test_intervals_hold_what_is_measured() -> None:
    """Some 30 values of two ships: .85 is two standard deviations below .95 if a ship's values go together."""
    turns_and_zigzags = coverage.series(SERIES, 3, IntervalMethod.AUTO)
    assert len(turns_and_zigzags) > 12 * SERIES
    assert {t.kind for t in turns_and_zigzags} >= {"overshoot_deg", "tactical_diameter_L", "advance_L"}
    assert np.mean([t.is_inside for t in turns_and_zigzags]) >= 0.85
    halves = [t.half_width / t.measured for t in turns_and_zigzags if t.kind == "tactical_diameter_L"]
    assert 0.003 < np.median(halves) < 0.1


def test_the_table_can_fail() -> None:
    kinds = [coverage.MeasureInterval(0, "turn", "advance_L", 3.0, 3.2, half) for half in (0.1, 0.3)]
    rows = {line.quantity.split(" (")[0]: line for line in coverage.lines(kinds)}
    assert rows["turns: advance_L"].value == 0.5
    assert rows["pooled"].holds is False
