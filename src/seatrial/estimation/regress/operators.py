"""What stands for the derivative in a regression: differences, a smoothed slope, the weak form; and what follows it.

Every operator turns the motion into rows y = Phi theta, one block a rate: y what stands for dx/dt less the known terms.
They nest: ``Centred(Differenced(Euler()))`` is the published improvement of Song et al. 2025.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.estimation.regress.features import Features, RegressionMotion, demand_positive, features
from seatrial.estimation.regress.weak import window_bounds, window_function
from seatrial.numerics.local_polynomials import smoothed_locally

_ROUNDING = 1e-12  # of the mean, below which a deviation from it is rounding


@dataclass(frozen=True, eq=False)
class RegressionRows:
    """time (m,), target (m, nx) and slope (m, nx, k); `step` is the time between neighbouring rows [s]."""

    time: Array
    target: Array
    slope: Array
    step: float


class DerivativeOperator(Protocol):
    """From a motion to rows."""

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """The rows of one run; none where it is too short."""
        ...


@dataclass(frozen=True)
class Euler:
    """(x(k+1) - x(k)) / h against the features at k (Song et al. 2025, eq. (14))."""

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """All rows whose next sample follows without a gap."""
        at = features(model, motion)
        return _difference_rows(motion, at, lambda x, h: (x[1:] - x[:-1]) / h, slice(0, -1))


@dataclass(frozen=True)
class Central:
    """(x(k+1) - x(k-1)) / 2h against the features at k: an error of second order in h, where Euler's is of first."""

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """All rows with a neighbour on both sides."""
        at = features(model, motion)
        return _difference_rows(motion, at, lambda x, h: (x[2:] - x[:-2]) / (2.0 * h), slice(1, -1))


@dataclass(frozen=True)
class Smoothed:
    """States and slopes by local cubic polynomials over `seconds` (Savitzky & Golay 1964), then as `Central`.

    Raises:
        InputError: a window that is not positive.
    """

    seconds: float

    def __post_init__(self) -> None:
        demand_positive("the smoothing window in s", self.seconds)

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """All rows of stretches longer than the window."""
        width = max(5, 2 * round(0.5 * self.seconds / motion.dt) + 1)  # samples of the shortest window; chosen
        pieces = []
        for stretch in motion.gapless_slices():
            part = motion.rows(stretch)
            if len(part.time) > width:
                states = smoothed_locally(part.states, width, 3)
                slope = smoothed_locally(part.states, width, 3, 1, motion.dt)
                at = features(model, replace(part, states=np.ascontiguousarray(states)))
                inside = slice(width // 2, -(width // 2))
                pieces.append((part.time[inside], (slope - at.known_rates)[inside], at.slope[inside]))
        return _join_rows(pieces, motion)


@dataclass(frozen=True)
class Weak:
    """Means over smooth windows of half width `seconds`, by parts: no derivative of data is taken (see `weak`).

    Raises:
        InputError: a window that is not positive.
    """

    seconds: float

    def __post_init__(self) -> None:
        demand_positive("the half width of the weak form's window in s", self.seconds)

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """One row a window."""
        at = features(model, motion)
        half, pieces = max(2, round(self.seconds / motion.dt)), []
        for stretch in motion.gapless_slices():
            first = stretch.start
            for a, b in window_bounds(stretch.stop - first, half):
                if b - a < 4:
                    continue
                piece, w, w_dot = slice(first + a, first + b + 1), *window_function((b - a) // 2, motion.dt)
                x, mass = motion.states[piece], float(w.sum())
                rate = -(w_dot @ (x - x[len(x) // 2])) / mass
                target = rate - w @ at.known_rates[piece] / mass
                slope = np.einsum("t,tip->ip", w, at.slope[piece]) / mass
                pieces.append((motion.time[piece][(b - a) // 2, None], target[None], slope[None]))
        return _join_rows(pieces, motion)


@dataclass(frozen=True)
class Differenced:
    """y(k) - rho y(k-1) of another operator's rows; rho = 1 is the difference (Song et al. 2025, eq. (17))."""

    inner: DerivativeOperator
    rho: float = 1.0

    def __post_init__(self) -> None:
        if not np.isfinite(self.rho):
            raise InputError(f"rho = {self.rho:g} of a quasi-difference is no number; give one from 0 to 1")

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """All rows whose predecessor is there."""
        before = self.inner.rows(model, motion)
        # share by which time steps may differ; chosen
        follows = np.abs(np.diff(before.time) - before.step) <= 1e-3 * before.step
        return RegressionRows(
            before.time[1:][follows],
            (before.target[1:] - self.rho * before.target[:-1])[follows],
            (before.slope[1:] - self.rho * before.slope[:-1])[follows],
            before.step,
        )


@dataclass(frozen=True)
class Centred:
    """Rows less their mean (Song et al. 2025, eq. (18)): a constant force is no longer identifiable."""

    inner: DerivativeOperator

    def rows(self, model: Model, motion: RegressionMotion) -> RegressionRows:
        """The other operator's rows about their means."""
        before = self.inner.rows(model, motion)
        return replace(before, target=_without_mean(before.target), slope=_without_mean(before.slope))


def _without_mean(values: Array) -> Array:
    """About the mean of the rows; what is constant but for rounding becomes zero."""
    mean = values.mean(axis=0)
    about = values - mean
    return np.where(np.abs(about) > _ROUNDING * np.abs(mean), about, 0.0)


def _difference_rows(
    motion: RegressionMotion, regressors: Features, rate: Callable[[Array, float], Array], inside: slice
) -> RegressionRows:
    pieces = []
    for stretch in motion.gapless_slices():
        x = motion.states[stretch]
        if len(x) > 2:
            known, slope = regressors.known_rates[stretch][inside], regressors.slope[stretch][inside]
            pieces.append((motion.time[stretch][inside], rate(x, motion.dt) - known, slope))
    return _join_rows(pieces, motion)


def _join_rows(pieces: list[tuple[Array, Array, Array]], motion: RegressionMotion) -> RegressionRows:
    if not pieces:
        nx = motion.states.shape[1]
        return RegressionRows(np.zeros(0), np.zeros((0, nx)), np.zeros((0, nx, 0)), motion.dt)
    time, target, slope = (np.concatenate([p[i] for p in pieces]) for i in range(3))
    step = float(np.median(np.diff(time))) if len(time) > 1 else motion.dt
    return RegressionRows(time, target, slope, step)
