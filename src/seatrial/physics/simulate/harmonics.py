"""Affine models under harmonic input: frequency response, and the exact motion in a sum of harmonics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError
from seatrial.numerics.kernels.linear import affine_matrices
from seatrial.numerics.kernels.propagate import propagators

Complex = NDArray[np.complex128]
_NONE: Index = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """x' = A x + B u, y = C x + D u of an affine model about its rest; (nx, nx), (nx, nu), (ny, nx), (ny, nu)."""

    A: Array
    B: Array
    C: Array
    D: Array


def linear_system(model: Model, outputs: tuple[str, ...] = ()) -> LinearSystem:
    """Return the matrices at the model's own parameters; outputs: observables in order, all states if none is named.

    Raises:
        InputError: the model is not affine in states and inputs.
    """
    if not model.is_affine:
        raise InputError(f"model '{model.name}' is not linear: it has no frequency response")
    nx, nu, ny = len(model.states), len(model.inputs), len(model.outputs)
    values = model.parameters.values
    rates, _ = affine_matrices(model.compiled.rates_tangent, nx, nx, nu, _NONE, values)
    seen, _ = affine_matrices(model.compiled.outputs_tangent, ny, nx, nu, _NONE, values)
    select = [model.observables.index(o) for o in outputs or model.states]
    rows = np.vstack([np.eye(nx, nx + nu + 1), seen])[select]
    return LinearSystem(rates[:, :nx], rates[:, nx:-1], rows[:, :nx], rows[:, nx:-1])


def frequency_response(system: LinearSystem, omega: Array) -> Complex:
    """Return C (i omega - A)^-1 B + D, shape (n, ny, nu); omega in rad/s, signed, time factor exp(+i omega t)."""
    resolvent = 1j * omega[:, None, None] * np.eye(len(system.A)) - system.A
    return system.C @ np.linalg.solve(resolvent, np.broadcast_to(system.B, (len(omega), *system.B.shape))) + system.D


def harmonic_motion(system: LinearSystem, omega: Array, amplitude: Complex, time: Array, start: Array) -> Array:
    """Return outputs under u = Re sum amplitude exp(i omega t), from state `start` at time[0]; exact, shape (n, ny).

    omega: (h,) rad/s, signed; amplitude: (h, nu); time: (n,) s, evenly spaced.
    """
    states = LinearSystem(system.A, system.B, np.eye(len(system.A)), np.zeros_like(system.B))
    steady = np.einsum("hij,hj->hi", frequency_response(states, omega), amplitude)
    turning = np.exp(1j * np.outer(time, omega))
    forced = (turning @ steady).real
    step = propagators(np.ascontiguousarray(system.A), np.zeros((0, *system.A.shape)), float(time[1] - time[0]))[0][0]
    free = np.empty_like(forced)
    free[0] = start - forced[0]
    for k in range(1, len(time)):
        free[k] = step @ free[k - 1]
    return (forced + free) @ system.C.T + (turning @ amplitude).real @ system.D.T
