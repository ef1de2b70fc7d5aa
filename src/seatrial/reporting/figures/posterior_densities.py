"""Draws of each coefficient as a density."""

import numpy as np

from seatrial.core.figures.chart import ACCENT, SECOND, Axis, Chart, Line, Panel, Region, Stroke, tiles
from seatrial.core.results import CredibleInterval, Posterior
from seatrial.core.values import Array, display_unit
from seatrial.core.values.notation import unit_text
from seatrial.reporting.figures.directions import COLUMNS, HEIGHT

_BINS, _HEADROOM = 30, 1.1
"""Bins of a histogram, and what is drawn above the highest of them, over its height; chosen."""
_OWN, _OTHER = Stroke(SECOND, 0.9), Stroke(SECOND, 0.9, "3 2")  # px, chosen


def posterior_densities(posterior: Posterior) -> Chart:
    """Return a panel for each coefficient with the ends of both intervals."""
    boxes = tiles(len(posterior.coefficients), COLUMNS, HEIGHT, left=54.0, right=10.0, gap=46.0)  # px, chosen
    panels = (
        _panel(c, posterior.points[:, :, i].ravel(), box)
        for i, (c, box) in enumerate(zip(posterior.coefficients, boxes, strict=True))
    )
    return Chart("draws of the coefficients", tuple(panels))


def _panel(c: CredibleInterval, draws: Array, box: Region) -> Panel:
    factor, unit = display_unit(c.unit)[0], unit_text(c.unit)
    counts, edges = np.histogram(factor * draws, _BINS)
    share = counts / max(np.max(counts), 1)
    ends = [(factor * x, stroke) for x, stroke in
            ((c.lower, _OWN), (c.upper, _OWN), (c.other_lower, _OTHER), (c.other_upper, _OTHER))]  # fmt: skip
    low, high = (pick([pick(edges), *(x for x, _ in ends)]) for pick in (min, max))
    outline = np.repeat(edges, 2), np.concatenate([[0.0], np.repeat(share, 2), [0.0]])
    marks = [Line(*outline, Stroke(ACCENT, 1.4)),  # px, chosen
             *(Line(np.full(2, x), np.array([0.0, 1.0]), stroke) for x, stroke in ends)]  # fmt: skip
    name = f"{c.name} [{unit}]" if unit else c.name
    return Panel(box, Axis((low, high), tick_count=3), Axis((0.0, _HEADROOM), "", tick_count=2), tuple(marks), name)
