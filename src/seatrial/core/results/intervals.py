"""Intervals of coefficients at other levels than 95 %."""

from seatrial.core.results.coefficients import Coefficient
from seatrial.core.values import InputError

STORED_LEVEL = 0.95
"""Probability of the interval that a coefficient carries, 1."""


def at_level(coefficient: Coefficient, level: float, degrees_of_freedom: float) -> tuple[float, float]:
    """Return the ends of a coefficient's interval at a probability; NaN where an end is not known.

    Each side of the 95 % interval is scaled by the ratio of the two-sided quantiles of Student's t.

    Raises:
        InputError: `level` is not between 0 and 1.
    """
    if not 0.0 < level < 1.0:
        raise InputError(f"the level {level:g} of an interval is not between 0 and 1; give a probability such as 0.95")
    value = coefficient.estimate
    lower, upper = (float("nan") if end is None else end for end in (coefficient.lower, coefficient.upper))
    if level == STORED_LEVEL:
        return lower, upper
    factor = _two_sided_quantile(level, degrees_of_freedom) / _two_sided_quantile(STORED_LEVEL, degrees_of_freedom)
    return value - factor * (value - lower), value + factor * (upper - value)


def _two_sided_quantile(level: float, degrees_of_freedom: float) -> float:
    from scipy.special import ndtri, stdtrit  # here, as `check` imports this module and has no use for them

    probability = 0.5 * (1.0 + level)
    return float(ndtri(probability) if degrees_of_freedom == float("inf") else stdtrit(degrees_of_freedom, probability))
