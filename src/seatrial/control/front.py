"""The Pareto front of a task: NSGA-II finds it, gradients press it to its edge, neighbours fill it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds, refine_gains
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array, Index
from seatrial.numerics.optimise import non_dominated


@dataclass(frozen=True)
class Effort:
    """Effort spent on a front: NSGA-II, refinement by gradients, filling in by random neighbours."""

    population: int = 200  # of NSGA-II; chosen
    generations: int = 60  # of NSGA-II; chosen
    refined: int = 48  # points refined by gradients; chosen
    fill_rounds: int = 6  # rounds of random neighbours; chosen
    neighbours: int = 40_000  # random neighbours a round; chosen


def pareto_front(
    evaluator: GainEvaluator, name: str, seed: int, report_progress: Callable[[str], None], effort: Effort
) -> ParetoFront:
    """Return the feasible non-dominated gains found; empty where nothing is feasible (see `refuse_infeasible`)."""
    rng = np.random.default_rng(seed)
    explored = _explore(evaluator, seed, effort)
    report_progress(f"{name}: explored")
    count = len(explored)
    kept, values = _feasible_non_dominated(evaluator, explored)
    if len(kept):
        edge = np.array([refine_gains(evaluator, kept[i], values[i]) for i in spread_points(values, effort.refined)])
        kept, values = _feasible_non_dominated(evaluator, np.concatenate([kept, edge]))
        report_progress(f"{name}: polished")
        low, high = free_gain_bounds(evaluator)[1]
        # steps from 6 % down to 0.4 % of each gain's range; chosen
        for size in np.geomspace(0.06, 0.004, effort.fill_rounds):
            base = kept[rng.integers(len(kept), size=effort.neighbours)]
            step = size * (high - low) * rng.standard_normal(base.shape) * rng.random((len(base), 1))
            near = np.clip(base + step, low, high)
            kept, values = _feasible_non_dominated(evaluator, np.concatenate([kept, near]))
            count += len(near)
    gains = all_gains(evaluator, kept)
    return ParetoFront(name, evaluator.loop.gains.names, gains, values, evaluator.evaluate(gains).Ms, count)


def thin_front(full_front: ParetoFront, count: int) -> ParetoFront:
    """At most `count` points of a front, far from one another, in the order of the first objective."""
    some = spread_points(full_front.objectives, count)
    some = some[np.argsort(full_front.objectives[some, 0])]
    return replace(
        full_front, gains=full_front.gains[some], objectives=full_front.objectives[some], Ms=full_front.Ms[some]
    )


def _feasible_non_dominated(evaluator: GainEvaluator, free: Array) -> tuple[Array, Array]:
    """Feasible non-dominated ones among free gains, and their objectives."""
    made = evaluator.evaluate(all_gains(evaluator, free))
    feasible = made.is_feasible
    points, values = free[feasible], made.objectives[feasible]
    if not len(points):
        return points, values
    first = non_dominated(values)
    return points[first], values[first]


def _explore(evaluator: GainEvaluator, seed: int, effort: Effort) -> Array:
    """Every point that NSGA-II (Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182-197) asked about, (n, f)."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize as search

    places, (low, high) = free_gain_bounds(evaluator)
    seen: list[Array] = []

    class Asked(Problem):
        def _evaluate(self, x, out, *_args, **_named) -> None:
            seen.append(np.array(x))
            made = evaluator.evaluate(all_gains(evaluator, x))
            out["F"] = np.where(np.isfinite(made.objectives), made.objectives, 1e30)
            out["G"] = np.where(np.isfinite(made.excess), made.excess, 1e30)

    problem = Asked(n_var=len(places), n_obj=len(evaluator.objectives), n_ieq_constr=3, xl=low, xu=high)
    search(problem, NSGA2(pop_size=effort.population), ("n_gen", effort.generations), seed=seed, verbose=False)
    return np.concatenate(seen)


def spread_points(values: Array, count: int) -> Index:
    """At most `count` points far from one another in the logarithm of the objectives, extremes first."""
    scaled = np.log(np.maximum(values, 1e-300))
    scaled = (scaled - scaled.min(axis=0)) / np.maximum(np.ptp(scaled, axis=0), 1e-12)
    chosen = list(dict.fromkeys(int(i) for i in np.argmin(scaled, axis=0)))
    distance = np.min([np.linalg.norm(scaled - scaled[i], axis=1) for i in chosen], axis=0)
    while len(chosen) < min(count, len(values)):
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(scaled - scaled[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)


def grid_front(evaluator: GainEvaluator, counts: tuple[int, ...]) -> Array:
    """Objectives of the feasible non-dominated points of a brute-force grid over the free gains, (n, m)."""
    _, (low, high) = free_gain_bounds(evaluator)
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    best = np.empty((0, len(evaluator.objectives)))
    for slab in axes[0]:
        rest = np.stack([m.ravel() for m in np.meshgrid([slab], *axes[1:], indexing="ij")], axis=1)
        best = np.concatenate([best, _feasible_non_dominated(evaluator, rest)[1]])
    return best[non_dominated(best)] if len(best) else best
