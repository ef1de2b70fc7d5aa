"""Pareto fronts: a panel for each pair of objectives, the chosen controller and its rivals marked."""

import math
import re
import textwrap
from itertools import combinations

import numpy as np

from seatrial.core.figures.plot import ACCENT, INK, SECOND, WIDTH, Panel, clipped, drawing, text
from seatrial.core.figures.scales import Entry, Mark, Scale, grid, legend, scale_of
from seatrial.core.results.tuning import Controller, ParetoFront, Tuning
from seatrial.core.values import Array

POINTS, COLUMNS, LEFT = 400, 3, 46.0
LETTER, LINE = 5.4, 14.0
CHOSEN = Mark("diamond", 5.4, "#ffffff", SECOND)
BASELINES = tuple(Mark(shape, 4.6, INK, "#ffffff") for shape in ("square", "up", "down", "right"))
FRONTS = (Mark("dot", 1.9, ACCENT), Mark("cross", 2.1, "#8e6c1f"), Mark("up", 2.4, "#2e7d5b"),
          Mark("square", 2.0, "#5b4a7a"))  # fmt: skip
_RADIANS = re.compile(r"rad(?:\^(\d+))?")


def degree_unit(unit: str) -> tuple[float, str]:
    """Factor and unit in degrees of a unit in radians of any power: ``rad^2/s^2`` -> deg²/s²; ``1`` -> nothing."""
    factor = 1.0
    for power in _RADIANS.findall(unit):
        factor *= (180.0 / np.pi) ** int(power or 1)
    shown = _RADIANS.sub(lambda m: f"deg^{m[1]}" if m[1] else "deg", unit)
    shown = re.sub(r"\^(\d+)", lambda m: m[1].translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")), shown)
    return factor, "" if shown == "1" else shown


def marked_controllers(tuning: Tuning) -> list[tuple[Controller, Mark]]:
    """Rivals first, so that the chosen one lies on top."""
    rivals = [(rival, BASELINES[k % len(BASELINES)]) for k, rival in enumerate(tuning.baselines)]
    return [*rivals, (tuning.chosen, CHOSEN)]


def fronts(tuning: Tuning) -> str:
    """All pairs of objectives; empty with one objective, or without a front."""
    pairs = list(combinations(range(len(tuning.objectives)), 2))
    drawn = [f for f in (tuning.front, *tuning.extended_fronts) if len(f.objectives)]
    if not pairs or not drawn:
        return ""
    factors = np.array([degree_unit(unit)[0] for unit in tuning.units])
    points = [_thinned(front, factors) for front in drawn]
    marks = [
        (c.objectives * factors, mark) for c, mark in marked_controllers(tuning) if len(c.objectives) == len(factors)
    ]
    scales = [scale_of([*(p[:, k] for p in points), *(m[k : k + 1] for m, _ in marks)]) for k in range(len(factors))]
    head, top = legend(_entries(tuning, drawn))
    columns = min(COLUMNS, len(pairs))
    width, height = (WIDTH / 3 - LEFT - 14, 200.0) if columns > 1 else (520.0, 300.0)
    names = [textwrap.wrap(_label(name, unit), int(width / LETTER), break_long_words=False) or [""]
             for name, unit in zip(tuning.objectives, tuning.units, strict=True)]  # fmt: skip
    room = LINE * max(len(lines) for lines in names)
    step = height + 2.0 * room + 34.0
    parts = [head]
    for k, (i, j) in enumerate(pairs):
        place = (LEFT + (LEFT + width + 14) * (k % columns), top + 10 + room + step * (k // columns))
        panel = Panel(*place, width, height, scales[i].ends, scales[j].ends)
        parts.append(grid(panel, scales[i], scales[j], tick_counts=(4, 5)) + _axis_names(panel, names[i], names[j]))
        parts.append(clipped(panel, _points(panel, (scales[i], scales[j]), (i, j), points, marks)))
    return drawing(parts, top + step * math.ceil(len(pairs) / columns), "front of the objectives")


def _axis_names(panel: Panel, x: list[str], y: list[str]) -> str:
    """Names of the axes, line by line: that of y above the panel, that of x below it."""
    above, below = panel.top - 8 - LINE * (len(y) - 1), panel.top + panel.height + 29
    right = panel.left_edge + panel.width
    parts = [text(panel.left_edge - 26, above + LINE * n, line) for n, line in enumerate(y)]
    return "".join(parts + [text(right, below + LINE * n, line, anchor="end") for n, line in enumerate(x)])


def _points(panel: Panel, scales: tuple[Scale, Scale], pair: tuple[int, int], points: list[Array],
            marks: list[tuple[Array, Mark]]) -> str:  # fmt: skip
    """Fronts, then marks, of one pair of objectives."""
    (x, y), (i, j) = scales, pair
    made = [
        FRONTS[k % len(FRONTS)].svg(panel.px(x.coordinates(p[:, i])), panel.py(y.coordinates(p[:, j])))
        for k, p in enumerate(points)
    ]
    made += [
        mark.svg(panel.px(x.coordinates(at[i : i + 1])), panel.py(y.coordinates(at[j : j + 1]))) for at, mark in marks
    ]
    return "".join(made)


def _thinned(front: ParetoFront, factors: Array) -> Array:
    kept = np.unique(np.linspace(0, len(front.objectives) - 1, min(POINTS, len(front.objectives))).astype(int))
    return front.objectives[kept] * factors


def _label(name: str, unit: str) -> str:
    shown = degree_unit(unit)[1]
    return f"{name} [{shown}]" if shown else name


def _entries(tuning: Tuning, plotted_fronts: list[ParetoFront]) -> list[Entry]:
    own: list[Entry] = [(f"front, {f.name}", FRONTS[k % len(FRONTS)]) for k, f in enumerate(plotted_fronts)]
    *rivals, chosen = marked_controllers(tuning)
    return own + [(c.name, mark) for c, mark in (chosen, *rivals)]
