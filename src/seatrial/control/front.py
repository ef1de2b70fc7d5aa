"""The Pareto front of a task, and the published genetic algorithm compared with it."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import Enum
from functools import cached_property, lru_cache

import numpy as np

from seatrial.control.gain_evaluation import (
    ACTUATOR_RATE,
    GainChoice,
    GainEvaluation,
    GainEvaluator,
    all_gains,
    free_gain_bounds,
    least_output_gains,
    refine_gains,
    spread_gains,
)
from seatrial.control.task import GeneticTuning, SearchedObjectives
from seatrial.core.results.tuning import Controller, GainSearch, ParetoFront
from seatrial.core.values import Array, Index, InputError
from seatrial.numerics.optimise import (
    Box,
    GeneticSettings,
    NonDominatedSet,
    RandomWeightGenetic,
    SearchError,
    hypervolume,
    non_dominated,
)
from seatrial.physics.loops import LoopSignal, Objective, squared_deviation, variance

# The gains that leave least of the motion at a rate of the actuator: optima, not points where a search met its front.

RATES = 16  # rates of the actuator at which gains are sought; chosen
_BEST_SAMPLES = 3  # of spread gains, looked at where optima are followed; chosen
_KEPT_CURVES = 4  # in memory, for the front and the choice from it; chosen


@dataclass(frozen=True, eq=False)
class RateCurve:
    """Optima of a loop over the rms rate of the actuator in the worst disturbance.

    Attributes:
        samples: gains to begin from, (n, g).
        levels: rates [rad/s] up to that of the least motion within the task's restrictions, from that of the least rate
            where a demand is followed; `optima`: gains (g,) by their rate, first of the ends.
    """

    evaluator: GainEvaluator
    samples: Array
    levels: Array
    optima: dict[float, Array]

    @cached_property
    def _judged(self) -> GainEvaluation:
        """The samples judged, within the task's restrictions."""
        return self.evaluator.evaluate(self.samples)

    def gains_at(self, levels: Array) -> Array:
        """Return gains of least motion at each level, followed from those at the nearest rates, (n, g).

        The fastest first: an integral that begins to help at a rate is at zero below it, and is not met from there.
        """
        for level in np.flip(levels).tolist():
            if level not in self.optima:
                self.optima[level] = self._gains_at(level)
        return np.array([self.optima[level] for level in levels.tolist()]).reshape(-1, self.samples.shape[1])

    def _gains_at(self, level: float) -> Array:
        # the share exp(-1/2) of a Rayleigh distribution lies beyond its rms, so that the variance allowed is the level
        within = replace(self.evaluator.task.constraints, rate=level, rate_saturation=math.exp(-0.5))
        slower, faster = ([rate for rate in self.optima if sign * rate < sign * level] for sign in (1.0, -1.0))
        near = [max(slower), min(faster)] if slower and faster else []
        return least_output_gains(
            self.evaluator.within(within), self._samples_within(level), [self.optima[rate] for rate in near]
        )

    def _samples_within(self, level: float) -> Array:
        """Return the samples that keep the task's restrictions at a rate, the best few; all where none does."""
        kept = self._judged.is_feasible & (self._judged.variances[:, :, 2].max(axis=1) <= level**2)
        order = np.argsort(np.where(kept, self._judged.objectives[:, 0], np.inf))
        return self.samples[order[: min(int(kept.sum()), _BEST_SAMPLES)]] if kept.any() else self.samples


@lru_cache(maxsize=_KEPT_CURVES)
def rate_curve(judge: GainEvaluator, seed: int) -> RateCurve:
    """Return the optima of a loop over the rate: in decades of it where a demand is followed, as that needs some.

    Without a level where no gains keep the restrictions.
    """
    task = judge.task
    evaluator, samples = replace(judge, objectives=(task.motion,)), spread_gains(judge, seed)
    ends = [least_output_gains(evaluator, samples)]
    if task.demand is not None:
        ends.insert(0, least_output_gains(replace(evaluator, objectives=(ACTUATOR_RATE,)), samples))
    judged = judge.evaluate(np.array(ends))
    if not judged.is_feasible.all():
        return RateCurve(evaluator, np.vstack([samples, ends]), np.empty(0), {})
    rates = np.sqrt(judged.variances[:, :, 2].max(axis=1))
    shares = np.arange(1, RATES + 1) / RATES
    levels = rates[-1] * shares if task.demand is None else np.geomspace(rates[0], rates[-1], RATES)
    at_ends = dict(zip(rates.tolist(), ends, strict=True))
    return RateCurve(evaluator, np.vstack([samples, ends]), levels, at_ends)


