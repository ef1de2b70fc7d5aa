"""What runs left out missed beyond the scatter that was foreseen: the model's own error, from cross-validation.

Every training run is predicted by the model without it. Where its error exceeds what coefficients, offsets and process
noise explain, the excess variance is the model discrepancy (Kennedy & O'Hagan 2001, J. R. Stat. Soc. B 63, 425), here
estimated for every kind of measure and for heading and position by the time since the initial state. It grows with the
extrapolation index squared: the first terms an odd polynomial leaves out are two orders above its last ones, and so it
is when runs of large rudder angles are predicted from those of small ones (benchmarks/extrapolation.py).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.values import Array

_FEWEST_VALUES, _FEWEST_RUNS = 4, 3

BAND_CHANNELS = ("psi", "x0", "y0", "phi", "z", "theta")
"""Channels of a prediction that have a band: where a craft is and how it lies, not how fast it moves."""

GROWTH_POWER = 2.0
"""Power of the extrapolation index with which the discrepancy grows (benchmarks/extrapolation.py)."""


@dataclass(frozen=True, eq=False)
class HoldoutError:
    """How one run left out was missed.

    Attributes:
        run: its name; dt: s.
        errors, predicted_sd: channel of `BAND_CHANNELS` -> error and predicted standard deviation at every sample, SI.
        measures: measure -> (error, foreseen standard deviation), in the measure's unit.
        index: extrapolation index of the run against the others.
    """

    run: str
    dt: float
    errors: dict[str, Array]
    predicted_sd: dict[str, Array]
    measures: dict[str, tuple[float, float]] = field(default_factory=dict)
    index: float = 1.0


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """Standard deviations that come on top of the foreseen ones, within the ground the training runs cover.

    Attributes:
        sd_by_kind: kind of measure -> standard deviation in its unit.
        factor: by which the foreseen standard deviation of a measure is multiplied that no training run shows (the
            ratio of Birge 1932, Phys. Rev. 40, 207, over the kinds they show).
        dt: s; sd_by_time: channel -> standard deviation by time since the initial state, shape (n,), SI.
    """

    sd_by_kind: dict[str, float]
    factor: float
    dt: float
    sd_by_time: dict[str, Array]

    def measure_sd(self, name: str, predicted_sd: float, index: float) -> float:
        """Standard deviation of a measure, discrepancy included; `index`: how far the run extrapolates."""
        extra = self.sd_by_kind.get(measure_kind(name))
        return (
            self.factor * predicted_sd
            if extra is None
            else float(np.hypot(predicted_sd, discrepancy_growth(index) * extra))
        )

    def channel_sd(self, channel: str, predicted_sd: Array, dt: float, index: float) -> Array:
        """Standard deviation of a channel along a prediction, shape (n,); constant beyond the longest run left out."""
        if channel not in self.sd_by_time:
            return predicted_sd
        known = self.sd_by_time[channel]
        at = np.interp(dt * np.arange(len(predicted_sd)), self.dt * np.arange(len(known)), known)
        return np.hypot(predicted_sd, discrepancy_growth(index) * at)


NO_DISCREPANCY = Discrepancy({}, 1.0, 1.0, {})


def discrepancy_growth(index: float) -> float:
    """How much larger the discrepancy is of a run that extrapolates: the index squared, never less than one."""
    return max(index, 1.0) ** GROWTH_POWER


def measure_kind(measure: str) -> str:
    """The kind a measure belongs to: its name without numbers, so that all overshoots count together."""
    return "_".join(part for part in measure.split("_") if not part.isdigit())


def discrepancy(holdout_errors: Sequence[HoldoutError], otherwise: Discrepancy = NO_DISCREPANCY) -> Discrepancy:
    """Return what these errors have in excess of what was foreseen; `otherwise`, where they are of too few runs."""
    if len({m.run for m in holdout_errors}) < _FEWEST_RUNS:
        return otherwise
    pairs: dict[str, list[tuple[float, float, float]]] = {}
    for miss in holdout_errors:
        for name, pair in miss.measures.items():
            pairs.setdefault(measure_kind(name), []).append((*pair, discrepancy_growth(miss.index)))
    known = {kind: np.array(values) for kind, values in pairs.items() if len(values) >= _FEWEST_VALUES}
    kinds = {kind: float(excess_sd(v[:, :1], v[:, 1:2], v[:, 2:])[0]) for kind, v in known.items()}
    # above zero, for a division
    ratios = [np.mean((v[:, 0] / np.maximum(v[:, 1], 1e-300)) ** 2) for v in known.values()]
    factor = float(np.sqrt(max(np.median(ratios), 1.0))) if ratios else 1.0
    elapsed = {
        c: _elapsed_excess_sd(holdout_errors, c) for c in BAND_CHANNELS if all(c in m.errors for m in holdout_errors)
    }
    if {"x0", "y0"} <= set(elapsed):
        both = np.sqrt(0.5 * (elapsed["x0"] ** 2 + elapsed["y0"] ** 2))
        elapsed |= {"x0": both, "y0": both}
    return Discrepancy(kinds, factor, holdout_errors[0].dt, elapsed)


def _elapsed_excess_sd(holdout_errors: Sequence[HoldoutError], channel: str) -> Array:
    """Excess standard deviation by elapsed time; it grows, so isotonic regression of the excess variance.

    That of each sample is taken with its sign: set to zero where it is negative, chance alone would add to it. A normal
    error's square varies by twice its variance squared, and counts by that: what is foreseen too widely late in a run
    does not cancel what is missed early.
    """
    longest = max(len(m.errors[channel]) for m in holdout_errors)
    error, expected = np.full((2, len(holdout_errors), longest), np.nan)
    for row, miss in enumerate(holdout_errors):
        error[row, : len(miss.errors[channel])] = miss.errors[channel]
        expected[row, : len(miss.predicted_sd[channel])] = miss.predicted_sd[channel]
    is_read = np.isfinite(error)
    grown = np.array([[discrepancy_growth(miss.index)] for miss in holdout_errors])
    from scipy.optimize import isotonic_regression

    # both above zero, for a division, where nothing is measured
    count = np.maximum(is_read.sum(axis=0), 1e-9)
    weight = np.maximum(np.sum(is_read * grown**2, axis=0), 1e-9)  # as the count
    square, foreseen = (np.sum(np.where(is_read, v, 0.0) ** 2, axis=0) for v in (error, expected))
    variance = np.maximum(isotonic_regression(square / count, weights=count).x, foreseen / count)
    precision = count / np.maximum(variance / np.max(variance, initial=1e-300), 1e-6) ** 2  # rounding of a quotient
    return np.sqrt(np.maximum(isotonic_regression((square - foreseen) / weight, weights=precision).x, 0.0))


def excess_sd(errors: Array, predicted_sd: Array, growth_factors: Array) -> Array:
    """Standard deviation d of each column for which errors of variance f^2 + (g d)^2 have the size they have, (n,).

    Solves sum e^2 / (f^2 + g^2 d^2) = number of errors (Paule & Mandel 1982, J. Res. NBS 87, 377) by bisection; 0 where
    the errors are no larger than foreseen. errors, predicted_sd: (m, n), or NaN; growth_factors: (m, 1).
    """
    count = np.isfinite(errors).sum(axis=0)
    square, expected = np.where(np.isfinite(errors), errors, 0.0) ** 2, np.nan_to_num(predicted_sd) ** 2
    low, high = np.zeros(errors.shape[1]), np.max(square, axis=0) + 1e-300  # above zero, for a division
    for _ in range(60):  # bisections, down to the last bit
        middle = 0.5 * (low + high)
        large = np.sum(square / (expected + growth_factors**2 * middle), axis=0) > count
        low, high = np.where(large, middle, low), np.where(large, high, middle)
    return np.sqrt(np.where(low > 0.0, high, 0.0))
