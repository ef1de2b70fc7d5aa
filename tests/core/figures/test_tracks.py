"""Tracks keep their shape, lie on their side where they are long, and hulls point where they head."""

import numpy as np
import pytest

from seatrial.core.figures.chart import Region
from seatrial.core.figures.marks import Area, Stroke
from seatrial.core.figures.tracks import Track, extents, hull_outline, is_slender, strip_height, track_panel

STROKE = Stroke("#000000", 1.0)
SHARE = np.linspace(0.0, 1.0, 50)
NORTHERLY = Track(300.0 * SHARE, 20.0 * SHARE, None, STROKE)
SQUARE = Track(90.0 * SHARE, 80.0 * SHARE, SHARE, STROKE)


@pytest.mark.parametrize("track", [NORTHERLY, SQUARE])
def test_a_track_keeps_its_shape_and_stays_inside(track: Track) -> None:
    panel = track_panel([track], 10.0, Region(0.0, 0.0, 400.0, 90.0))
    across, along = (panel.x.ends[1] - panel.x.ends[0]) / 400.0, (panel.y.ends[1] - panel.y.ends[0]) / 90.0
    assert across == pytest.approx(along)
    assert panel.x.ends[0] < 0.0 and panel.x.ends[1] > (300.0 if track is NORTHERLY else 80.0)


def test_a_northerly_track_lies_on_its_side() -> None:
    lying, standing = (track_panel([t], 0.0, Region(0.0, 0.0, 100.0, 100.0)) for t in (NORTHERLY, SQUARE))
    assert lying.is_y_down and lying.x.name.startswith("x₀, north")
    assert not standing.is_y_down and standing.x.name.startswith("y₀, east")


def test_hulls_stand_along_a_track_whose_heading_is_known() -> None:
    def hulls(track: Track, length: float) -> int:
        return sum(isinstance(m, Area) for m in track_panel([track], length, Region(0.0, 0.0, 100.0, 100.0)).marks)

    assert hulls(SQUARE, 5.0) == 7 and hulls(SQUARE, 0.0) == 0 == hulls(NORTHERLY, 5.0)


def test_slender_tracks_become_strips() -> None:
    assert extents([NORTHERLY, SQUARE]) == (300.0, 80.0)
    assert is_slender([NORTHERLY]) and not is_slender([SQUARE])
    assert strip_height([NORTHERLY], 620.0, 10.0) == pytest.approx(60.0)


def test_a_ship_heading_east_points_east() -> None:
    outline = hull_outline(0.0, 0.0, np.pi / 2, 10.0)
    assert np.isclose(outline[:, 1].max(), 5.0) and np.abs(outline[:, 0]).max() < 1.0


def test_positions_of_a_national_grid_are_counted_from_a_round_number() -> None:
    far = Track(5_312_370.0 + 40.0 * SHARE, 351_160.0 + 50.0 * SHARE, None, STROKE)
    panel = track_panel([far], 0.0, Region(0.0, 0.0, 300.0, 300.0))
    assert (panel.x.name, panel.y.name) == ("y₀, east of 351\u202f100 [m]", "x₀, north of 5\u202f312\u202f300 [m]")
    for axis, base in ((panel.x, 351_100.0), (panel.y, 5_312_300.0)):
        assert len(axis.tick_list()) >= 3
        assert all(float(tick.text) == pytest.approx(tick.value - base) for tick in axis.tick_list())
