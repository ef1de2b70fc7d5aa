"""What a loop is tuned for: variances of what it does in a sea, and what crews make of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cache

import numpy as np
from scipy.special import ndtr

from seatrial.core.values import Array
from seatrial.physics.hydro.dispersion import G


class LoopSignal(Enum):
    """Where a variance is taken."""

    OUTPUT = "output"
    ACTUATOR = "actuator"


@dataclass(frozen=True)
class WeightedVariance:
    """The variance of an operator on the output or the actuator: `magnitude` is |W(j omega)| at omega [rad/s]."""

    signal: LoopSignal
    magnitude: Callable[[Array], Array]


@dataclass(frozen=True)
class Objective:
    """A number to be made small, of one or more variances.

    Attributes:
        variances: the variances it is made of, r.
        value: variances (n, r) -> (n,); gradient: variances (n, r) -> derivatives (n, r).
    """

    name: str
    unit: str
    variances: tuple[WeightedVariance, ...]
    value: Callable[[Array], Array]
    gradient: Callable[[Array], Array]


@cache
def _frequency_power(n: int) -> Callable[[Array], Array]:
    return lambda omega: omega**n


def _first_variance(variances: Array) -> Array:
    return variances[:, 0]


def variance(name: str, unit: str, signal: LoopSignal, power: int = 0) -> Objective:
    """Return the variance of the output or the actuator (power 0), of its rate (1), of its acceleration (2)."""
    return Objective(name, unit, (WeightedVariance(signal, _frequency_power(power)),), _first_variance, np.ones_like)


def squared_deviation(name: str, signal: LoopSignal, target: float, *, one_sided: bool) -> Objective:
    """(variance - target)^2 [unit^4] (Yu et al. 2014, eq. (2)); one-sided: only what exceeds the target counts."""

    def miss(variances: Array) -> Array:
        off = variances - target
        return np.maximum(off, 0.0) if one_sided else off

    row = WeightedVariance(signal, _frequency_power(0))
    return Objective(name, "", (row,), lambda v: miss(v)[:, 0] ** 2, lambda v: 2.0 * miss(v))


def motion_interruptions(height: float, friction: float = 0.25) -> Objective:
    """Tips a minute of a person standing `height` [m] above the axis of roll (Graham 1990, Nav. Eng. J. 102(2), 65-71).

    The lateral force estimator of roll alone is (g + height omega^2) phi; it exceeds `friction` g, the half stance over
    the height of the centre of gravity, on either side at the rate of Rice (1945) for a Gaussian process:
    60 / pi sqrt(v_2 / v_0) exp(-(friction g)^2 / (2 v_0)).
    """

    def lateral(omega: Array) -> Array:
        return G + height * omega**2

    def value(v: Array) -> Array:
        with np.errstate(invalid="ignore"):
            # 60 s a minute
            # crossings a minute of a narrow band, Rice 1945
            made = 60.0 / math.pi * np.sqrt(v[:, 1] / v[:, 0]) * np.exp(-((friction * G) ** 2) / (2.0 * v[:, 0]))
        return np.where(np.isfinite(v[:, 0]), made, np.inf)

    def slope(v: Array) -> Array:
        rate = value(v)
        by_first = rate * ((friction * G) ** 2 / (2.0 * v[:, 0] ** 2) - 0.5 / v[:, 0])
        return np.stack([by_first, 0.5 * rate / v[:, 1]], axis=1)

    rows = (WeightedVariance(LoopSignal.OUTPUT, lateral), WeightedVariance(LoopSignal.OUTPUT, lambda w: w * lateral(w)))
    return Objective("motion interruptions", "1/min", rows, value, slope)


def motion_sickness(lever: float) -> Objective:
    """Share of people sick within two hours, `lever` [m] off the axis; O'Hanlon & McCauley 1974 as in `sea.response`.

    The vertical acceleration of the output alone, lever omega^2 phi. Phi((log10(0.798 sqrt(v_4) / g) - mu) / 0.4),
    mu = -0.819 + 2.32 log10(omega)^2, omega = sqrt(v_4 / v_2).
    """

    def score(v: Array) -> tuple[Array, Array]:
        ratio = 0.5 * np.log10(v[:, 1] / v[:, 0])
        return (np.log10(0.798 * np.sqrt(v[:, 1]) / G) + 0.819 - 2.32 * ratio**2) / 0.4, ratio  # constants as above

    def value(v: Array) -> Array:
        with np.errstate(invalid="ignore"):
            made = ndtr(score(v)[0])
        return np.where(np.isfinite(v[:, 0]), made, np.inf)

    def slope(v: Array) -> Array:
        z, ratio = score(v)
        density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi) / 0.4  # normal density; 0.4 as in `sea.response`
        half = 0.5 / math.log(10.0)
        by_first = density * 2.32 * 2.0 * ratio * half / v[:, 0]  # 2.32 as above
        by_second = density * (1.0 - 2.32 * 2.0 * ratio) * half / v[:, 1]  # 2.32 as above
        return np.stack([by_first, by_second], axis=1)

    rows = (
        WeightedVariance(LoopSignal.OUTPUT, lambda w: abs(lever) * w),
        WeightedVariance(LoopSignal.OUTPUT, lambda w: abs(lever) * w**2),
    )
    return Objective("motion sickness", "1", rows, value, slope)
