"""What stands for the derivative in a regression: differences, a smoothed slope, the weak form."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.numerics.kernels.integrate import DIVERGED, evaluate_tangent
from seatrial.numerics.local_polynomials import smoothed_locally
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import hidden_states, measured_states

# The equations along a record: each rate as known terms plus features times coefficients, from the model itself.

_PROBE_FACTOR = 1.37  # no round number, so that no term vanishes at the probe; chosen
_ROUNDED = 1e-9  # of a feature, below which a change is rounding; chosen
_TIME_TOLERANCE = 1e-3  # of a sampling step, beyond which it is a gap


def demand_positive(name: str, value: float) -> None:
    """Refuse a setting that is not a positive number.

    Raises:
        InputError: naming it.
    """
    if not 0.0 < value < np.inf:
        raise InputError(f"{name} is {value:g}; give a positive number")


@dataclass(frozen=True, eq=False)
class RegressionMotion:
    """What a record says of a model: times (n,) [s], states (n, nx), inputs (n, nu) in the model's signs.

    Times may have gaps, where cleaning took samples away.
    """

    time: Array
    states: Array
    inputs: Array

    @classmethod
    def from_record(cls, model: Model, record: Record) -> Self:
        """The motion of a record; velocities that were not measured are derived where that can be done.

        Raises:
            InputError: a state is hidden, not derivable or without a value; an input is missing; too few samples.
        """
        if hidden := hidden_states(model, [record]):
            raise InputError(
                f"record '{record.name}' does not show {', '.join(hidden)}, states of model '{model.name}': "
                "regression needs every state; use output error (seatrial identify)"
            )
        if len(record) < 3:
            raise InputError(f"record '{record.name}' has {len(record)} samples; regression needs at least three")
        for state in model.states:
            if state in record and not np.isfinite(record[state]).all():
                raise InputError(
                    f"record '{record.name}': channel '{state}' has no value at sample "
                    f"{int(np.argmin(np.isfinite(record[state]))) + 1}; use regress.cleaning.without_missing first"
                )
        return cls(record.time, measured_states(model, record), inputs_of(model, record))

    @property
    def dt(self) -> float:
        """The usual time step [s]."""
        return float(np.median(np.diff(self.time)))

    def gapless_slices(self) -> list[slice]:
        """The stretches without a gap."""
        gaps = np.flatnonzero(np.abs(np.diff(self.time) - self.dt) > _TIME_TOLERANCE * self.dt) + 1
        return [slice(int(a), int(b)) for a, b in pairwise([0, *gaps, len(self.time)])]

    def rows(self, index: slice) -> Self:
        """The samples of a slice."""
        return type(self)(self.time[index], self.states[index], self.inputs[index])


@dataclass(frozen=True, eq=False)
class Features:
    """dx/dt = known_rates + slope theta: (n, nx), slope (n, nx, k), k the free coefficients of the model."""

    known_rates: Array
    slope: Array


def features(model: Model, motion: RegressionMotion) -> Features:
    """The features of every rate at every sample, from the generated Jacobian.

    Raises:
        InputError: the rates are not linear in the free coefficients.
    """
    values = model.parameters.values
    free = [model.parameters.index(n) for n in model.parameters.free_names]
    rates, slope = _tangent(model, motion, values)
    moved = np.abs(_tangent(model, motion, _probed(values, free))[1] - slope).max(axis=(0, 1))
    curved = np.flatnonzero(moved > _ROUNDED * np.abs(slope).max(axis=(0, 1)))
    if curved.size:
        named = ", ".join(model.parameters.free_names[i] for i in curved)
        raise InputError(
            f"model '{model.name}' is not linear in {named}, as regression needs: fix under [model] what multiplies or "
            "divides the others, or use output error"
        )
    return Features(rates - slope @ values[free], slope)


def feature_interactions(model: Model, motion: RegressionMotion) -> NDArray[np.bool_]:
    """Return whether the feature of coefficient j changes with coefficient i, (k, k): none of a linear model."""
    places = [model.parameters.index(n) for n in model.parameters.free_names]
    meets = np.zeros((len(places), len(places)), dtype=np.bool_)
    values = model.parameters.values
    for base in (values, _probed(values, places)):  # a product shows where neither factor is zero
        slope = _tangent(model, motion, base)[1]
        scale = np.abs(slope).max(axis=(0, 1))
        for row, place in enumerate(places):
            moved = np.abs(_tangent(model, motion, _probed(base, [place]))[1] - slope).max(axis=(0, 1))
            meets[row] |= moved > _ROUNDED * scale
    return meets


def _probed(values: Array, places: Sequence[int]) -> Array:
    """Parameters with some of them moved, those that are zero too."""
    probe = values.copy()
    probe[places] = _PROBE_FACTOR * values[places] + np.where(values[places] == 0.0, 1.0, 0.0)
    return probe


def _tangent(model: Model, motion: RegressionMotion, values: Array) -> tuple[Array, Array]:
    nx, nu, n = len(model.states), len(model.inputs), len(motion.time)
    rates, jacobian = np.empty((n, nx)), np.zeros((n, nx, nx + nu + len(values)))
    x, u = np.ascontiguousarray(motion.states), np.ascontiguousarray(motion.inputs)
    evaluate_tangent(model.compiled.rates_tangent, x, u, np.tile(values, (n, 1)), motion.dt, rates, jacobian)
    return rates, jacobian[:, :, [nx + nu + model.parameters.index(name) for name in model.parameters.free_names]]


# The weak form: equations integrated against smooth windows, so that no derivative of data is ever taken.

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
        linearisation: of the point that was looked at last, as bytes; it does not depend on `residual_sd`.
    """

    model: Model
    states: tuple[Array, ...]
    inputs: tuple[Array, ...]
    dt: float
    half_width: float
    residual_sd: Array
    linearisation: dict[bytes, tuple[Array, Array]] = field(default_factory=dict, init=False)

    def weighted(self, residual_sd: Array) -> "WeakForm":
        """Return it with other standard deviations of the residuals."""
        weighted = replace(self, residual_sd=residual_sd)
        weighted.linearisation.update(self.linearisation)
        return weighted

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
        """Windowed residuals (windows, nx) and their derivatives (windows, nx, free), worked out once at a point."""
        if (key := point.tobytes()) not in self.linearisation:
            linearised = self._linearised(point)
            self.linearisation.clear()
            self.linearisation[key] = linearised
        return self.linearisation[key]

    def _linearised(self, point: Array) -> tuple[Array, Array]:
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


# What stands for the derivative in a regression: differences, a smoothed slope, the weak form; and what follows it.

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
