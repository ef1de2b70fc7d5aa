"""Tests for a disturbance: a hint in the spectrum of residuals, and the likelihood ratio of process noise."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import comb

import numpy as np
from scipy.special import chdtrc

from seatrial.core.values import Array
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.estimation.information.whiteness import WhitenessTest, autocorrelation, variance_inflation, whiteness_test
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.estimation.problem.segments import Segments

# Do residuals of a fit hint at a disturbance? A test of their spectrum that costs next to nothing.

HINT = 6.0
"""Twice the gain of log-likelihood in any channel from which on disturbances are fitted: 1 % by chance; chosen."""

# longest piece whose periodogram is taken, and shortest that counts, samples; chosen
_LONGEST_PIECE, _SHORTEST_PIECE = 4096, 32
# correlation times that are tried, samples, and how many; chosen
_SHORTEST, _LONGEST, _TIME_COUNT = 2.0, 2000.0, 10
# powers at zero frequency over that of white noise that are tried, and how many besides none; chosen
_FAINTEST, _STRONGEST, _POWER_COUNT = 1e-2, 1e6, 25
_TIMES = np.geomspace(_SHORTEST, _LONGEST, _TIME_COUNT)
_POWERS = np.concatenate([[0.0], np.geomspace(_FAINTEST, _STRONGEST, _POWER_COUNT)])


def spectral_hint(pieces: Sequence[Array]) -> float:
    """Return twice the gain of log-likelihood by first-order noise in the channel where it is largest.

    pieces: residuals of each run, (rows, ny); NaN where nothing was measured, which counts as zero.
    """
    length = min(_LONGEST_PIECE, min(len(p) for p in pieces))
    if length < _SHORTEST_PIECE:
        return 0.0
    cut = [p[a : a + length] for p in pieces for a in range(0, len(p) - length + 1, length)]
    power = np.mean([np.abs(np.fft.rfft(np.nan_to_num(c), axis=0)) ** 2 for c in cut], axis=0)[1:]
    angle = 2.0 * np.pi * np.arange(1, len(power) + 1) / length
    return max((len(cut) * _gain(power[:, i], angle) for i in range(power.shape[1])), default=0.0)


def _gain(power: Array, angle: Array) -> float:
    """Twice the gain for one averaged periodogram (frequencies,); the level of the noise is profiled out."""
    if not np.all(power > 0.0):
        return 0.0
    low_pass = 1.0 / (1.0 + (angle * _TIMES[:, None]) ** 2)
    shape = 1.0 + _POWERS[:, None, None] * low_pass
    loss = np.mean(np.log(shape), axis=2) + np.log(np.mean(power / shape, axis=2))
    return float(2.0 * len(power) * (loss[0, 0] - loss.min()))


# Is process noise needed to explain the records, and does white noise in the states suffice?

# of the likelihood-ratio test, ours: more disturbances than needed cost more than too few
CONFIDENCE_LEVEL = 0.999
# samples up to which autocorrelations are summed, ours
_LAGS = 400


@dataclass(frozen=True, eq=False)
class ProcessNoiseTest:
    """Whether process noise is needed to explain the records, and whether white noise in the states suffices.

    Attributes:
        likelihood_ratio: 2 (log-likelihood with process noise - without), both at their own optimum; infinite where the
            model without it diverges.
        critical_value: what chance alone exceeds once in a thousand cases.
        inflation_without, inflation: variance inflation of each channel's normalised innovations without and with
            process noise, (ny,); NaN where no fit without it was made.
        whiteness: of the normalised innovations with process noise.
    """

    likelihood_ratio: float
    critical_value: float
    inflation_without: Array
    inflation: Array
    whiteness: WhitenessTest

    @property
    def is_needed(self) -> bool:
        """The records are explained better than chance allows."""
        return self.likelihood_ratio > self.critical_value

    @property
    def is_white(self) -> bool:
        """Innovations are white: nothing is left to explain."""
        return self.whiteness.is_white

    @property
    def is_nearly_white(self) -> bool:
        """Innovations are white, or correlated so weakly that what is left to explain hardly changes the estimate."""
        return self.is_white or bool(np.max(self.inflation) <= WHITE_INFLATION)

    @property
    def innovations_text(self) -> str:
        """Whether the innovations are white, with the test's number, in words."""
        p, after = f"p {self.whiteness.smallest:.2g}", float(np.max(self.inflation))
        if self.is_white:
            return f"innovations are white (Ljung-Box, {p})"
        effect = "weakly" if self.is_nearly_white else "strongly"
        return (
            f"innovations are not white (Ljung-Box, {p}) and {effect} correlated (variance inflation {after:.3g}): "
            "model error, or a disturbance of another kind"
        )

    @property
    def summary(self) -> str:
        """The verdict in words."""
        before = float(np.max(self.inflation_without))
        if not self.is_needed:
            return (
                f"no process noise: it raises twice the log-likelihood by {self.likelihood_ratio:.3g} only, "
                f"chance alone by {self.critical_value:.3g}"
            )
        seen = f"residuals of whole runs inflate variances by {before:.3g}, and " if np.isfinite(before) else ""
        why = f"without process noise {seen}twice the log-likelihood is {self.likelihood_ratio:.3g} lower"
        if np.isinf(self.likelihood_ratio):
            why = "without process noise the model diverges over whole runs"
        return f"process noise: {why}; with it {self.innovations_text}"


