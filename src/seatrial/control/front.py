"""The Pareto front of a task: NSGA-II finds it, gradients press it to its edge, neighbours fill it."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds, refine_gains
from seatrial.core.results.tuning import Controller, ParetoFront
from seatrial.core.values import Array, Index, InputError
from seatrial.numerics.optimise import non_dominated

_SPREADS = 0.06, 0.004  # of random neighbours in the first and last round, as shares of each gain's range; chosen
_INFEASIBLE = 1e30  # in the place of infinity, which NSGA-II does not take
# least objective whose logarithm is taken, and range that counts as one: guards against zero
_LEAST_OBJECTIVE, _LEAST_RANGE = 1e-300, 1e-12


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
    report_progress(f"front of {name}: explored")
    count = len(explored)
    kept, values = _feasible_non_dominated(evaluator, explored)
    if len(kept):
        edge = np.array([refine_gains(evaluator, kept[i], values[i]) for i in spread_points(values, effort.refined)])
        kept, values = _feasible_non_dominated(evaluator, np.concatenate([kept, edge]))
        report_progress(f"front of {name}: refined")
        low, high = free_gain_bounds(evaluator)[1]
        for size in np.geomspace(*_SPREADS, effort.fill_rounds):
            base = kept[rng.integers(len(kept), size=effort.neighbours)]
            step = size * (high - low) * rng.standard_normal(base.shape) * rng.random((len(base), 1))
            near = np.clip(base + step, low, high)
            kept, values = _feasible_non_dominated(evaluator, np.concatenate([kept, near]))
            count += len(near)
    gains = all_gains(evaluator, kept)
    return ParetoFront(name, evaluator.loop.gains.names, gains, values, evaluator.evaluate(gains).Ms, count)


def thin_front(full_front: ParetoFront, count: int) -> ParetoFront:
    """Return at most `count` points of a front, far from one another, in the order of the first objective."""
    front, some = full_front, spread_points(full_front.objectives, count)
    some = some[np.argsort(front.objectives[some, 0])]
    return replace(front, gains=front.gains[some], objectives=front.objectives[some], Ms=front.Ms[some])


def _feasible_non_dominated(evaluator: GainEvaluator, free: Array) -> tuple[Array, Array]:
    """Return feasible non-dominated ones among free gains, and their objectives."""
    made = evaluator.evaluate(all_gains(evaluator, free))
    feasible = made.is_feasible
    points, values = free[feasible], made.objectives[feasible]
    if not len(points):
        return points, values
    first = non_dominated(values)
    return points[first], values[first]


def _explore(evaluator: GainEvaluator, seed: int, effort: Effort) -> Array:
    """Return every point that NSGA-II (Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182-197) asked about, (n, f)."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize as search

    places, (low, high) = free_gain_bounds(evaluator)
    visited: list[Array] = []

    class GainProblem(Problem):
        def _evaluate(self, x, out, *_args, **_named) -> None:
            visited.append(np.array(x))
            made = evaluator.evaluate(all_gains(evaluator, x))
            out["F"] = np.where(np.isfinite(made.objectives), made.objectives, _INFEASIBLE)
            out["G"] = np.where(np.isfinite(made.excess), made.excess, _INFEASIBLE)

    problem = GainProblem(n_var=len(places), n_obj=len(evaluator.objectives), n_ieq_constr=3, xl=low, xu=high)
    search(problem, NSGA2(pop_size=effort.population), ("n_gen", effort.generations), seed=seed, verbose=False)
    return np.concatenate(visited)


def spread_points(values: Array, count: int) -> Index:
    """Return at most `count` points far from one another in the logarithm of the objectives, extremes first."""
    scaled = np.log(np.maximum(values, _LEAST_OBJECTIVE))
    scaled = (scaled - scaled.min(axis=0)) / np.maximum(np.ptp(scaled, axis=0), _LEAST_RANGE)
    chosen = list(dict.fromkeys(int(i) for i in np.argmin(scaled, axis=0)))

    def squared_distances(i: int) -> Array:
        gap = scaled - scaled[i]
        return np.einsum("ij,ij->i", gap, gap)

    least = np.min([squared_distances(i) for i in chosen], axis=0)
    while len(chosen) < min(count, len(values)):
        chosen.append(int(np.argmax(least)))
        least = np.minimum(least, squared_distances(chosen[-1]))
    return np.array(chosen, dtype=np.int64)


def grid_front(evaluator: GainEvaluator, counts: tuple[int, ...]) -> Array:
    """Return objectives of the feasible non-dominated points of a brute-force grid over the free gains, (n, m)."""
    _, (low, high) = free_gain_bounds(evaluator)
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    best = np.empty((0, len(evaluator.objectives)))
    for slab in axes[0]:
        rest = np.stack([m.ravel() for m in np.meshgrid([slab], *axes[1:], indexing="ij")], axis=1)
        best = np.concatenate([best, _feasible_non_dominated(evaluator, rest)[1]])
    return best[non_dominated(best)] if len(best) else best


_SAMPLES, _ROUNDS = 20_000, 8  # random gains in all, in rounds of shrinking size; chosen
_LAST_SIZE = 0.003  # of the random steps in the last round, as a share of each gain's range; chosen
_IDLE = (
    "the best that was found is no control at all, with every gain at zero: raise limits.Ms, limits.saturation or "
    "the actuator's own limits where they leave nothing else, and name the motion first under minimise"
)


def refuse_idle(chosen: Controller) -> None:
    """Refuse an answer that does nothing."""
    if not chosen.rms["actuator"] > 0.0:
        raise InputError(_IDLE)


def refuse_infeasible(evaluator: GainEvaluator, seed: int) -> None:
    """Say why a front is empty: restrictions that no gains within the bounds keep, or hardly any."""
    rng = np.random.default_rng(seed)
    _, (low, high) = free_gain_bounds(evaluator)
    best, least = low, math.inf
    for size in np.geomspace(1.0, _LAST_SIZE, _ROUNDS):
        steps = rng.uniform(-size, size, (_SAMPLES // _ROUNDS, len(low))) * (high - low)
        tried = np.clip((0.5 * (low + high) if size == 1.0 else best) + steps, low, high)
        excess = evaluator.evaluate(all_gains(evaluator, tried)).excess.max(axis=1)
        place = int(np.argmin(excess))
        if excess[place] < least:
            best, least = tried[place], float(excess[place])
    nearest = all_gains(evaluator, best[None])
    made = evaluator.evaluate(nearest)
    where = ", ".join(f"{n} = {v:.4g}" for n, v in zip(evaluator.loop.gains.names, nearest[0], strict=True))
    if least <= 0.0 and not made.variances[0, :, 1].any():
        raise InputError(_IDLE)
    if least <= 0.0:
        raise InputError(f"the search met no gains that keep all limits, though {where} do: narrow the bounds of the "
                         "gains about them")  # fmt: skip
    if not math.isfinite(made.Ms[0]):
        raise InputError("no gains within their bounds make the loop stable; check signs, or widen the bounds")
    limits = evaluator.task.constraints
    names = (f"Ms of {limits.Ms:g}", "actuator saturation", "actuator rate saturation")
    roots = np.array([made.excess[0, 0], *(np.sqrt(1.0 + made.excess[0, 1:]) - 1.0)])
    said = [f"{name} by {100.0 * over:.3g} %" for name, over in zip(names, roots, strict=True) if over > 0.0]
    raise InputError(
        f"no gains within their bounds keep all limits: the nearest ({where}) exceed {' and '.join(said)}; "
        "raise that limit, or widen the bounds of the gains"
    )
