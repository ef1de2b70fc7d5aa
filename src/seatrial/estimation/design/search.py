"""The search: orders whose worst ship, measured against standard sequences, is identified best."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from seatrial.core.values import Array
from seatrial.data.trial.design_request import DesignCriterion
from seatrial.estimation.design.exchange import ExchangedOrders, coordinate_exchange
from seatrial.estimation.design.manoeuvre_information import (
    ManoeuvreEvaluator,
    ManoeuvreInformation,
    leaves_limits,
    limit_excess,
)
from seatrial.estimation.design.orders import input_series, order_counts, orders_at
from seatrial.estimation.design.standard_manoeuvres import StandardManoeuvre
from seatrial.estimation.design.task import DesignTask
from seatrial.numerics.optimise import AdaptationSettings, Box, CovarianceAdaptation, Solution, Status
from seatrial.numerics.workers import map_in_threads

# the mean over ships of (error / error of the best standard sequence)^4: near the worst ship's, and smooth
MEAN_POWER = 4.0
# error over that of standard sequences that stands for a simulation that diverges, ours
DIVERGED_RATIO = 50.0
# cost of exceeding a limit by its own size, ours
LIMIT_PENALTY = 20.0
# kept from the limits during the search, so that finer steps and other ships do not cross them
LIMIT_MARGIN = 0.02
# random orders tried before the evolution strategy, ours
RANDOM_STARTS = 96
# of the evolution strategy, ours
GENERATIONS = 180
# best random orders whose orders are exchanged; chosen: one alone often ends in a poor optimum
EXCHANGED_STARTS = 3
# evaluations of the exchanges for each generation that follows
EXCHANGES_PER_GENERATION = 8
# the search's box: a point beyond an end means that end, so that full deflection is no corner to be hit
BOX_LOWER, BOX_UPPER, INITIAL_STEP = -1.0, 2.0, 0.1


@dataclass(frozen=True, eq=False)
class DesignObjective:
    """The smallest error (ships,) that any standard sequence gives each ship."""

    evaluator: ManoeuvreEvaluator
    baseline_errors: Array

    @classmethod
    def from_standards(cls, evaluator: ManoeuvreEvaluator, standards: list[StandardManoeuvre]) -> "DesignObjective":
        """Return the objective of the standard manoeuvres that keep within the limits, or all where none does."""
        precision = [evaluator.evaluate(r.inputs_for(evaluator)) for r in standards]
        errors = np.array([criterion_errors(evaluator.task, t) for t in precision])
        within = np.array([not leaves_limits(evaluator.task, t) for t in precision])
        chosen = errors[within] if within.any() else errors
        return cls(evaluator, np.nanmin(np.where(np.isfinite(chosen), chosen, DIVERGED_RATIO), axis=0))

    def cost(self, point: Array) -> float:
        """Return the logarithm of the power mean of the ratios, and what leaving the limits costs."""
        task = self.evaluator.task
        precision = self.evaluator.evaluate(input_series(task, orders_at(task, point), self.evaluator.dt))
        ratio = np.minimum(
            np.nan_to_num(criterion_errors(task, precision) / self.baseline_errors, nan=DIVERGED_RATIO), DIVERGED_RATIO
        )
        return float(np.log(np.mean(ratio**MEAN_POWER)) / MEAN_POWER + _limit_cost(task, precision))


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The best point of the search's box; whether the search was cut short by the keyboard."""

    solution: Solution
    is_interrupted: bool


def criterion_errors(task: DesignTask, information: ManoeuvreInformation) -> Array:
    """Return what the criterion looks at, for each ship; NaN for a lost one."""
    if task.request.criterion is DesignCriterion.WORST:
        return information.relative_errors.max(axis=1)
    return np.sqrt(np.mean(information.relative_errors**2, axis=1))


def search_orders(
    objective: DesignObjective, seed: int, report_progress: Callable[[str], None], generations: int = GENERATIONS
) -> SearchResult:
    """Random sequences, orders of the best few exchanged one by one, then an evolution strategy about the best result.

    The strategy is that of Hansen 2016, by `cmaes`; exchange finds the ends that orders go to, and leaves the rest.
    Ctrl-C gives the best so far. The same seed gives the same bits, whatever the number of workers.
    """
    generator = np.random.default_rng(seed)
    best, value, evaluations, history = np.zeros(0), np.inf, 0, []
    interrupted = False
    try:
        points = _random_sequences(objective.evaluator.task, generator)
        costs = np.array(map_in_threads(objective.cost, points))
        starts = [ExchangedOrders(points[k], float(costs[k])) for k in np.argsort(costs)[:EXCHANGED_STARTS]]
        best, value, evaluations = starts[0].point, starts[0].cost, len(points)
        history.append(value)
        for start in starts:
            report_progress(f"search: orders exchanged one by one, {_cost_text(value)}")
            before = evaluations
            for now in coordinate_exchange(
                objective.cost, start, generator, EXCHANGES_PER_GENERATION * generations // EXCHANGED_STARTS
            ):
                best, value = min((best, value), (now.point, now.cost), key=itemgetter(1))
                evaluations = before + now.evaluations
            history.append(value)
        box = Box(np.full(len(best), BOX_LOWER), np.full(len(best), BOX_UPPER))
        # draws of a point outside the box; chosen
        settings = AdaptationSettings(iterations=generations, step=INITIAL_STEP / (BOX_UPPER - BOX_LOWER), resampling=5)
        strategy = CovarianceAdaptation(box, generator, settings, best)
        while not strategy.done:
            asked = strategy.ask()
            strategy.tell(np.array(map_in_threads(objective.cost, list(asked))))
            evaluations += len(asked)
            point, cost = strategy.best
            if cost < value:
                best, value = point, cost
            history.append(value)
            if len(history) % 10 == 0:
                report_progress(f"search: {len(history)} of {generations} generations, {_cost_text(value)}")
    except KeyboardInterrupt:
        if not len(best):
            raise
        interrupted = True
    status = Status.EXHAUSTED
    return SearchResult(Solution(best, value, status, evaluations, tuple(history), seed), interrupted)


def _cost_text(value: float) -> str:
    """Return a cost in words."""
    return (
        f"error {np.exp(value):.3f} of the standard"
        if value < np.log(DIVERGED_RATIO)
        else "the limits are not kept yet"
    )


def _limit_cost(task: DesignTask, information: ManoeuvreInformation) -> float:
    """Return what it costs that ships which the limits bind leave them."""
    over = limit_excess(task, information, LIMIT_MARGIN)
    return LIMIT_PENALTY * float(over.max() if task.request.limits.for_every_ship else over[0])


def _random_sequences(task: DesignTask, generator: np.random.Generator) -> list[Array]:
    """Return sequences that jump between two ends, of several switching times and amplitudes."""
    points = []
    for _ in range(RANDOM_STARTS):
        pieces = []
        for count in order_counts(task):
            times = int(generator.integers(1, 4))
            signs = np.repeat(generator.choice([-1.0, 1.0], size=count // times + 1), times)[:count]
            # amplitudes up to 0.45 about the middle of the range; chosen
            pieces.append(0.5 + 0.45 * generator.choice([0.25, 0.5, 0.75, 1.0]) * signs)
        points.append(np.concatenate(pieces))
    return points


def at_sensor_rate(evaluator: ManoeuvreEvaluator) -> ManoeuvreEvaluator:
    """Return the same ships at the sensors' rate."""
    return replace(evaluator, dt=1.0 / evaluator.task.request.rate)
