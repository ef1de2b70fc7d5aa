"""What a recursive filter begins with and what it knows: coefficients, the present state, and how these are tied."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from seatrial.core.values import Array, InputError


@dataclass(frozen=True, eq=False)
class GaussianState:
    """Gaussian: coefficients theta ~ N(value, covariance), state ~ N(state + sensitivity (theta - value),
    state_covariance).

    Attributes:
        value (k,), covariance (k, k): of the coefficients; state (nx,): at the present sample.
        sensitivity: (nx, k), change of the present state with the coefficients, given all that was measured.
        state_covariance: (nx, nx), covariance of the state were the coefficients known.
    """

    value: Array
    covariance: Array
    state: Array
    sensitivity: Array
    state_covariance: Array

    def __post_init__(self) -> None:
        k, nx = len(self.value), len(self.state)
        shapes = {"covariance": (k, k), "sensitivity": (nx, k), "state_covariance": (nx, nx)}
        for name, shape in {"value": (k,), "state": (nx,), **shapes}.items():
            made = np.shape(getattr(self, name))
            if made != shape or not np.all(np.isfinite(getattr(self, name))):
                raise InputError(f"the filter's first {name} must be {shape} finite numbers, its shape is {made}")

    def joint_root(self) -> Array:
        """R, (k + nx, k + nx), lower block triangular, R R' the covariance of [theta | state].

        Raises:
            InputError: a covariance is not positive (semi-definite).
        """
        k = len(self.value)
        made = np.zeros((k + len(self.state),) * 2)
        made[:k, :k] = covariance_root(self.covariance, "the coefficients' covariance")
        made[k:, :k] = self.sensitivity @ made[:k, :k]
        made[k:, k:] = covariance_root(self.state_covariance, "the state's covariance")
        return made

    def at_run_start(self, state: Array, state_covariance: Array) -> Self:
        """The same coefficients where a run begins: its state knows nothing of them."""
        return replace(
            self, state=state, sensitivity=np.zeros((len(state), len(self.value))), state_covariance=state_covariance
        )


def covariance_root(covariance: Array, name: str) -> Array:
    """A square root of a covariance that may be singular, scaled by its own deviations first.

    Raises:
        InputError: it is not positive semi-definite.
    """
    deviation = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    scale = np.where(deviation > 0.0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    if values[0] < -1e-8 * max(values[-1], 1.0):  # rounding of a covariance; chosen
        raise InputError(f"{name} is not positive; give one that comes from a fit")
    return scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
