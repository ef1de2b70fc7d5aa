"""Populations of small linear models in the same inputs: trajectories and fitness of all candidates at once.

Every candidate has matrices of its own, x' = A x + B u. A candidate's numbers do not depend on its neighbours.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.kernel import TangentPointer
from seatrial.numerics.kernels.linear import affine_population
from seatrial.numerics.kernels.linear_population import discretise, misfit
from seatrial.numerics.kernels.linear_population import trajectories as simulated

HEAVE_AND_PITCH = (0, 2)


@dataclass(frozen=True, eq=False)
class Forcing:
    """Inputs that all candidates meet.

    Attributes:
        inputs: ((samples - 1) substeps + 1, nu), `substeps` intervals to a sample.
        dt: s, between samples.
        is_held: constant over each interval (Qi et al. 2025, eq. (8)); otherwise straight between rows.
        held_columns: inputs that are held though the others run straight.

    Raises:
        InputError: on construction, if the rows do not fit the substeps, dt is not positive, or a value is not finite.
    """

    inputs: Array
    dt: float
    is_held: bool
    substeps: int = 1
    held_columns: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.substeps < 1 or len(self.inputs) < 2 or (len(self.inputs) - 1) % self.substeps:
            raise InputError(
                f"forcing of {len(self.inputs)} rows is no whole number of samples with {self.substeps} substeps each; "
                "give (samples - 1) * substeps + 1 rows"
            )
        if not 0.0 < self.dt < np.inf:
            raise InputError(f"forcing with a sample interval of {self.dt} s; give a positive one")
        bad = np.flatnonzero(~np.isfinite(self.inputs).all(axis=1))
        if bad.size:
            raise InputError(f"forcing is not finite in row {bad[0]}; fill the gap before simulating")

    @property
    def samples(self) -> int:
        """Number of samples."""
        return (len(self.inputs) - 1) // self.substeps + 1

    @cached_property
    def rows(self) -> Array:
        """What a step multiplies by Gamma: u_k, or u_k beside u_{k+1}."""
        u = np.array(self.inputs, dtype=np.float64, order="C")
        if self.is_held:
            return u
        after = np.vstack([u[1:], u[-1:]])
        after[:, self.held_columns] = u[:, self.held_columns]
        return np.hstack([u, after])

    def one_step(self, sample: int) -> "Forcing":
        """Return the forcing from one sample to the next.

        Raises:
            InputError: there is no next one.
        """
        if not 0 <= sample < self.samples - 1:
            raise InputError(f"no step from sample {sample} in a forcing of {self.samples} samples")
        first = sample * self.substeps
        return replace(self, inputs=self.inputs[first : first + self.substeps + 1])


# one pointer for each compiled function: numba needs more time to look a function up than a population takes
_rates_pointer = cache(TangentPointer)


def affine_population_matrices(model: Model, parameters: Array, inputs: Sequence[int]) -> tuple[Array, Array]:
    """A (count, nx, nx) and B (count, nx, inputs) of an affine model at each row of parameters, all of the model's.

    inputs: the columns of B that are kept, those of the inputs that move.

    Raises:
        InputError: the model's rates are not zero at rest, which such a population cannot simulate.
    """
    nx, nu = len(model.states), len(model.inputs)
    value = affine_population(_rates_pointer(model.compiled.rates_tangent), nx, nu, parameters)
    if np.any(value[:, :, nx + nu] != 0.0):
        raise InputError(f"model '{model.name}' has rates at rest; a population of it cannot be simulated at once")
    return value[:, :, :nx], value[:, :, [nx + j for j in inputs]]


def discretised_hold(A: Array, B: Array, dt: float) -> tuple[Array, Array]:
    """Return Phi (count, nx, nx) and Psi (count, nx, nu) of A, B, same shapes: x_{k+1} = Phi x_k + Psi u_k.

    NaN where a matrix is not finite or too large to be scaled.
    """
    return _discretised(A, B, dt, is_ramp=False)


def discretised_ramp(A: Array, B: Array, dt: float) -> tuple[Array, Array, Array]:
    """Return Phi, G0, G1 of inputs straight between samples: x_{k+1} = Phi x_k + G0 u_k + G1 u_{k+1}; as for a hold."""
    phi, gamma = _discretised(A, B, dt, is_ramp=True)
    nu = B.shape[2]
    return phi, gamma[:, :, :nu], gamma[:, :, nu:]


def trajectories(
    A: Array, B: Array, forcing: Forcing, start: Array, channels: tuple[int, ...] = HEAVE_AND_PITCH
) -> Array:
    """Return states `channels` of every candidate, shape (count, samples, channels).

    A (count, nx, nx), B (count, nx, nu); start (nx,) for all or (count, nx). What grows beyond all bounds is infinite
    or NaN in the result.

    Raises:
        InputError: shapes do not fit.
    """
    phi, gamma, x0 = _prepare(A, B, forcing, start)
    _require_states(channels, A.shape[1])
    y = np.empty((len(A), forcing.samples, len(channels)))
    simulated(phi, gamma, forcing.rows, forcing.substeps, x0, np.array(channels, dtype=np.int64), y)
    return y


def fitness(
    A: Array, B: Array, forcing: Forcing, start: Array, measured: Array, sigma: Array,
    channels: tuple[int, ...] = HEAVE_AND_PITCH,
) -> Array:  # fmt: skip
    """Sum over samples and channels of ((y - measured)/sigma)^2 of every candidate, shape (count,).

    measured (samples, channels), NaN where there is no sample; sigma (channels,), in the unit of each channel.
    Infinite, never NaN, for a candidate that is unstable beyond all bounds or whose matrices are not finite.

    Raises:
        InputError: shapes do not fit, a sigma is not positive, or nothing was measured.
    """
    phi, gamma, x0 = _prepare(A, B, forcing, start)
    nx = phi.shape[1]
    _require_states(channels, nx)
    if measured.shape != (forcing.samples, len(channels)):
        raise InputError(f"measured has shape {measured.shape}; the forcing wants ({forcing.samples}, {len(channels)})")
    if np.shape(sigma) != (len(channels),) or not np.all(np.asarray(sigma) > 0.0):
        raise InputError(f"sigma must be positive, one for each of {len(channels)} channels; got {sigma}")
    seen, weight = np.full((forcing.samples, nx), np.nan), np.zeros(nx)
    seen[:, channels] = measured
    weight[list(channels)] = 1.0 / np.square(sigma)
    if np.isnan(seen).all():
        raise InputError("no channel has a measured sample; there is nothing to compare candidates with")
    cost = np.empty(len(A))
    misfit(phi, gamma, forcing.rows, forcing.substeps, x0, seen, weight, cost)
    return cost


def one_sample_fitness(
    A: Array, B: Array, forcing: Forcing, sample: int, state: Array, measured: Array, sigma: Array,
    channels: tuple[int, ...] = HEAVE_AND_PITCH,
) -> Array:  # fmt: skip
    """Fitness of one step from the state (nx,) at `sample` to the next sample (Qi et al. 2025, eq. (28)); (count,).

    measured (channels,): at the next sample. Otherwise as `fitness`.
    """
    seen = np.full((2, len(channels)), np.nan)
    seen[1] = measured
    return fitness(A, B, forcing.one_step(sample), state, seen, sigma, channels)


def _discretised(A: Array, B: Array, dt: float, *, is_ramp: bool) -> tuple[Array, Array]:
    A, B = _checked_matrices(A, B)
    count, nx, nu = B.shape
    phi, gamma = np.empty((count, nx, nx)), np.empty((count, nx, 2 * nu if is_ramp else nu))
    discretise(A, B, dt, phi, gamma)
    return phi, gamma


def _checked_matrices(A: Array, B: Array) -> tuple[Array, Array]:
    if A.ndim != 3 or B.ndim != 3 or A.shape != (*B.shape[:2], B.shape[1]):
        raise InputError(f"matrices A {A.shape} and B {B.shape} do not fit; give (count, nx, nx) and (count, nx, nu)")
    return np.array(A, dtype=np.float64, order="C"), np.array(B, dtype=np.float64, order="C")


def _prepare(A: Array, B: Array, forcing: Forcing, start: Array) -> tuple[Array, Array, Array]:
    phi, gamma = _discretised(A, B, forcing.dt / forcing.substeps, is_ramp=not forcing.is_held)
    count, nx, nu = B.shape
    if forcing.inputs.shape[1:] != (nu,):
        raise InputError(f"forcing has shape {forcing.inputs.shape}; the matrices B want {nu} inputs in each row")
    if np.shape(start) not in ((nx,), (count, nx)) or not np.isfinite(start).all():
        raise InputError(f"start must be finite, of shape ({nx},) or ({count}, {nx}); got {np.shape(start)}")
    return phi, gamma, np.array(np.broadcast_to(start, (count, nx)), dtype=np.float64, order="C")


def _require_states(channels: tuple[int, ...], nx: int) -> None:
    if not channels or min(channels) < 0 or max(channels) >= nx:
        raise InputError(f"channels {channels} are no states; there are {nx}, counted from 0")
