"""Linear systems with known coefficients, and a craft in zigzags without noise."""

from functools import cache

import numpy as np

from seatrial.core.values import Record
from seatrial.data.example_series import simulate_run, true_model
from seatrial.estimation.regress.estimators import RegressionSystem

COEFFICIENTS = np.array([2.0, -0.5, 1500.0])


def random_system(seed: int, noise: float = 0.0, rows: int = 400) -> RegressionSystem:
    """Three columns of very different size, target in units of its own."""
    generator = np.random.default_rng(seed)
    matrix = generator.standard_normal((rows, 3)) * [1.0, 10.0, 1e-3]
    target = matrix @ COEFFICIENTS + noise * generator.standard_normal(rows)
    return RegressionSystem(("u",), ("a", "b", "c"), matrix, target)


@cache
def zigzags() -> Record:
    """Consecutive zigzags of the craft, one execute of each angle, 10 Hz."""
    return simulate_run(true_model(), "consecutive-zigzags:1")
