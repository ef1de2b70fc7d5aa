"""A gain schedule as maps: heading by speed for each wave height, beside other gains; red where little is gained."""

import math
from collections.abc import Sequence

from seatrial.core.figures.matrix import colour
from seatrial.core.figures.plot import INK, WIDTH, Stroke, drawing, rectangle, segment, text
from seatrial.core.results.tuning import OperatingPoint
from seatrial.core.text.numbers import exact

LEFT, TOP, KEY = 66.0, 24.0, 64.0
WIDEST, LOWEST, HIGHEST = 54.0, 22.0, 34.0
THIS_SCHEDULE = "this schedule"


def schedule_maps(operating_points: Sequence[OperatingPoint]) -> str:
    """A row of maps for each height, a column for the schedule and for each of the others; empty without slots."""
    if not operating_points:
        return ""
    names = [THIS_SCHEDULE, *operating_points[0].baseline_costs]
    heights, headings = sorted({s.height for s in operating_points}), sorted({s.beta for s in operating_points})
    speeds = sorted({s.U for s in operating_points}, reverse=True)
    room = (WIDTH - LEFT - KEY) / len(names) - 14
    wide = min(WIDEST, room / len(headings))
    high = min(HIGHEST, max(LOWEST, 0.62 * wide))
    parts, top = [], TOP + 16
    for height in heights:
        at = {(s.U, s.beta): s for s in operating_points if s.height == height}
        for k, name in enumerate(names):
            left = LEFT + k * (wide * len(headings) + 14)
            if height == heights[0]:
                parts.append(text(left, 14, name, size=11))
            parts += _map(at, name, speeds, headings, (left, top, wide, high))
        parts.append(text(LEFT - 4, top - 6, f"{exact(height, 3)} m", anchor="end", size=11))
        parts += [text(LEFT - 6, top + high * (i + 0.5) + 4, exact(U, 3), anchor="end", size=10)
                  for i, U in enumerate(speeds)]  # fmt: skip
        top += high * len(speeds) + (34 if height == heights[-1] else 26)
    for k in range(len(names)):
        left = LEFT + k * (wide * len(headings) + 14)
        parts += [text(left + wide * (j + 0.5), top - 20, exact(math.degrees(beta), 3), anchor="middle", size=10)
                  for j, beta in enumerate(headings)]  # fmt: skip
    parts.append(text(LEFT, top - 2, "heading to the waves [deg], 0 following; upwards: speed [m/s]", size=10.5))
    parts.append(_key(LEFT + len(names) * (wide * len(headings) + 14) + 4, TOP + 16))
    return drawing(parts, max(top + 8, TOP + 110), "costs of the schedule")


def _map(
    points_by_condition: dict[tuple[float, float], OperatingPoint],
    name: str,
    speeds: list[float],
    headings: list[float],
    box: tuple[float, float, float, float],
) -> list[str]:
    left, top, wide, high = box
    parts = []
    for i, U in enumerate(speeds):
        for j, beta in enumerate(headings):
            slot = points_by_condition.get((U, beta))
            x, y = left + wide * j, top + high * i
            cost = (
                math.nan
                if slot is None
                else slot.cost
                if name == THIS_SCHEDULE
                else slot.baseline_costs.get(name, math.nan)
            )
            fill, strength = colour(cost, 1.0)
            parts.append(rectangle(x, y, wide - 1.5, high - 1.5, fill))
            if slot is None:
                continue
            words = f"{cost:.2f}".lstrip("0") if math.isfinite(cost) else "unst." if math.isinf(cost) else "–"
            parts.append(text(x + wide / 2 - 1, y + high / 2 + 3.5, words, anchor="middle", size=10.5,
                              colour="#fff" if strength > 0.55 else INK))  # fmt: skip
            if name == THIS_SCHEDULE and not slot.is_feasible:
                parts.append(segment(x + 1, y + high - 4, x + wide - 3, y + high - 4, Stroke(INK, 1.6)))
    return parts


def _key(left_edge: float, top: float) -> str:
    parts = []
    for k, share in enumerate((1.0, 0.75, 0.5, 0.25, 0.0)):
        parts.append(rectangle(left_edge, top + 14 * k, 13, 13, colour(share, 1.0)[0]))
        parts.append(text(left_edge + 18, top + 14 * k + 10, exact(share, 2), size=10))
    return "".join(parts)
