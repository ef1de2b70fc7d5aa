"""How far coefficients can be taken for one another: condition, variance inflation, correlation."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.results import Collinearity
from seatrial.core.values import Array


def condition_number(information: Array) -> float:
    """Condition number of the information scaled to unit diagonal; infinite where a direction is missing."""
    values = np.linalg.eigvalsh(_unit_diagonal(information))
    return float(values[-1] / values[0]) if values[0] > 1e-15 * values[-1] else np.inf  # rounding of double precision


def collinearity(information: Array, names: Sequence[str]) -> tuple[Collinearity, ...]:
    """Variance inflation factor of each coefficient, H_jj (H^-1)_jj, and the coefficient most correlated with it.

    Marquardt 1970, Technometrics 12, 591.
    """
    unit = _unit_diagonal(information)
    values, vectors = np.linalg.eigh(unit)
    covariance = (vectors / np.maximum(values, 1e-14 * values[-1])) @ vectors.T  # rounding of double precision; chosen
    factors = np.diag(covariance)
    correlation = covariance / np.sqrt(np.outer(factors, factors))
    np.fill_diagonal(correlation, 0.0)
    partners = np.argmax(np.abs(correlation), axis=1)
    if len(names) < 2:
        return ()
    return tuple(
        Collinearity(name, float(factors[j]), names[int(partners[j])], float(correlation[j, partners[j]]))
        for j, name in enumerate(names)
    )


def _unit_diagonal(information: Array) -> Array:
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), 1e-300))  # above zero, for a division
    return information * scale[:, None] * scale[None, :]
