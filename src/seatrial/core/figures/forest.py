"""Forest plot: estimate, 95 % interval, known value and prior of every free coefficient, relative to the estimate."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.plot import ACCENT, SECOND, WIDTH, Panel, Stroke, axes, drawing, legend, segment, text
from seatrial.core.results import Coefficient

NARROWEST, WIDEST = 1.0, 120.0
ROW = 19.0
_PRIOR, _INTERVAL, _TRUTH = Stroke("#d3dae0", 9.0), Stroke(ACCENT, 2.2), Stroke(SECOND, 1.3)


def forest(coefficients: Sequence[Coefficient]) -> str:
    """One line for each free coefficient, deviations from the estimate in per cent of it; empty where none is free."""
    free = [c for c in coefficients if not c.fixed and c.estimate != 0 and c.lower is not None and c.upper is not None]
    if not free:
        return ""
    reach = _axis_limit(free)
    margin = 8.0 * max(len(c.name) for c in free) + 12
    panel = Panel(
        margin, 26, WIDTH - margin - 14, ROW * len(free), (-reach, reach), (-0.5, len(free) - 0.5), is_y_down=True
    )
    name = "deviation from the estimate, per cent of the estimate"
    parts = [axes(panel, x_ticks=8, y_ticks=1, y_labels=False, x_label=name), _legend(free)]
    parts.append(
        segment(float(panel.px(0)), panel.top, float(panel.px(0)), panel.top + panel.height, Stroke("#999", 0.9))
    )
    for k, c in enumerate(free):
        parts.append(text(margin - 8, float(panel.py(k)) + 4, c.name, anchor="end"))
        parts += _line(panel, c, k, reach)
    return drawing(parts, panel.top + panel.height + 36, "forest plot of the free coefficients")


def _axis_limit(free: Sequence[Coefficient]) -> float:
    ends = [abs(_deviation(c, x)) for c in free for x in (c.lower, c.upper, c.truth) if x is not None]
    return float(np.clip(1.12 * max(ends), NARROWEST, WIDEST))


def _deviation(c: Coefficient, value: float) -> float:
    return 100.0 * (value - c.estimate) / abs(c.estimate)


def _line(panel: Panel, c: Coefficient, row: int, reach: float) -> list[str]:
    assert c.lower is not None and c.upper is not None
    y = float(panel.py(row))
    ends = [_deviation(c, c.lower), _deviation(c, c.upper)]
    inside = [float(x) for x in panel.px(np.clip(ends, -reach, reach))]
    parts = []
    if c.prior_mean is not None and c.prior_standard_deviation is not None:
        spread = 1.96 * c.prior_standard_deviation
        prior = np.clip([_deviation(c, c.prior_mean - spread), _deviation(c, c.prior_mean + spread)], -reach, reach)
        a, b = (float(x) for x in panel.px(prior))
        parts.append(segment(a, y, max(b, a + 1.5), y, _PRIOR))
    parts.append(segment(inside[0], y, inside[1], y, _INTERVAL))
    for end, place, side in ((ends[0], inside[0], -1), (ends[1], inside[1], 1)):
        if abs(end) > reach:
            parts.append(text(place + 5 * side, y + 4, "‹" if side < 0 else "›", anchor="middle", colour=ACCENT))
    parts.append(f'<circle cx="{float(panel.px(0)):.1f}" cy="{y:.1f}" r="3.4" fill="{ACCENT}"/>')
    if c.truth is not None and abs(_deviation(c, c.truth)) <= reach:
        parts.append(_diamond(float(panel.px(_deviation(c, c.truth))), y))
    return parts


def _diamond(x: float, y: float) -> str:
    return (
        f'<path d="M{x - 4.6:.1f} {y:.1f}L{x:.1f} {y - 4.6:.1f}L{x + 4.6:.1f} {y:.1f}L{x:.1f} {y + 4.6:.1f}Z" '
        f'fill="#fff" fill-opacity=".85" stroke="{SECOND}" stroke-width="1.4"/>'
    )


def _legend(free: Sequence[Coefficient]) -> str:
    entries = [("estimate, 95 % interval", _INTERVAL)]
    if any(c.prior_mean is not None for c in free):
        entries.append(("prior, 95 %", _PRIOR))
    known = any(c.truth is not None for c in free)
    if known:
        entries.append(("known value", Stroke("none", 0)))
    sample = _diamond(WIDTH - 14 - 6.2 * len("known value") - 21, 10) if known else ""
    return legend(entries, WIDTH - 14, 14) + sample
