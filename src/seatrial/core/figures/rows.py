"""Panels with a name for each row: dots, bars or intervals over a common axis."""

import math
from collections.abc import Sequence

from seatrial.core.figures.chart import WIDTH, Axis, Panel, Region, row_axis
from seatrial.core.figures.marks import GREY, Anchor, Mark, Text, text_width
from seatrial.core.figures.ticks import Tick, whole_decades
from seatrial.core.text.numbers import exact

# height of a row [px]; share of the width that names take at most
ROW, MAX_NAME_SHARE = 18.0, 0.45
SMALL = 10.5  # px, chosen


# px, chosen
def row_panel(names: Sequence[str], x: Axis, marks: Sequence[Mark], *, top: float = 22.0, right: float = 24.0,
              has_grid: bool = False, width: float = WIDTH) -> Panel:  # fmt: skip
    """Return a panel whose row k lies at y = k, the first on top; `top` and `right` px are free beside it."""
    widest = max((text_width(name, SMALL) for name in names), default=0.0)
    left = min(MAX_NAME_SHARE * width, widest + 14.0)  # px, chosen
    box = Region(left, top, width - left - right, ROW * len(names))
    return Panel(box, x, row_axis(names, has_grid=has_grid), tuple(marks), is_y_down=True)


def decades_axis(values: Sequence[float], least: tuple[float, float], name: str, unit: str = "") -> Axis:
    """Return a logarithmic axis of whole decades about positive values, at least those of `least`."""
    low, high = (round(math.log10(end)) for end in whole_decades(values, least))
    ticks = tuple(Tick(10.0**power, exact(10.0**power) + unit) for power in range(low, high + 1))
    return Axis((10.0**low, 10.0**high), name, is_logarithmic=True, ticks=ticks)


def no_information(axis: Axis, row: int, colour: str = GREY) -> Text:
    """Return the note of a row whose value lies beyond any axis."""
    return Text(axis.ends[1], row, "no information ▸", Anchor.END, SMALL, colour, dx=-6.0, dy=4.0)
