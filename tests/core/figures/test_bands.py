"""Bands enclose their curve, and along a track have the half width to its side."""

import numpy as np
import pytest

from seatrial.core.figures.bands import WIDEST_ENVELOPE, band, track_envelope, visible_edges


def test_a_band_runs_along_one_edge_and_back_along_the_other() -> None:
    x = np.arange(4.0)
    area = band(x, x - 1.0, np.array([1.0, 2.0, np.nan, 4.0]))
    assert area.x == pytest.approx([0.0, 1.0, 3.0, 3.0, 1.0, 0.0])
    assert area.y == pytest.approx([-1.0, 0.0, 2.0, 4.0, 2.0, 1.0])


def test_axes_follow_a_band_no_further_than_the_curves_span() -> None:
    low, high = visible_edges([np.array([0.0, 2.0])], np.array([-9.0, -1.0]), np.array([1.0, 50.0]))
    assert low.min() == -2.0 and high.max() == 4.0
    assert visible_edges([np.full(3, np.nan)], low, high) == []


def test_an_envelope_has_the_half_width_to_the_side_of_the_track() -> None:
    """North at 3 m to the sides (east), whatever the half width along the track."""
    east, north = np.zeros(50), np.linspace(10.0, 90.0, 50)
    area = track_envelope(east, north, np.full(50, 3.0), np.full(50, 20.0))
    assert area is not None and (area.x.min(), area.x.max()) == pytest.approx((-3.0, 3.0))
    assert track_envelope(east[:2], north[:2], east[:2], east[:2]) is None


def test_an_envelope_ends_where_it_would_hide_the_track() -> None:
    east, north = np.zeros(50), np.linspace(0.0, 100.0, 50)
    area = track_envelope(east, north, np.linspace(0.0, 50.0, 50), np.zeros(50))
    assert area is not None and area.x.max() <= WIDEST_ENVELOPE * 100.0 and area.y.max() == pytest.approx(49.0, abs=2.0)
    assert track_envelope(east, north, np.full(50, 50.0), np.zeros(50)) is None
