"""The weak form: equations integrated against smooth windows, so that no derivative of data is ever taken.

For every rate dx_i/dt = f_i and window w with w = 0 at both ends: integral(w' x_i) + integral(w f_i) = 0
(Preisig & Rippin 1993, modulating functions; Messenger & Bortz 2021, eq. (2.3)). Linear in every parameter that enters
the equations linearly, so that Gauss-Newton needs one step and no guess.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.kernels.sensitivity import evaluate_tangent
from seatrial.numerics.optimise import NormalEquations

_POWER = 4


def window_bounds(rows: int, half: int) -> list[tuple[int, int]]:
    """First and last row of each window, half-overlapping; the whole record where it is short."""
    half = min(half, (rows - 1) // 2)
    return [(start, start + 2 * half) for start in range(0, rows - 2 * half, max(1, half // 2))]


def window_function(half: int, dt: float) -> tuple[Array, Array]:
    """The window (1 - s^2)^4 and its time derivative on 2 half + 1 samples."""
    s = np.linspace(-1.0, 1.0, 2 * half + 1)
    return (1 - s**2) ** _POWER, -2 * _POWER * s * (1 - s**2) ** (_POWER - 1) / (half * dt)


@dataclass(frozen=True, eq=False)
class WeakForm:
    """Least squares over all windows of all runs; states are taken as measured.

    Attributes:
        states, inputs: one array a run, (rows, nx) and (rows, nu), model's signs.
        half_width: of the windows, s.
        residual_sd: standard deviation of each rate's windowed residual, shape (nx,).
    """

    model: Model
    states: tuple[Array, ...]
    inputs: tuple[Array, ...]
    dt: float
    half_width: float
    residual_sd: Array

    @property
    def _free(self) -> Sequence[int]:
        return [self.model.parameters.index(n) for n in self.model.parameters.free_names]

    @property
    def lower(self) -> Array:
        """Lower bounds of the free parameters."""
        return np.array([p.lower for p in self.model.parameters.free])

    @property
    def upper(self) -> Array:
        """Upper bounds of the free parameters."""
        return np.array([p.upper for p in self.model.parameters.free])

    @cached_property
    def _half(self) -> int:
        return max(2, round(self.half_width / self.dt))

    @cached_property
    def _mean_inputs(self) -> list[Array]:
        """Inputs by which the trapezoidal rule is exact: where one is held, the mean of its values on both sides."""
        is_held = np.array([i.is_held for i in self.model.inputs])
        before = [np.concatenate([u[:1], u[:-1]]) for u in self.inputs]
        return [np.where(is_held, 0.5 * (u + b), u) for u, b in zip(self.inputs, before, strict=True)]

    def linearised(self, point: Array) -> tuple[Array, Array]:
        """Windowed residuals (windows, nx) and their derivatives (windows, nx, free)."""
        values = self.model.parameters.with_free_values(point).values
        nx, nu = len(self.model.states), len(self.model.inputs)
        residuals, jacobians = [], []
        for x, u in zip(self.states, self._mean_inputs, strict=True):
            out, jac = np.empty((len(x), nx)), np.zeros((len(x), nx, nx + nu + len(values)))
            evaluate_tangent(self.model.compiled.rates_tangent, x, u, np.tile(values, (len(x), 1)), self.dt, out, jac)
            jac = jac[:, :, [nx + nu + i for i in self._free]]
            bounds = window_bounds(len(x), self._half)
            w, w_dot = window_function((bounds[0][1] - bounds[0][0]) // 2, self.dt)
            for first, last in bounds:
                piece = slice(first, last + 1)
                middle = x[(first + last) // 2]
                residuals.append(self.dt * (w_dot @ (x[piece] - middle) + w @ out[piece]))
                jacobians.append(self.dt * np.einsum("t,tip->ip", w, jac[piece]))
        return np.array(residuals), np.array(jacobians)

    def _prior(self, point: Array) -> tuple[float, Array, Array]:
        mean, weight = point.copy(), np.zeros(len(point))
        for i, p in enumerate(self.model.parameters.free):
            if p.prior is not None:
                mean[i], weight[i] = p.prior.mean, p.prior.standard_deviation**-2
        gap = point - mean
        return 0.5 * float(weight @ gap**2), weight * gap, np.diag(weight)

    def cost(self, shared: Array, local: Array) -> float:
        """Half the weighted sum of squares with the prior's."""
        del local
        scaled = self.linearised(shared)[0] / self.residual_sd
        value = 0.5 * float(np.sum(scaled**2)) + self._prior(shared)[0]
        return value if value < DIVERGED**2 else np.inf

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """The Gauss-Newton model at a point."""
        residual, jacobian = self.linearised(shared)
        scaled = (residual / self.residual_sd).ravel()
        j = (jacobian / self.residual_sd[:, None]).reshape(len(scaled), -1)
        cost, gradient, hessian = self._prior(shared)
        empty = np.zeros((0, len(shared), 0))
        return NormalEquations(0.5 * float(scaled @ scaled) + cost, j.T @ scaled + gradient, j.T @ j + hessian,
                      local, np.zeros((len(local), 0, 0)), empty)  # fmt: skip