# The Pareto front of a task: optima along the rate and spread gains begin it, gradients press it to its edge,
# neighbours fill it.

_SPREADS = 0.06, 0.004  # of random neighbours in the first and last round, as shares of each gain's range; chosen
# least objective whose logarithm is taken, and range that counts as one: guards against zero
_LEAST_OBJECTIVE, _LEAST_RANGE = 1e-300, 1e-12


@dataclass(frozen=True)
class Effort:
    """Effort spent on a front: refinement by gradients, filling in by random neighbours."""

    refined: int = 48  # points refined by gradients; chosen
    fill_rounds: int = 6  # rounds of random neighbours; chosen
    neighbours: int = 10_000  # random neighbours a round; chosen


def pareto_front(
    evaluator: GainEvaluator, name: str, seed: int, report_progress: Callable[[str], None], effort: Effort
) -> ParetoFront:
    """Return the feasible non-dominated gains found; empty where nothing is feasible (see `refuse_infeasible`)."""
    rng, curve = np.random.default_rng(seed), rate_curve(evaluator, seed)
    optima = curve.gains_at(curve.levels)
    explored = np.vstack([curve.samples, *optima])[:, free_gain_bounds(evaluator)[0]]
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


# The published search for gains (Yu et al. 2014, section 3) on a task: a genetic algorithm with random weights.

SOURCE = "Yu et al. 2014, CAAI Transactions on Intelligent Systems 9(4), section 3"


@dataclass(frozen=True, eq=False)
class GeneticRun:
    """One search.

    Attributes:
        gains: free gains of the answer (f,); J: its mean of normalised objectives, infinite where nothing was stable.
        history: J after each generation.
        front: points that no evaluated one beats in the objectives searched.
        cpu_s: CPU time with the front.
    """

    gains: Array
    J: float
    history: tuple[float, ...]
    front: NonDominatedSet
    evaluations: int
    cpu_s: float


def genetic_run(
    objective_values: Callable[[Array], Array], box: Box, settings: GeneticSettings, generator: np.random.Generator
) -> GeneticRun:
    """Run one search; `objective_values` takes gains (n, f) and gives objectives (n, m), infinite where unstable."""
    began = time.process_time()
    search, evaluations = RandomWeightGenetic(box, generator, settings), 0
    while not search.done:
        points = search.ask()
        search.tell(objective_values(points))
        evaluations += len(points)
    front = search.front
    gains, J = search.best
    return GeneticRun(gains, J, search.history, front, evaluations, time.process_time() - began)


def genetic_runs(evaluator: GainEvaluator, settings: GeneticTuning, seed: int) -> tuple[GeneticRun, ...]:
    """Run one search for each of the settings' seeds over the free gains of the evaluator's loop.

    Raises:
        InputError: the print's second objective needs a limit of the actuator, too few individuals, or no search met
            a stable loop.
    """
    searched = replace(evaluator, objectives=searched_objectives(evaluator, settings))
    box = Box(*free_gain_bounds(evaluator)[1])
    try:
        algorithm = settings.algorithm_settings(len(searched.objectives))
    except SearchError as error:
        raise InputError(f"genetic: {error}") from None

    def objective_values(free: Array) -> Array:
        return searched.objective_values(all_gains(evaluator, free))

    runs = tuple(
        genetic_run(objective_values, box, algorithm, np.random.default_rng([seed, k])) for k in range(settings.seeds)
    )
    unstable = [k for k, run in enumerate(runs) if not np.isfinite(run.J)]
    if unstable:
        raise InputError(
            f"genetic: search {unstable[0] + 1} of {len(runs)} met no stable loop in {runs[0].evaluations} "
            "controllers; narrow the bounds of the gains, or give it more generations"
        )
    return runs


