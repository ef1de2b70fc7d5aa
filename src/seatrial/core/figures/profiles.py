"""Profile likelihoods: what the records lose when one coefficient is held at another value."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.figures.plot import ACCENT, SECOND, WIDTH, Panel, Stroke, axes, drawing, segment, text
from seatrial.core.results import Profile
from seatrial.core.text.words import unit_text as unit_of_people
from seatrial.core.values import display_unit

COLUMNS, HEIGHT, GAP, LEFT = 3, 120.0, 46.0, 48.0
BOUND, HIGHEST = 3.84, 12.0


def profiles(items: Sequence[Profile], units: Mapping[str, str]) -> str:
    """A panel for each coefficient, its bound of 95 % as a line; empty for none. `units`: parameter -> SI unit."""
    usable = [p for p in items if len(p.values) > 1 and min(p.values) < max(p.values)]
    tile = WIDTH / COLUMNS
    parts = []
    for k, profile in enumerate(usable):
        left, top = LEFT + tile * (k % COLUMNS), 20 + (HEIGHT + GAP) * (k // COLUMNS)
        parts.append(_panel(profile, units.get(profile.parameter, "1"), (left, top, tile - LEFT - 16, HEIGHT)))
    height = (HEIGHT + GAP) * math.ceil(len(usable) / COLUMNS)
    return drawing(parts, height, "profile likelihoods") if parts else ""


def _panel(profile: Profile, unit: str, box: tuple[float, float, float, float]) -> str:
    values = np.array(profile.values) * display_unit(unit)[0]
    costs = np.array(profile.costs)
    order = np.argsort(values)
    shown = unit_of_people(unit)
    highest = float(np.clip(1.05 * np.nanmax(costs), 1.3 * BOUND, HIGHEST))
    panel = Panel(*box, (float(values.min()), float(values.max())), (0.0, highest))
    name = f"{profile.parameter} [{shown}]" if shown else profile.parameter
    inside = np.where(costs <= highest, costs, np.nan)
    limit = float(panel.py(BOUND))
    ends = [end * display_unit(unit)[0] for end in (profile.lower, profile.upper) if end is not None]
    return "".join([
        axes(panel, x_ticks=3, y_ticks=3, title=name, y_label="χ² lost"),
        segment(panel.left_edge, limit, panel.left_edge + panel.width, limit, Stroke(SECOND, 1.0, "4 2.5")),
        text(panel.left_edge + panel.width - 2, limit - 4, "95 %", anchor="end", size=9.5, colour=SECOND),
        panel.curve(values[order], inside[order], Stroke(ACCENT, 1.6)),
        *(segment(float(panel.px(x)), limit, float(panel.px(x)), panel.top + HEIGHT, Stroke(SECOND, 0.8))
          for x in ends),
    ])  # fmt: skip