def likelihood_ratio_test(
    problem: PredictionError, point: Array, cost_with: float, cost_without: float, innovations_without: Array | None
) -> ProcessNoiseTest:
    """The gate at a point, from minus the log-likelihoods with and `without` process noise.

    before: normalised innovations (rows, ny) without process noise, where that was fitted.
    """
    data, ny = problem.runs.data, len(problem.runs.data.outputs)
    normalised = problem.innovations(point).normalised
    return ProcessNoiseTest(
        likelihood_ratio=max(2.0 * (cost_without - cost_with), 0.0),
        critical_value=boundary_quantile(len(problem.process), CONFIDENCE_LEVEL),
        inflation_without=np.full(ny, np.nan)
        if innovations_without is None
        else _inflation(_autocorrelations(data, innovations_without)),
        inflation=_inflation(_autocorrelations(data, normalised)),
        whiteness=whiteness_test([normalised[a:b] for a, b in pairwise(data.offsets)]),
    )


def innovation_correlation(problem: PredictionError, point: Array) -> tuple[list[Array], Array]:
    """Autocorrelation and variance inflation of each channel's normalised innovations."""
    rho = _autocorrelations(problem.runs.data, problem.innovations(point).normalised)
    return rho, _inflation(rho)


def _autocorrelations(data: Segments, normalised: Array) -> list[Array]:
    lags = min(int(np.max(np.diff(data.offsets))) // 2, _LAGS)
    pieces = [normalised[a:b] for a, b in pairwise(data.offsets)]
    return [autocorrelation([p[:, i] for p in pieces], lags) for i in range(normalised.shape[1])]


def _inflation(rho: list[Array]) -> Array:
    return np.array([variance_inflation(r) for r in rho])


def boundary_quantile(count: int, level: float) -> float:
    """Quantile of a likelihood ratio whose `count` unknowns lie on their lower bounds if there is no effect.

    A mixture of chi squared with 0..count degrees of freedom and binomial weights (Self & Liang 1987, case 9, for
    unknowns of uncorrelated estimates).
    """
    from scipy.optimize import brentq

    weights = np.array([comb(count, j) for j in range(count + 1)]) / 2.0**count

    def excess(value: float) -> float:
        return float(sum(w * chdtrc(j, value) for j, w in enumerate(weights) if j)) - (1.0 - level)

    return float(np.asarray(brentq(excess, 0.0, 200.0))) if count else 0.0  # bracket beyond any quantile in use
