"""Regressions made as strong as we could, for the comparison alone: all channels smoothed first, or rows weighted.

Both are given what no regression knows by itself, the true noise of every sensor; the smoother's bandwidth is the one
that served it best.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.example_series import SENSOR_NOISE
from seatrial.estimation.regress.estimators import RegressionEstimate, RegressionEstimator
from seatrial.estimation.regress.operators import RegressionMotion, window_function
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.physics.simulate.replay import replay

Array = NDArray[np.float64]
SMOOTHED = ("u", "v", "r", "psi", "x0", "y0")
# mean squares of the second derivatives of u, v, r along this manoeuvre without noise
JERK = np.array([2.82e-8, 4.50e-8, 5.53e-9])
ROUNDS = 4
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(3)


@dataclass(frozen=True)
class SmoothedRegression:
    """Another estimator on records smoothed by an extended Kalman filter and its backward pass (Rauch et al. 1965).

    The kinematics couple all six channels; accelerations are random walks, `bandwidth` times those of the craft.
    """

    name: str
    regression: RegressionEstimator
    bandwidth: float

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients from the smoothed records."""
        return self.regression.estimate(model, [smoothed(r, self.bandwidth) for r in records])


@dataclass(frozen=True)
class WeightedRegression:
    """The weak form of all rates at once, its rows weighted by the covariance of what noise leaves in them.

    WENDy (Bortz, Messenger & Dukic 2023, doi 10.1007/s11538-023-01208-6) without its choice of windows: reweighted
    least squares. What no publication has but makes it stronger:

    Attributes:
        corrected: features less the bias that the variance of the noise gives them.
        instrumented: features of the simulated motion as instruments, in the weights and for that bias. That is a step
            of Gauss and Newton from the simulation to the record, all but output error by another way.
    """

    name: str
    seconds: float
    corrected: bool = False
    instrumented: bool = False

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients after `ROUNDS` of reweighting."""
        (record,) = records
        motion = RegressionMotion.from_record(model, record)
        at = _tangent(model, motion, np.zeros(len(model.parameters.free_names)))
        weak = _rows(model, self._reduce_bias(model, at, motion), motion, self.seconds)
        found = np.asarray(np.linalg.lstsq(weak.slope, -weak.residual)[0], dtype=np.float64)
        for _ in range(ROUNDS):
            ship = RegressionEstimate(found).in_model(model)
            seen = RegressionMotion.from_record(model, replay(ship, record)) if self.instrumented else motion
            known = _rows(model, _tangent(model, seen, found), seen, self.seconds)
            if self.instrumented:
                weak = _rows(model, self._reduce_bias(model, at, seen), motion, self.seconds)
            left = known.slope if self.instrumented else weak.slope
            weighted = solveh_banded(known.covariance(), left, lower=True)
            normal, target = weighted.T @ weak.slope, weighted.T @ -weak.residual
            found = np.asarray(np.linalg.solve(normal, target), dtype=np.float64)
        return RegressionEstimate(found)

    def _reduce_bias(self, model: Model, tangent: "_Tangent", motion: RegressionMotion) -> "_Tangent":
        return tangent.without_bias(model, motion) if self.corrected else tangent


@dataclass(frozen=True, eq=False)
class _Tangent:
    """Rates (n, nx) and their derivatives, at free coefficients `values` (k,).

    Attributes:
        states: to the states in units of their noise, (n, nx, nx).
        slope: to the free coefficients, (n, nx, k).
    """

    rates: Array
    states: Array
    slope: Array
    values: Array

    def without_bias(self, model: Model, motion: RegressionMotion) -> "_Tangent":
        """E f(x + n) - f(x) at the states x of a motion taken off, by Gauss-Hermite quadrature in each state."""
        centre = _tangent(model, motion, self.values)
        rates, slope = self.rates.copy(), self.slope.copy()
        acting = np.flatnonzero(np.any(centre.states, axis=(0, 1)))
        for i, (node, weight) in product(acting, zip(NODES, WEIGHTS / WEIGHTS.sum(), strict=True)):
            if node:
                shift = np.zeros(len(model.states))
                shift[i] = node * _deviations(model)[i]
                moved = _tangent(model, replace(motion, states=motion.states + shift), self.values)
                rates -= weight * (moved.rates - centre.rates)
                slope -= weight * (moved.slope - centre.slope)
        return replace(self, rates=rates, slope=slope)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Residuals (windows * nx,), features (windows * nx, k); what noise of each sample adds, (windows, nx, rows * nx).

    `step` is how many numbers of the last axis two neighbouring windows do not share.
    """

    residual: Array
    slope: Array
    noise: Array
    step: int

    def covariance(self) -> Array:
        """Of the residuals, as the lower bands that `scipy.linalg.solveh_banded` takes."""
        count, nx, width = self.noise.shape
        apart = -(-width // self.step)
        bands = np.zeros((nx * (apart + 1), count * nx))
        for d in range(apart):
            first, second = self.noise[: count - d, :, d * self.step :], self.noise[d:, :, : width - d * self.step]
            blocks = second @ np.swapaxes(first, 1, 2)
            for row in range(nx):
                for column in range(nx):
                    if (offset := d * nx + row - column) >= 0:
                        bands[offset, column : (count - d) * nx : nx] = blocks[:, row, column]
        return bands


def _deviations(model: Model) -> Array:
    return np.array([SENSOR_NOISE[s] for s in model.states])


def _tangent(model: Model, motion: RegressionMotion, free: Array) -> _Tangent:
    values = model.parameters.with_free_values(free).values
    nx, nu, n = len(model.states), len(model.inputs), len(motion.time)
    rates, jacobian = np.empty((n, nx)), np.zeros((n, nx, nx + nu + len(values)))
    x, u = np.ascontiguousarray(motion.states), np.ascontiguousarray(motion.inputs)
    evaluate_tangent(model.compiled.rates_tangent, x, u, np.tile(values, (n, 1)), motion.dt, rates, jacobian)
    columns = [nx + nu + model.parameters.index(name) for name in model.parameters.free_names]
    return _Tangent(rates, jacobian[:, :, :nx] * _deviations(model), jacobian[:, :, columns], free)


def _rows(model: Model, tangent: _Tangent, motion: RegressionMotion, seconds: float) -> _Rows:
    """Windows that overlap by three quarters: integral(w' x) + integral(w f) = 0."""
    nx, half = motion.states.shape[1], round(seconds / motion.dt)
    w, w_dot = (motion.dt * part for part in window_function(half, motion.dt))
    step, residual, slope, noise = half // 2, [], [], []
    for first in range(0, len(motion.time) - 2 * half, step):
        piece = slice(first, first + 2 * half + 1)
        about = motion.states[piece] - motion.states[first + half]
        residual.append(w_dot @ about + w @ tangent.rates[piece])
        slope.append(np.einsum("t,tip->ip", w, tangent.slope[piece]))
        moved = w[:, None, None] * tangent.states[piece] + w_dot[:, None, None] * np.diag(_deviations(model))
        noise.append(np.swapaxes(moved, 0, 1).reshape(nx, -1))
    return _Rows(np.concatenate(residual), np.concatenate(slope), np.array(noise), step * nx)


def smoothed(record: Record, bandwidth: float) -> Record:
    """The record with its six channels as filter and backward pass leave them."""
    measured = record.matrix(SMOOTHED)
    found = _smooth(measured, record.dt, bandwidth * JERK, np.array([SENSOR_NOISE[s] for s in SMOOTHED]) ** 2)
    channels = dict(record.channels)
    for i, symbol in enumerate(SMOOTHED):
        channels[symbol] = record.channel(symbol).with_values(found[:, i].copy())
    return replace(record, channels=channels)


@njit
def _step(x: Array, dt: float) -> tuple[Array, Array]:
    """The state u, v, r, psi, x0, y0, u', v', r' one step on, and its derivatives (9, 9)."""
    after, slope = x.copy(), np.eye(9)
    u, v, psi = x[0] + 0.5 * dt * x[6], x[1] + 0.5 * dt * x[7], x[3] + 0.5 * dt * x[2]
    cos, sin = np.cos(psi), np.sin(psi)
    north, east = u * cos - v * sin, u * sin + v * cos
    for i in range(3):
        after[i] += dt * x[6 + i]
        slope[i, 6 + i] = dt
    after[3] += dt * x[2] + 0.5 * dt**2 * x[8]
    slope[3, 2], slope[3, 8] = dt, 0.5 * dt**2
    after[4] += dt * north
    after[5] += dt * east
    slope[4, 0], slope[4, 1], slope[4, 3], slope[4, 2] = dt * cos, -dt * sin, -dt * east, -0.5 * dt**2 * east
    slope[5, 0], slope[5, 1], slope[5, 3], slope[5, 2] = dt * sin, dt * cos, dt * north, 0.5 * dt**2 * north
    slope[4, 6], slope[4, 7] = 0.5 * dt**2 * cos, -0.5 * dt**2 * sin
    slope[5, 6], slope[5, 7] = 0.5 * dt**2 * sin, 0.5 * dt**2 * cos
    return after, slope


@njit
def _smooth(measured: Array, dt: float, walk: Array, variance: Array) -> Array:
    """Extended Kalman filter, then the backward pass of Rauch, Tung & Striebel 1965; (n, 6) to (n, 9)."""
    n = len(measured)
    found, expected = np.zeros((n, 9)), np.zeros((n, 9))
    spread, before, slopes = np.zeros((n, 9, 9)), np.zeros((n, 9, 9)), np.zeros((n, 9, 9))
    noise, seen, unit = np.zeros((9, 9)), np.diag(variance), np.eye(9)
    for i in range(3):
        noise[i, i], noise[6 + i, 6 + i] = walk[i] * dt**3 / 3.0, walk[i] * dt
        noise[i, 6 + i] = noise[6 + i, i] = walk[i] * dt**2 / 2.0
    x, p = np.zeros(9), np.zeros((9, 9))
    x[:6] = measured[0]
    for i in range(6):
        p[i, i] = 10.0 * variance[i]
    p[6, 6], p[7, 7], p[8, 8] = 0.1, 0.1, 0.01
    for k in range(n):
        if k > 0:
            x, slopes[k] = _step(x, dt)
            p = slopes[k] @ p @ slopes[k].T + noise
        expected[k], before[k] = x, p
        gain = np.ascontiguousarray(p[:, :6]) @ np.linalg.inv(p[:6, :6] + seen)
        x = x + gain @ (measured[k] - x[:6])
        p = p - gain @ np.ascontiguousarray(p[:6, :])
        p = 0.5 * (p + p.T) + 1e-18 * unit
        found[k], spread[k] = x, p
    for k in range(n - 2, -1, -1):
        back = spread[k] @ slopes[k + 1].T @ np.linalg.inv(before[k + 1])
        found[k] = found[k] + back @ (found[k + 1] - expected[k + 1])
    return found
