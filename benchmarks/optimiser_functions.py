"""The functions all optimisers are given, in plain NumPy: the peers' Python imports them too."""

import numpy as np

POPULATION, ITERATIONS, RUNS = 40, 200, 15
LEAST = np.array([2.0, -1.0, 3.0, 1.0, 0.5, 4.0, -2.0, 1.3])
LOWER, UPPER = np.full(8, -3.0), np.array([7.0, 7.0, 8.0, 7.0, 5.0, 7.0, 9.0, 7.0])
ROTATION = np.linalg.qr(np.random.default_rng(3).normal(size=(8, 8)))[0]
PSO = {"w": 0.7298, "c1": 1.49618, "c2": 1.49618}


def sphere(points: np.ndarray) -> np.ndarray:
    """Sum of squares; minimum 0."""
    return np.sum(_turned(points) ** 2, axis=1)


def rosenbrock(points: np.ndarray) -> np.ndarray:
    """A bent valley; minimum 0."""
    z = _turned(points) + 1
    return np.sum(100 * (z[:, 1:] - z[:, :-1] ** 2) ** 2 + (1 - z[:, :-1]) ** 2, axis=1)


def rastrigin(points: np.ndarray) -> np.ndarray:
    """A bowl full of dents; minimum 0."""
    y = _turned(points)
    return np.sum(y**2 - 10 * np.cos(2 * np.pi * y) + 10, axis=1)


def _turned(points: np.ndarray) -> np.ndarray:
    return (points - LEAST) @ ROTATION


FUNCTIONS = {"sphere": sphere, "rosenbrock": rosenbrock, "rastrigin": rastrigin}
