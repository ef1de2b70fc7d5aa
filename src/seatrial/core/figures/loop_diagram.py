"""The loop as a block diagram: sensors, parallel terms, filters, servo, plant; the disturbance from above."""

import textwrap
from collections.abc import Sequence

from seatrial.core.figures.plot import ACCENT, AXIS, INK, WIDTH, Stroke, drawing, label, segment, text
from seatrial.core.results.tuning import Component

HEIGHT, ROW, RADIUS = 42.0, 54.0, 8.0
# room that the block of the disturbance and its arrow take above the middle
ABOVE = ROW + HEIGHT + 18.0
WIDEST, GAP = 116.0, 22.0
WIRE = Stroke(INK, 1.1)
_PALE = "#eef3f7"


ROLES = ("sensor", "term", "filter", "servo", "plant", "disturbance")


def signal_order(components: Sequence[Component]) -> list[Component]:
    """As a signal passes them; roles that are not known last."""
    return sorted(components, key=lambda c: ROLES.index(c.role) if c.role in ROLES else len(ROLES))


def diagram(components: Sequence[Component], output: str, actuator: str) -> str:
    """Negative feedback from left to right; empty without blocks."""
    if not components:
        return ""
    of = {role: [c for c in components if c.role == role] for role in ROLES}
    columns = [[c] for c in of["sensor"]] + ([of["term"]] if of["term"] else [])
    columns += [[c] for role in ("filter", "servo", "plant") for c in of[role]]
    tallest = max(len(column) for column in columns) if columns else 1
    sums = 1 + (len(of["term"]) > 1) + bool(of["disturbance"])
    room = WIDTH - 92 - sums * (2 * RADIUS + GAP)
    width = min(WIDEST, room / max(1, len(columns)) - GAP)
    middle = 6.0 + max(0.5 * (ROW * (tallest - 1) + HEIGHT), ABOVE if of["disturbance"] else 0.0)
    parts, x = [_sum(26.0, middle, "−"), _arrow(0.0, 18.0, middle)], 26.0 + RADIUS
    for column in columns:
        if column[0].role == "plant":
            parts.append(text(x + GAP / 2, middle - 6, _symbol(actuator), anchor="middle", size=10.5))
        parts += _parallel(column, x, middle, width)
        x += GAP + width
        if len(column) > 1:
            x += GAP
            parts.append(_sum(x + RADIUS, middle, "", is_added=True))
            x += 2 * RADIUS
    if of["disturbance"]:
        parts += _disturbance_path(of["disturbance"][0], x + GAP + RADIUS, x, middle, width)
        x += GAP + 2 * RADIUS
    end, low = x + 40.0, middle + 0.5 * ROW * tallest + 22
    parts += [_arrow(x, end, middle), text(end + 4, middle + 4, _symbol(output))]
    back = (x + end) / 2
    parts += [segment(back, middle, back, low, WIRE), segment(26.0, low, back, low, WIRE), _upwards(26.0, low, middle)]
    return drawing(parts, low + 12, "block diagram of the loop", end + 26)


def _symbol(name: str) -> str:
    return label(name, "1")


def _parallel(column: Sequence[Component], x: float, middle: float, width: float) -> list[str]:
    """Blocks above one another between a fork and what follows."""
    parts = []
    for k, c in enumerate(column):
        y = middle + ROW * (k - 0.5 * (len(column) - 1))
        left = x + GAP
        if len(column) > 1:
            parts.append(segment(x + 6, middle, x + 6, y, WIRE))
            parts.append(_arrow(x + 6, left, y))
            join = left + width + GAP + RADIUS
            if abs(y - middle) < 1.0:
                parts.append(_arrow(left + width, join - RADIUS, y))
            else:
                parts.append(segment(left + width, y, join, y, WIRE))
                parts.append(_arrow_into_sum(join, y, middle))
        else:
            parts.append(_arrow(x, left, y))
        parts.append(_box(left, y, width, c))
    if len(column) > 1:
        parts.append(segment(x, middle, x + 6, middle, WIRE))
    return parts


def _disturbance_path(c: Component, x: float, from_x: float, middle: float, width: float) -> list[str]:
    """The disturbance's block above, its answer added to the plant's."""
    y = middle - ROW - 0.5 * HEIGHT
    left = x - 0.5 * width
    return [
        _arrow(from_x, x - RADIUS, middle),
        _sum(x, middle, "", is_added=True),
        _box(left, y, width, c),
        _downwards(x, y + HEIGHT / 2, middle - RADIUS),
        _downwards(x, y - HEIGHT / 2 - 18, y - HEIGHT / 2),
        text(x + 5, y - HEIGHT / 2 - 9, "disturbance", size=10),
    ]


def _box(left_edge: float, y: float, width: float, c: Component) -> str:
    words = f"{c.gain} · {c.name}" if c.gain else c.name
    lines = textwrap.wrap(words, max(6, int(width / 5.6)))[:3] or [c.role]
    first = y + 3.6 - 6.0 * (len(lines) - 1)
    frame = (
        f'<rect x="{left_edge:.1f}" y="{y - HEIGHT / 2:.1f}" width="{width:.1f}" height="{HEIGHT:.1f}" rx="3" '
        f'fill="{_PALE}" stroke="{ACCENT}" stroke-width="1"/>'
    )
    return frame + "".join(
        text(left_edge + width / 2, first + 12.0 * k, line, anchor="middle", size=10) for k, line in enumerate(lines)
    )


def _sum(x: float, y: float, sign: str, *, is_added: bool = False) -> str:
    circle = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{RADIUS:g}" fill="#fff" stroke="{AXIS}" stroke-width="1.1"/>'
    plus = text(x, y + 4, "+", anchor="middle", size=11) if is_added else ""
    return circle + plus + (text(x - 12, y + 20, sign, anchor="middle", size=13) if sign else "")


def _head(x: float, y: float, dx: float, dy: float) -> str:
    """A filled arrow head whose tip is at the place, pointing along (dx, dy)."""
    a, b = (x - 6 * dx - 3 * dy, y - 6 * dy + 3 * dx), (x - 6 * dx + 3 * dy, y - 6 * dy - 3 * dx)
    return f'<path d="M{x:.1f} {y:.1f}L{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}Z" fill="{INK}"/>'


def _arrow(x1: float, x2: float, y: float) -> str:
    return segment(x1, y, x2 - 5, y, WIRE) + _head(x2, y, 1.0, 0.0)


def _downwards(x: float, y1: float, y2: float) -> str:
    return segment(x, y1, x, y2 - 5, WIRE) + _head(x, y2, 0.0, 1.0)


def _upwards(x: float, y1: float, middle: float) -> str:
    y2 = middle + RADIUS
    return segment(x, y1, x, y2 + 5, WIRE) + _head(x, y2, 0.0, -1.0)


def _arrow_into_sum(x: float, y: float, middle: float) -> str:
    """From a row above or below into the sum."""
    return _downwards(x, y, middle - RADIUS) if y < middle else _upwards(x, y, middle)
