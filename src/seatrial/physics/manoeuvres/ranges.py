"""Values that a measure can take, and intervals that stay among them."""

import math
from collections.abc import Callable
from dataclasses import dataclass

UNDETERMINED_FACTOR = 5.0
"""An interval from a fifth to five times the value says nothing: the measure is not determined; chosen."""
LARGEST_DRIFT = 90.0  # deg; beyond it the craft goes astern, which no steady turn ahead does


@dataclass(frozen=True)
class _Scale:
    """A scale on which a measure has no limits: `to` it, `back` from it, and its `slope` d(scale)/d(measure)."""

    to: Callable[[float], float]
    back: Callable[[float], float]
    slope: Callable[[float], float]


_LOGARITHM = _Scale(math.log, math.exp, lambda value: 1.0 / value)  # of what is positive
_RETAINED_SHARE = _Scale(  # of a share lost, which is below one: the logarithm of the share that is left
    lambda value: math.log1p(-value), lambda scaled: -math.expm1(scaled), lambda value: 1.0 / (1.0 - value)
)
_DRIFT = _Scale(  # of an angle between -90 and 90 deg
    lambda value: math.atanh(value / LARGEST_DRIFT),
    lambda scaled: LARGEST_DRIFT * math.tanh(scaled),
    lambda value: LARGEST_DRIFT / (LARGEST_DRIFT**2 - value**2),
)


def bounded_interval(name: str, value: float, half_width: float) -> tuple[float, float] | None:
    """Return the interval of a measure within the values it can take, by the delta method on a scale without limits.

    Lengths, times, speeds and rudder angles are positive, as are overshoots and steady yaw rates; a share lost is below
    one, a drift angle within 90 deg. What is narrow stays symmetric about its value.

    Args:
        half_width: of the symmetric interval, in the unit of the measure.

    Returns:
        None where the measure is not determined: the interval would reach a fifth or five times the value, or all
        drift angles; or the value itself is none that the measure can take.
    """
    scale = _scale_of(name)
    if scale is None:
        return value - half_width, value + half_width
    try:
        centre, half = scale.to(value), half_width * scale.slope(value)
    except (ValueError, ZeroDivisionError):
        return None
    if not half <= math.log(UNDETERMINED_FACTOR):
        return None
    ends = (scale.back(centre - half), scale.back(centre + half))
    return min(ends), max(ends)


def _scale_of(name: str) -> _Scale | None:
    """None: the measure has no limits (transfer, residual yaw rate)."""
    if name == "speed_loss":
        return _RETAINED_SHARE
    if name == "steady_drift_deg":
        return _DRIFT
    if name in _UNLIMITED:
        return None
    return _LOGARITHM


_UNLIMITED = frozenset({"transfer_L", "residual_yaw_rate_deg_s"})
