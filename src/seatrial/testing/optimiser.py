"""The protocol of ask and tell, checked on a sphere."""

from collections.abc import Callable

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, Optimiser, Status
from seatrial.testing.conformance import require, require_refusal

OptimiserFactory = Callable[[Box, np.random.Generator], Optimiser]

# a box of unequal sides off the origin, dimensionless; the minimum lies at 0.3 of each side
_BOX = Box(np.array([-1.0, 10.0, 0.0]), np.array([3.0, 11.0, 0.02]))
_MINIMUM = _BOX.scaled(np.full(3, 0.3))  # dimensionless; chosen, off the middle
_MOST_EVALUATIONS = 200_000  # dimensionless; ours, far beyond what a sphere of three unknowns needs
_LEAST_IMPROVEMENT = 0.1  # final over first best fitness; chosen: a random search of 2000 points does better
_ROUNDING = 1e-12  # relative; fitness evaluated in another order


def check_optimiser(create: OptimiserFactory, seed: int = 0) -> None:
    """Check an optimiser: points in the box, order of ask and tell, refusals, history, same seed same bits.

    Args:
        create: makes an optimiser from a box and a generator, as the entry points of ``seatrial.optimisers`` do.
        seed: of the generators.

    Raises:
        ConformanceError: the first violation.
    """
    _check_refusals(create(_BOX, np.random.default_rng(seed)))
    _check_infinite_fitness(create(_BOX, np.random.default_rng(seed)))
    global_state = _global_generator()
    first = _minimised(create(_BOX, np.random.default_rng(seed)))
    again = _minimised(create(_BOX, np.random.default_rng(seed)))
    require(first.trace.tobytes() == again.trace.tobytes(), "the same seed gives other points; draw from the generator")
    require(_global_generator() == global_state, "NumPy's global generator is used; draw from the one that is passed")
    require(
        first.best[1] <= _LEAST_IMPROVEMENT * first.history[0],
        f"a sphere is not minimised: the best fitness falls from {first.history[0]:g} to {first.best[1]:g}",
    )


def _global_generator() -> bytes:
    """Return the state of NumPy's global generator."""
    return np.random.get_state(legacy=False)["state"]["key"].tobytes()  # noqa: NPY002


def sphere(points: Array) -> Array:
    """Return the squared distance of points (n, d) from the minimum, in sides of the box, shape (n,)."""
    return np.sum(((points - _MINIMUM) / _BOX.width) ** 2, axis=1)


def _points(optimiser: Optimiser) -> Array:
    """Return the points of one ask after checking them, shape (n, d)."""
    points = optimiser.ask()
    shape = np.shape(points)
    require(len(shape) == 2 and shape[1] == _BOX.size and shape[0] > 0, f"ask() returns shape {shape}, not (n, d)")
    inside = np.all((points >= _BOX.lower) & (points <= _BOX.upper))
    require(bool(inside), "ask() returns a point outside the box (or NaN); clip it")
    kept = points.copy()
    points[:] = np.nan
    require(
        np.array_equal(optimiser.ask(), kept), "ask() before tell() returns other points; return a copy of the same"
    )
    return kept


def _minimised(optimiser: Optimiser) -> Optimiser:
    """Return the optimiser after it has minimised the sphere, every step checked."""
    evaluations, calls = 0, 0
    while not optimiser.done:
        points = _points(optimiser)
        optimiser.tell(sphere(points))
        evaluations, calls = evaluations + len(points), calls + 1
        point, value = optimiser.best
        require(len(optimiser.history) == calls, f"history has {len(optimiser.history)} entries after {calls} tell()")
        agrees = abs(float(sphere(point[None])[0]) - value) <= _ROUNDING * max(1.0, abs(value))
        require(agrees, f"best claims the fitness {value:g} for a point of fitness {float(sphere(point[None])[0]):g}")
        require(evaluations < _MOST_EVALUATIONS, f"done is still false after {evaluations} evaluations of a sphere")
    shape = optimiser.trace.shape
    require(shape == (calls, _BOX.size), f"trace has shape {shape} after {calls} tell(), not (iterations, d)")
    require(bool(np.all(np.diff(optimiser.history) <= 0.0)), "history rises; it is the best fitness so far")
    require(isinstance(optimiser.status, Status), f"status is {optimiser.status!r}, not a member of Status")
    require(optimiser.seed is None or isinstance(optimiser.seed, int), "seed is neither None nor one whole number")
    return optimiser


def _check_refusals(optimiser: Optimiser) -> None:
    """Check that a fitness that cannot be one is refused, and that refusing changes nothing."""
    count = len(_points(optimiser))
    require_refusal(lambda: optimiser.tell(np.zeros(count + 1)), ValueError, "a fitness of another length")
    require_refusal(lambda: optimiser.tell(np.full(count, np.nan)), ValueError, "a fitness that is NaN")
    require(len(optimiser.history) == 0, "a refused fitness is counted in history")
    optimiser.tell(sphere(_points(optimiser)))


def _check_infinite_fitness(optimiser: Optimiser) -> None:
    """Check that points where the model cannot be evaluated (infinite fitness) are survived."""
    for _ in range(3):
        if not optimiser.done:
            optimiser.tell(np.full(len(_points(optimiser)), np.inf))
    if not optimiser.done:
        optimiser.tell(sphere(_points(optimiser)))
        require(bool(np.isfinite(optimiser.best[1])), "a finite fitness after infinite ones is not taken as the best")
