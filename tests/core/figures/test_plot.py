"""The plotter: round ticks, equal scales, gaps that stay gaps, names shortened only where something is left."""

import numpy as np
import pytest

from seatrial.core.figures.plot import PLAIN, Panel, common_prefix, drawing, span, text, tick_text, ticks
from seatrial.core.figures.tracks import TrackView, equal_scale_panel
from seatrial.core.values import Record


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-37.0, 41.0), (0.66, 1.21), (-3e-4, 2e-4), (0.0, 2075.0)])
@pytest.mark.parametrize("about", [2, 4, 8])
def test_ticks_are_round_within_the_range_and_about_as_many(low: float, high: float, about: int) -> None:
    found = ticks(low, high, about)
    assert all(low - 1e-9 <= t <= high + 1e-9 for t in found)
    assert max(2, about / 2) <= len(found) <= 2 * about
    assert np.ptp(np.diff(found)) < 1e-9 * (high - low)


def test_a_tick_is_written_with_a_true_minus_and_zero_without() -> None:
    assert tick_text(-2.5, (-5.0, 5.0)) == "−2.5"
    assert tick_text(-1e-17, (-5.0, 5.0)) == "0"


def test_a_gap_breaks_the_line() -> None:
    panel = Panel(0, 0, 100, 100, (0.0, 4.0), (0.0, 1.0))
    drawn = panel.curve(np.arange(5.0), np.array([0.0, 1.0, np.nan, 1.0, 0.0]), PLAIN)
    assert drawn.count("M") == 2 and "nan" not in drawn


def test_values_grow_upwards_unless_told_otherwise() -> None:
    up = Panel(0, 0, 100, 100, (0.0, 1.0), (0.0, 1.0))
    down = Panel(0, 0, 100, 100, (0.0, 1.0), (0.0, 1.0), is_y_down=True)
    assert up.py(1.0) < up.py(0.0) and down.py(1.0) > down.py(0.0)


def test_constant_and_empty_curves_have_a_range() -> None:
    for values in (np.full(9, 3.0), np.zeros(9), np.full(9, np.nan)):
        low, high = span([values])
        assert high > low


def test_a_track_keeps_its_shape() -> None:
    at = np.linspace(0.0, 1.0, 50)
    record = Record.from_arrays("turn", at, {"x0": 300.0 * at, "y0": 20.0 * at})
    for view in (TrackView(is_rotated=True), TrackView(is_rotated=False)):
        panel = equal_scale_panel([record], view, 10.0, (0.0, 0.0, 400.0, 90.0))
        across, along = (panel.x[1] - panel.x[0]) / 400.0, (panel.y[1] - panel.y[0]) / 90.0
        assert across == pytest.approx(along)
        assert panel.x[0] < float(np.min(view.horizontal(record))) and panel.x[1] > float(
            np.max(view.horizontal(record))
        )


def test_names_lose_their_common_beginning_only() -> None:
    assert common_prefix(["HSVA_KVLCC2_Z_05_01", "HSVA_KVLCC2_Z_10_05"]) == "HSVA_KVLCC2_Z_"
    assert common_prefix(["zigzag", "turn"]) == "" and common_prefix(["alone_in_the_world"]) == ""


def test_words_in_pictures_are_escaped() -> None:
    assert "<b>" not in drawing([text(0, 0, "<b>")], 10, '"><b>')
