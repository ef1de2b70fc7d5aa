"""The channels of a run stand beside its track, or below it where it is a strip."""

import numpy as np

from seatrial.core.figures.bands import BAND
from seatrial.core.figures.chart import Region
from seatrial.core.figures.marks import Area, Stroke
from seatrial.core.figures.run import NARROW, ChannelPanel, RunView, TimeCurve, channel_panel, run_chart, track_chart
from seatrial.core.figures.tracks import Track

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
