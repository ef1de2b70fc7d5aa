"""The Pareto front of a task: NSGA-II finds it, gradients press it to its edge, neighbours fill it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.assess import Judge
from seatrial.control.press import free_box, pressed, whole
from seatrial.core.results.tuning import Front
from seatrial.core.values import Array, Index
from seatrial.numerics.optimise import non_dominated


@dataclass(frozen=True)
class Effort:
    """How much a front is worth: NSGA-II population and generations, points polished, rounds and size of filling in."""

    population: int = 200
    generations: int = 60
    polished: int = 48
    rounds: int = 6
    neighbours: int = 40_000


def front(judge: Judge, name: str, seed: int, tell: Callable[[str], None], effort: Effort) -> Front:
    """The feasible non-dominated gains found; empty where nothing is feasible (see `refuse_infeasible`)."""
    rng = np.random.default_rng(seed)
    explored = _explored(judge, seed, effort)
    tell(f"{name}: explored")
    count = len(explored)
    kept, values = _best(judge, explored)
    if len(kept):
        edge = np.array([pressed(judge, kept[i], values[i]) for i in spread(values, effort.polished)])
        kept, values = _best(judge, np.concatenate([kept, edge]))
        tell(f"{name}: polished")
        low, high = free_box(judge)[1]
        for size in np.geomspace(0.06, 0.004, effort.rounds):
            base = kept[rng.integers(len(kept), size=effort.neighbours)]
            step = size * (high - low) * rng.standard_normal(base.shape) * rng.random((len(base), 1))
            near = np.clip(base + step, low, high)
            kept, values = _best(judge, np.concatenate([kept, near]))
            count += len(near)
    gains = whole(judge, kept)
    return Front(name, judge.loop.gains.names, gains, values, judge.of(gains).peak, count)


def thinned(made: Front, count: int) -> Front:
    """At most `count` points of a front, far from one another, in the order of the first objective."""
    some = spread(made.objectives, count)
    some = some[np.argsort(made.objectives[some, 0])]
    return replace(made, gains=made.gains[some], objectives=made.objectives[some], peak=made.peak[some])


def _best(judge: Judge, free: Array) -> tuple[Array, Array]:
    """Feasible non-dominated ones among free gains, and their objectives."""
    made = judge.of(whole(judge, free))
    feasible = made.is_feasible
    points, values = free[feasible], made.objectives[feasible]
    if not len(points):
        return points, values
    first = non_dominated(values)
    return points[first], values[first]


def _explored(judge: Judge, seed: int, effort: Effort) -> Array:
    """Every point that NSGA-II (Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182-197) asked about, (n, f)."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize as search

    places, (low, high) = free_box(judge)
    seen: list[Array] = []

    class Asked(Problem):
        def _evaluate(self, x, out, *_args, **_named) -> None:
            seen.append(np.array(x))
            made = judge.of(whole(judge, x))
            out["F"] = np.where(np.isfinite(made.objectives), made.objectives, 1e30)
            out["G"] = np.where(np.isfinite(made.excess), made.excess, 1e30)

    problem = Asked(n_var=len(places), n_obj=len(judge.objectives), n_ieq_constr=3, xl=low, xu=high)
    search(problem, NSGA2(pop_size=effort.population), ("n_gen", effort.generations), seed=seed, verbose=False)
    return np.concatenate(seen)


def spread(values: Array, count: int) -> Index:
    """At most `count` points far from one another in the logarithm of the objectives, extremes first."""
    scaled = np.log(np.maximum(values, 1e-300))
    scaled = (scaled - scaled.min(axis=0)) / np.maximum(np.ptp(scaled, axis=0), 1e-12)
    chosen = list(dict.fromkeys(int(i) for i in np.argmin(scaled, axis=0)))
    distance = np.min([np.linalg.norm(scaled - scaled[i], axis=1) for i in chosen], axis=0)
    while len(chosen) < min(count, len(values)):
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(scaled - scaled[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)


def grid(judge: Judge, counts: tuple[int, ...]) -> Array:
    """Objectives of the feasible non-dominated points of a brute-force grid over the free gains, (n, m)."""
    _, (low, high) = free_box(judge)
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    best = np.empty((0, len(judge.objectives)))
    for slab in axes[0]:
        rest = np.stack([m.ravel() for m in np.meshgrid([slab], *axes[1:], indexing="ij")], axis=1)
        best = np.concatenate([best, _best(judge, rest)[1]])
    return best[non_dominated(best)] if len(best) else best
