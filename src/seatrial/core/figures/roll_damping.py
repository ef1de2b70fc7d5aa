"""Damping and period of roll over the amplitude of a swing: the model with its band, each recorded swing as a dot."""

import numpy as np

from seatrial.core.figures.bands import over_time
from seatrial.core.figures.plot import ACCENT, INK, WIDTH, Panel, Stroke, axes, clipped, drawing, legend, span, text
from seatrial.core.results import RollCharacteristics
from seatrial.core.values import Array

_HEIGHT, _LEFT, _GAP, _TOP = 250.0, 56.0, 92.0, 30.0
_MODEL = Stroke(INK, 1.5)
_WIDEST = 1.5


def roll_damping(roll: RollCharacteristics) -> str:
    """Two panels side by side; empty where no amplitude is known."""
    if not roll.amplitude:
        return ""
    seen = np.array(roll.swings).reshape(-1, 3)
    width = (WIDTH - _LEFT - _GAP - 4.0) / 2.0
    damping = _panel(roll, seen[:, [0, 1]], (roll.damping, roll.damping_lower, roll.damping_upper), _LEFT, width,
                     "equivalent damping b_e, 1/s")  # fmt: skip
    period = _panel(roll, seen[:, [0, 2]], (roll.period, roll.period_lower, roll.period_upper),
                    _LEFT + width + _GAP, width, "period of a swing, s")  # fmt: skip
    said = [legend([("model with 95 % band", _MODEL)], WIDTH - (190 if len(seen) else 0), 14)]
    if len(seen):
        said += [_dot(WIDTH - 150, 10), text(WIDTH - 140, 14, "one recorded swing")]
    return drawing([damping, period, *said], _TOP + _HEIGHT + 44, "Damping and period of roll")


def _panel(
    roll: RollCharacteristics,
    dots: Array,
    lines: tuple[tuple[float, ...], ...],
    left_edge: float,
    width: float,
    label: str,
) -> str:
    amplitude = np.degrees(np.array(roll.amplitude))
    middle, low, high = (np.array(line) for line in lines)
    reach = _WIDEST * max(float(np.ptp(np.concatenate([middle, dots[:, 1]]))), 1e-6)
    shown = [middle, dots[:, 1], np.maximum(low, middle.min() - reach), np.minimum(high, middle.max() + reach)]
    panel = Panel(left_edge, _TOP, width, _HEIGHT, (0.0, float(amplitude[-1]) * 1.03), span(shown))
    x, y = panel.px(np.degrees(dots[:, 0])), panel.py(dots[:, 1])
    marks = "".join(_dot(float(a), float(b)) for a, b in zip(x, y, strict=True))
    return "".join([
        axes(panel, x_label="amplitude of the swing, deg", y_label=label),
        over_time(panel, amplitude, (low, high)), clipped(panel, marks),
        clipped(panel, panel.curve(amplitude, middle, _MODEL)),
    ])  # fmt: skip


def _dot(x: float, y: float) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.8" fill="{ACCENT}" fill-opacity=".7"/>'
