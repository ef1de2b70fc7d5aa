"""Pareto fronts of a tuning: a panel for each pair of objectives, the chosen controller and the baselines marked."""

import re
from dataclasses import replace
from itertools import combinations

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    SECOND,
    WIDTH,
    Array,
    Axis,
    Chart,
    LegendEntry,
    Marker,
    Panel,
    Points,
    Shape,
    span,
    tiles,
)
from seatrial.core.results.tuning import Controller, Tuning
from seatrial.core.text.numbers import raised

# points drawn of a front; panels in a row: two, above which the name of an objective fits
POINTS, COLUMNS = 400, 2
# ratio of largest to smallest from which on an axis of positive numbers is logarithmic
WIDE = 12.0
CHOSEN = Marker(Shape.DIAMOND, 5.4, "#ffffff", SECOND)  # px, chosen
# px, chosen
BASELINES = tuple(Marker(shape, 4.6, INK, "#ffffff") for shape in (Shape.SQUARE, Shape.UP, Shape.DOWN, Shape.RIGHT))
# px, chosen
FRONTS = (
    Marker(Shape.CIRCLE, 1.9, ACCENT, ACCENT, 0.0), Marker(Shape.CROSS, 2.1, "#8e6c1f"),
    Marker(Shape.UP, 2.4, "#2e7d5b"), Marker(Shape.SQUARE, 2.0, "#5b4a7a"),
)  # fmt: skip
_RADIANS = re.compile(r"rad(?:\^(\d+))?")


def degree_unit(unit: str) -> tuple[float, str]:
    """Return factor and unit in degrees of a unit in radians of any power: ``rad^2/s^2`` -> deg²/s²; ``1`` -> none."""
    factor = 1.0
    for power in _RADIANS.findall(unit):
        factor *= (180.0 / np.pi) ** int(power or 1)
    degrees = _RADIANS.sub(lambda m: f"deg^{m[1]}" if m[1] else "deg", unit)
    degrees = re.sub(r"\^(\d+)", lambda m: raised(int(m[1])), degrees)
    return factor, "" if degrees == "1" else degrees


def front_chart(tuning: Tuning) -> Chart | None:
    """Return a panel for each pair of objectives; None with one objective, or without a front."""
    pairs = list(combinations(range(len(tuning.objectives)), 2))
    fronts = [f for f in (tuning.front, *tuning.extended_fronts) if len(f.objectives)]
    if not pairs or not fronts:
        return None
    factors = np.array([degree_unit(unit)[0] for unit in tuning.units])
    styled = [
        (f.objectives[_thinned(len(f.objectives))] * factors, FRONTS[k % len(FRONTS)]) for k, f in enumerate(fronts)
    ]
    controllers = [(c, m) for c, m in _marked_controllers(tuning) if len(c.objectives) == len(factors)]
    styled += [(np.atleast_2d(c.objectives * factors), marker) for c, marker in controllers]
    axes = [scaled_axis([p[:, k] for p, _ in styled], _label(name, unit))
            for k, (name, unit) in enumerate(tuning.objectives.items())]  # fmt: skip
    columns = min(COLUMNS, len(pairs))
    right = 8.0 if columns > 1 else WIDTH - 584.0  # one panel alone is 520 px wide
    # px, chosen
    boxes = tiles(len(pairs), columns, 200.0 if columns > 1 else 300.0, left=44.0, right=right, gap=64.0, top=22.0)
    panels = tuple(
        Panel(box, axes[i], replace(axes[j], name=""), tuple(Points(p[:, i], p[:, j], m) for p, m in styled),
              axes[j].name)
        for box, (i, j) in zip(boxes, pairs, strict=True)
    )  # fmt: skip
    legend = [LegendEntry(f"front, {f.name}", FRONTS[k % len(FRONTS)]) for k, f in enumerate(fronts)]
    legend += [LegendEntry(c.name, marker) for c, marker in reversed(_marked_controllers(tuning))]
    return Chart("front of the objectives", panels, tuple(legend))


def scaled_axis(values: list[Array], name: str) -> Axis:
    """Return an axis about all finite values, logarithmic where they are positive and far apart."""
    finite = np.concatenate([v[np.isfinite(v)] for v in values])
    if finite.size and finite.min() > 0.0 and finite.max() > WIDE * finite.min():
        low, high = span([np.log10(finite)])
        return Axis((10.0**low, 10.0**high), name, is_logarithmic=True)
    return Axis(span([finite]), name)


def _marked_controllers(tuning: Tuning) -> list[tuple[Controller, Marker]]:
    """Baselines first, so that the chosen one lies on top."""
    baselines = [(c, BASELINES[k % len(BASELINES)]) for k, c in enumerate(tuning.compared[1:])]
    return [*baselines, (tuning.chosen, CHOSEN)]


def _thinned(count: int) -> np.ndarray:
    return np.unique(np.linspace(0, count - 1, min(POINTS, count)).astype(int))


def _label(name: str, unit: str) -> str:
    unit_shown = degree_unit(unit)[1]
    return f"{name} [{unit_shown}]" if unit_shown else name
