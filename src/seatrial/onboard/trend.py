"""How a coefficient has changed over the last minutes, in a few characters."""

import math

import numpy as np

from seatrial.core.values import Array

BARS = "▁▂▃▄▅▆▇█"
# ratios of intervals that count as narrower and wider
NARROWER, WIDER = 0.9, 1.1


def sparkline(values: Array, half_width: float, width: int = 12) -> str:
    """Return the course of a value as bars, newest last; a change that is small against the interval looks flat.

    values: (n,) over the last minutes; half_width: half of the interval now, sets the least height shown.
    """
    finite = values[np.isfinite(values)]
    if len(finite) < 2:
        return ""
    picked = finite[np.linspace(0, len(finite) - 1, min(width, len(finite))).round().astype(int)]
    low, high = float(picked.min()), float(picked.max())
    least = 2.0 * half_width if math.isfinite(half_width) else 0.0
    reach = max(high - low, least)
    if reach <= 0.0:
        return BARS[3] * len(picked)
    bottom = 0.5 * (low + high) - 0.5 * reach
    levels = np.clip((picked - bottom) / reach * len(BARS), 0, len(BARS) - 1).astype(int)
    return "".join(BARS[k] for k in levels)


def trend_arrow(errors: Array) -> str:
    """Return whether the interval became narrower (↘), wider (↗) or stayed (→) over the last minutes.

    errors: (n,) standard errors, newest last.
    """
    finite = errors[np.isfinite(errors) & (errors > 0)]
    if len(finite) < 2:
        return ""
    ratio = float(finite[-1] / finite[0])
    return "↘" if ratio < NARROWER else "↗" if ratio > WIDER else "→"