def searched_objectives(evaluator: GainEvaluator, settings: GeneticTuning) -> tuple[Objective, ...]:
    """Return what the settings say is to be made small.

    Raises:
        InputError: as printed, where the actuator has no limit.
    """
    if settings.objectives is SearchedObjectives.OWN:
        return evaluator.objectives
    target = float(evaluator.allowed_variances[0])
    if not np.isfinite(target):
        raise InputError(
            "genetic: the published objective of the actuator needs its limit; give [actuator] limit, or "
            'set objectives = "minimise" in [genetic]'
        )
    one_sided = settings.objectives is SearchedObjectives.ONE_SIDED
    return (
        variance("J1", "rad^2", LoopSignal.OUTPUT),
        squared_deviation("J2", LoopSignal.ACTUATOR, target, one_sided=one_sided),
        variance("J3", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
    )


# The published genetic algorithm compared with the package's own front: answer as a choice, cost and scatter.

FRONT_NAME = "the genetic algorithm"
OWN_CHOICE = "own front"


@dataclass(frozen=True, eq=False)
class PublishedSearch:
    """The answer as a choice of gains, the search in numbers, and what it saw of the front."""

    choice: GainChoice
    result: GainSearch
    front: ParetoFront


def published_search(
    evaluator: GainEvaluator, settings: GeneticTuning, package_front: ParetoFront, seed: int
) -> PublishedSearch:
    """Run the published search on the loop of `evaluator` and compare it with the package's front of that loop.

    Raises:
        InputError: as `genetic_runs`.
    """
    runs = genetic_runs(evaluator, settings, seed)
    answers = all_gains(evaluator, np.stack([run.gains for run in runs]))
    front = _searched_front(evaluator, runs[0])
    result = _search_result(evaluator, settings, runs, answers, package_front, front)
    choice = GainChoice(evaluator, answers[0], FRONT_NAME, _reasons(result))
    return PublishedSearch(choice, result, front)


def _search_result(
    evaluator: GainEvaluator,
    settings: GeneticTuning,
    runs: tuple[GeneticRun, ...],
    answers: Array,
    package_front: ParetoFront,
    front: ParetoFront,
) -> GainSearch:
    judged, (low, high) = evaluator.evaluate(answers), free_gain_bounds(evaluator)[1]
    beaten = (package_front.objectives[:, None] < judged.objectives).all(axis=2).any(axis=0)
    return GainSearch(
        source=SOURCE,
        settings={field.name: _setting_text(getattr(settings, field.name)) for field in fields(settings)},
        objectives={one.name: one.unit for one in searched_objectives(evaluator, settings)},
        evaluations=runs[0].evaluations,
        cpu_s=float(np.median([run.cpu_s for run in runs])),
        histories=np.array([run.history for run in runs]),
        gain_names=evaluator.loop.gains.free_names,
        gains=np.stack([run.gains for run in runs]),
        lower=low,
        upper=high,
        spread=np.ptp([run.gains for run in runs], axis=0) / (high - low),
        values=judged.objectives,
        Ms=judged.Ms,
        is_feasible=tuple(judged.is_feasible.tolist()),
        dominated=int(beaten.sum()),
        hypervolume=_covered_share(front.objectives, package_front.objectives),
    )


def _searched_front(evaluator: GainEvaluator, run: GeneticRun) -> ParetoFront:
    """Return what one search saw of the front in the task's objectives, restrictions kept."""
    seen = all_gains(evaluator, run.front.points)
    judged = evaluator.evaluate(seen)
    feasible = np.flatnonzero(judged.is_feasible)
    rows = feasible[non_dominated(judged.objectives[feasible])]
    return ParetoFront(
        FRONT_NAME, evaluator.loop.gains.names, seen[rows], judged.objectives[rows], judged.Ms[rows], run.evaluations,
        cpu_s=run.cpu_s,
    )  # fmt: skip


def _covered_share(objectives: Array, reference: Array) -> float:
    """Return hypervolume of objectives (k, m) over that of a reference front (n, m), both up to the latter's nadir."""
    live = np.ptp(reference, axis=0) > 0.0
    if not live.any():
        return float("nan")
    nadir = reference[:, live].max(axis=0)
    within = objectives[:, live][(objectives[:, live] < nadir).all(axis=1)]
    return hypervolume(within, nadir) / hypervolume(reference[:, live], nadir) if len(within) else 0.0


def _setting_text(value: object) -> str:
    return str(value.value if isinstance(value, Enum) else value)


def _reasons(result: GainSearch) -> tuple[str, ...]:
    seeds, spread = len(result.gains), ", ".join(f"{100.0 * share:.0f}" for share in result.spread)
    return (
        "It is the answer of the genetic algorithm of Yu et al. 2014: the fittest of the last generation under equal "
        f"weights of {', '.join(result.objectives)}. The search knows no restriction but stability.",
        f"Over {seeds} seeds its answers spread over {spread} % of the ranges of {', '.join(result.gain_names)}, Ms "
        f"{result.Ms.min():.3g} to {result.Ms.max():.3g}; {result.feasible_count} of {seeds} keep the limits, "
        f"{result.dominated} are beaten in every objective by a controller of the package's front.",
    )
