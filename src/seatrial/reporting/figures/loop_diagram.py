"""The loop as a block diagram: sensors, parallel terms, filters, servo, plant; the disturbance from above."""

import textwrap
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import (
    ACCENT,
    INK,
    WIDTH,
    Anchor,
    Area,
    Axis,
    Chart,
    Line,
    Mark,
    Marker,
    Panel,
    Points,
    Rectangle,
    Region,
    Shape,
    Stroke,
    Text,
)
from seatrial.core.results.tuning import Component
from seatrial.core.values.notation import channel_letter

# height of a block, distance of parallel ones, radius of a sum [px]
HEIGHT, ROW, RADIUS = 42.0, 54.0, 8.0
# width of the widest block, and of the gap before each [px]
WIDEST, GAP = 116.0, 22.0
# width of a letter in a block [px]
LETTER = 5.6
# height that the block of the disturbance and its arrow take above the middle [px]
ABOVE = ROW + HEIGHT + 18.0
ROLES = ("sensor", "term", "filter", "servo", "plant", "disturbance")
_WIRE, _EDGE, _PALE = Stroke(INK, 1.1), Stroke(ACCENT, 1.0), "#eef3f7"  # px, chosen
_SUM = Marker(Shape.CIRCLE, RADIUS, "#8a9299", "#ffffff", 1.1)  # px, chosen


def signal_order(components: Sequence[Component]) -> list[Component]:
    """Return components in the order in which a signal passes them; unknown roles last."""
    return sorted(components, key=lambda c: ROLES.index(c.role) if c.role in ROLES else len(ROLES))


def loop_diagram(components: Sequence[Component], output: str, actuator: str) -> Chart | None:
    """Return negative feedback from left to right; None without components. Data coordinates are px, y down."""
    if not components:
        return None
    by_role = {role: [c for c in components if c.role == role] for role in ROLES}
    terms, disturbance = by_role["term"], by_role["disturbance"]
    columns = [[c] for c in by_role["sensor"]] + ([terms] if terms else [])
    columns += [[c] for role in ("filter", "servo", "plant") for c in by_role[role]]
    tallest = max((len(column) for column in columns), default=1)
    sums = 1 + (len(terms) > 1) + bool(disturbance)
    width = min(WIDEST, (WIDTH - 92.0 - sums * (2 * RADIUS + GAP)) / max(1, len(columns)) - GAP)  # px, chosen
    middle = 6.0 + max(0.5 * (ROW * (tallest - 1) + HEIGHT), ABOVE if disturbance else 0.0)  # px, chosen
    marks, x = [*_arrow((0.0, middle), (18.0, middle)), *_sum(26.0, middle, "−")], 26.0 + RADIUS  # px, chosen
    for column in columns:
        if column[0].role == "plant":
            marks.append(Text(x + GAP / 2, middle - 6, channel_letter(actuator), Anchor.MIDDLE, 10.5))  # px, chosen
        marks += _parallel(column, x, middle, width)
        x += GAP + width
        if len(column) > 1:
            marks += _sum(x + GAP + RADIUS, middle)
            x += GAP + 2 * RADIUS
    if disturbance:
        marks += _disturbance(disturbance[0], x + GAP + RADIUS, x, middle, width)
        x += GAP + 2 * RADIUS
    end, low = x + 40.0, middle + 0.5 * ROW * tallest + 22.0  # px, chosen
    back = (x + end) / 2
    marks += [
        *_arrow((x, middle), (end, middle)),
        Text(end + 4, middle + 4, channel_letter(output)),
        _wire((back, middle), (back, low), (26.0, low)),  # px, chosen
        *_arrow((26.0, low), (26.0, middle + RADIUS)),  # px, chosen
    ]
    page = Region(0.0, 0.0, end + 26.0, low + 8.0)  # px, chosen
    panel = Panel(
        page, Axis((0.0, page.width)), Axis((0.0, page.height)), tuple(marks), is_y_down=True, has_frame=False
    )
    return Chart("block diagram of the loop", (panel,), width=page.width)


def _parallel(column: Sequence[Component], x: float, middle: float, width: float) -> list[Mark]:
    """Blocks above one another between a fork and a sum; one alone between two wires."""
    left, marks = x + GAP, list[Mark]()
    if len(column) == 1:
        return [*_arrow((x, middle), (left, middle)), *_block(left, middle, width, column[0])]
    fork, join = x + 6.0, left + width + GAP + RADIUS  # px, chosen
    for k, c in enumerate(column):
        y = middle + ROW * (k - 0.5 * (len(column) - 1))
        marks += [
            _wire((x, middle), (fork, middle), (fork, y)),
            *_arrow((fork, y), (left, y)),
            *_block(left, y, width, c),
        ]
        if abs(y - middle) < 1.0:
            marks += _arrow((left + width, y), (join - RADIUS, y))
        else:
            marks.append(_wire((left + width, y), (join, y)))
            marks += _arrow((join, y), (join, middle - RADIUS if y < middle else middle + RADIUS))
    return marks


def _disturbance(c: Component, x: float, from_x: float, middle: float, width: float) -> list[Mark]:
    """The disturbance's block above, its response added to the plant's."""
    y = middle - ROW - 0.5 * HEIGHT
    top = y - HEIGHT / 2
    return [
        *_arrow((from_x, middle), (x - RADIUS, middle)), *_sum(x, middle), *_block(x - 0.5 * width, y, width, c),
        *_arrow((x, y + HEIGHT / 2), (x, middle - RADIUS)), *_arrow((x, top - 18.0), (x, top)),  # px, chosen
        Text(x + 5, top - 9.0, "disturbance", size=10.0),  # px, chosen
    ]  # fmt: skip


def _block(left: float, y: float, width: float, c: Component) -> list[Mark]:
    words = f"{c.gain} · {c.name}" if c.gain else c.name
    lines = textwrap.wrap(words, max(6, int(width / LETTER)))[:3] or [c.role]  # px, chosen
    first = y + 3.6 - 6.0 * (len(lines) - 1)  # px, chosen
    # px, chosen
    return [
        Rectangle(left, y - HEIGHT / 2, left + width, y + HEIGHT / 2, _PALE, edge=_EDGE),
        *(Text(left + width / 2, first + 12.0 * k, line, Anchor.MIDDLE, 10.0) for k, line in enumerate(lines)),
    ]


def _sum(x: float, y: float, sign: str = "+") -> list[Mark]:
    """A sum with its sign: + inside, − below the lower left."""
    inside = sign == "+"
    # px, chosen
    words = Text(x, y + 4, sign, Anchor.MIDDLE) if inside else Text(x - 12, y + 20, sign, Anchor.MIDDLE, 13.0)
    return [Points(np.array([x]), np.array([y]), _SUM), words]


def _wire(*corners: tuple[float, float]) -> Line:
    x, y = np.array(corners).T
    return Line(x, y, _WIRE)


def _arrow(start: tuple[float, float], tip: tuple[float, float]) -> list[Mark]:
    """A wire along x or y with a filled head of 6 by 6 px at its tip."""
    a, b = np.array(start), np.array(tip)
    forward = np.sign(b - a)
    aside = 3.0 * forward[::-1]
    head = np.array([b, b - 6.0 * forward - aside, b - 6.0 * forward + aside])  # px, chosen
    return [_wire(start, tuple(b - 5.0 * forward)), Area(head[:, 0], head[:, 1], INK)]  # px, chosen
