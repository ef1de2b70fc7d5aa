"""Frequency response of an affine model with its exact derivatives by the free parameters."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.numerics.kernels.linear import affine_matrices
from seatrial.physics.simulate.harmonics import Complex


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """H = (i omega - A)^-1 B of some states, (n, ny, nu), and dH, (q, n, ny, nu), signed omega, exp(+i omega t)."""

    H: Complex
    dH: Complex


def frequency_response(
    model: Model, values: Array, omega: Array, outputs: tuple[str, ...], free: tuple[str, ...]
) -> FrequencyResponse:
    """The response of states `outputs` at all parameter values (np,), differentiated by those named `free`.

    dH = R dA H + R dB with the resolvent R = (i omega - A)^-1.
    """
    nx, nu = len(model.states), len(model.inputs)
    wanted = np.array([model.parameters.index(n) for n in free], dtype=np.int64)
    rates, slopes = affine_matrices(model.compiled.rates_tangent, nx, nx, nu, wanted, values)
    resolvent = np.linalg.inv(1j * omega[:, None, None] * np.eye(nx) - rates[:, :nx])
    H = resolvent @ rates[:, nx:-1]
    driven = slopes[:, None, :, :nx] @ H[None] + slopes[:, None, :, nx:-1]
    rows = [model.states.index(o) for o in outputs]
    return FrequencyResponse(H[:, rows], (resolvent[None] @ driven)[:, :, rows])
