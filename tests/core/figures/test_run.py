"""Runs: tracks, channels over time, and bands about both."""

import numpy as np
import pytest

from seatrial.core.figures.chart import Area, Line, Region, Stroke
from seatrial.core.figures.run import (
    BAND,
    NARROW,
    ChannelPanel,
    RunView,
    TimeCurve,
    Track,
    band,
    channel_panel,
    extents,
    hull_outline,
    is_slender,
    run_chart,
    strip_height,
    track_chart,
    track_corridor,
    track_panel,
    visible_edges,
)

# The channels of a run stand beside its track, or below it where it is a strip.

TIME = np.linspace(0.0, 100.0, 300)
STROKE = Stroke("#000000", 1.0)
CHANNEL = ChannelPanel("u [m/s]", (TimeCurve(TIME, np.sin(TIME), STROKE),))


def test_a_strip_lies_above_the_channels_and_a_square_track_beside_them() -> None:
    strip, square = (
        run_chart(RunView("r", (CHANNEL,) * 4, (Track(TIME, width * TIME, None, STROKE),), 5.0)) for width in (0.1, 1.0)
    )
    assert strip.panels[1].box.top > strip.panels[0].box.bottom
    assert square.panels[1].box.left > square.panels[0].box.right
    assert all(p.box.right <= 864.0 for p in (*strip.panels, *square.panels))


def test_only_the_last_of_each_column_names_the_time() -> None:
    chart = run_chart(RunView("r", (CHANNEL,) * 5))
    assert [panel.x.name for panel in chart.panels] == ["", "", "t [s]", "t [s]", "t [s]"]


def test_a_band_is_drawn_below_its_curve_and_widens_the_axis() -> None:
    plain = channel_panel(CHANNEL, Region(0.0, 0.0, 100.0, 100.0))
    wide = channel_panel(ChannelPanel("u", CHANNEL.curves, np.full(300, -2.0), np.full(300, 2.0)), plain.box)
    assert isinstance(wide.marks[0], Area) and wide.marks[0].fill == BAND
    assert wide.y.ends[1] > 2.0 > plain.y.ends[1]


def test_a_track_by_itself_is_no_wider_than_a_page() -> None:
    widths = {}
    for name, east in (("strip", 0.1), ("square", 1.0)):
        chart = track_chart(RunView("r", (), (Track(TIME, east * TIME, None, STROKE),), 5.0))
        assert chart is not None and len(chart.panels) == 1
        widths[name] = chart.width
    assert widths["square"] < widths["strip"] <= 864.0
    assert track_chart(RunView("r", (CHANNEL,))) is None


def test_a_strip_is_made_for_a_telephone_with_letters_of_the_same_size() -> None:
    view = RunView("r", (), (Track(TIME, 0.1 * TIME, None, STROKE),), 5.0)
    wide, narrow = track_chart(view), track_chart(view, NARROW)
    assert wide is not None and narrow is not None and narrow.width <= NARROW
    assert narrow.panels[0].tick_size == wide.panels[0].tick_size


# Tracks keep their shape, lie on their side where they are long, and hulls point where they head.

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


# Bands enclose their curve, and along a track have the half width to its side.


def test_a_band_runs_along_one_edge_and_back_along_the_other() -> None:
    x = np.arange(4.0)
    area = band(x, x - 1.0, np.array([1.0, 2.0, np.nan, 4.0]))
    assert area.x == pytest.approx([0.0, 1.0, 3.0, 3.0, 1.0, 0.0])
    assert area.y == pytest.approx([-1.0, 0.0, 2.0, 4.0, 2.0, 1.0])


def test_axes_follow_a_band_no_further_than_the_curves_span() -> None:
    low, high = visible_edges([np.array([0.0, 2.0])], np.array([-9.0, -1.0]), np.array([1.0, 50.0]))
    assert low.min() == -2.0 and high.max() == 4.0
    assert visible_edges([np.full(3, np.nan)], low, high) == []


def winding(area: Area, east: float, north: float) -> int:
    """How often an outline runs round a point: where it is not 0, the point is filled."""
    turns = np.diff(np.unwrap(np.arctan2(area.y - north, area.x - east)))
    return round(float(turns.sum()) / (2.0 * np.pi))


def test_a_corridor_has_the_half_width_to_the_side_of_the_track() -> None:
    """North at 3 m to the sides (east), whatever the half width along the track."""
    east, north = np.zeros(50), np.linspace(10.0, 90.0, 50)
    area = track_corridor(east, north, np.full(50, 3.0), np.full(50, 20.0))
    assert area is not None and (area.x.min(), area.x.max()) == pytest.approx((-3.0, 3.0))
    assert track_corridor(east * np.nan, north, east, east) is None


def test_a_corridor_goes_on_to_the_end_of_its_track_and_fills_each_place_once_or_more() -> None:
    """A circle of 100 m whose position is known to 150 m at its end: all places within that are filled, none beyond."""
    share = np.linspace(0.0, 1.0, 400)
    east, north, half = 100.0 * np.sin(6.0 * share), 100.0 * np.cos(6.0 * share), 150.0 * share
    area = track_corridor(east, north, half, half)
    assert area is not None
    for x, y in np.random.default_rng(3).uniform(-260.0, 260.0, (300, 2)):
        beyond = float(np.min(np.hypot(x - east, y - north) - half))
        if abs(beyond) > 4.0:  # m, by which the edges of polygons are inside of ellipses
            assert (winding(area, x, y) > 0) == (beyond < 0.0) and winding(area, x, y) >= 0


def test_a_noisy_track_is_drawn_through_local_means() -> None:
    time = np.arange(0.0, 1000.0, 0.1)
    noisy = time + np.random.default_rng(1).normal(0.0, 5.0, len(time))
    (line,) = [m for m in track_panel([Track(noisy, time, None, STROKE)], 0.0, Region(0.0, 0.0, 90.0, 90.0)).marks
               if isinstance(m, Line)]  # fmt: skip
    assert float(np.std(line.y[1:-1] - line.x[1:-1])) == pytest.approx(5.0 / np.sqrt(len(time) / 240), rel=0.2)


@pytest.mark.parametrize(
    ("label", "largest", "expected", "drawn"),
    [
        ("F3 [N], input", 2e6, "F3 [MN], input", 2.0),
        ("M5 [N m]", 3e4, "M5 [kN m]", 30.0),
        ("X [N]", 9.0, "X [N]", 9.0),
        ("t [s]", 1e6, "t [s]", 1e6),
    ],
)
def test_large_forces_are_drawn_in_a_unit_that_suits_them(
    label: str, largest: float, expected: str, drawn: float
) -> None:
    curve = TimeCurve(np.arange(3.0), largest * np.array([np.nan, -1.0, 1.0]), STROKE)
    channel = RunView("forces", (ChannelPanel(label, (curve,), curve.values, curve.values),)).channels[0]
    assert (channel.label, channel.curves[0].values[-1], channel.upper[-1]) == (expected, drawn, drawn)
