"""How a coefficient has moved of late, in a few characters."""

import math

import numpy as np

from seatrial.core.values import Array

BARS = "▁▂▃▄▅▆▇█"
NARROWER, WIDER = 0.9, 1.1


def sparkline(values: Array, half_width: float, width: int = 12) -> str:
    """The course of a value as bars, newest last; a move that is small beside its interval looks flat.

    values: (n,) over the last minutes; half_width: half of the interval now, sets the least height shown.
    """
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return ""
    picked = known[np.linspace(0, len(known) - 1, min(width, len(known))).round().astype(int)]
    low, high = float(picked.min()), float(picked.max())
    least = 2.0 * half_width if math.isfinite(half_width) else 0.0
    reach = max(high - low, least)
    if reach <= 0.0:
        return BARS[3] * len(picked)
    bottom = 0.5 * (low + high) - 0.5 * reach
    places = np.clip((picked - bottom) / reach * len(BARS), 0, len(BARS) - 1).astype(int)
    return "".join(BARS[k] for k in places)


def trend_arrow(errors: Array) -> str:
    """Whether the interval became narrower (↘), wider (↗) or stayed (→) over the last minutes.

    errors: (n,) standard errors, newest last.
    """
    known = errors[np.isfinite(errors) & (errors > 0)]
    if len(known) < 2:
        return ""
    ratio = float(known[-1] / known[0])
    return "↘" if ratio < NARROWER else "↗" if ratio > WIDER else "→"
