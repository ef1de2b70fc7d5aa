"""The published genetic algorithm on the published objectives, over seeds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.control import GeneticRun, genetic_run, record_cost
from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, GeneticSettings, Normaliser, non_dominated
from seatrial.physics.loops import Performance, Preamplifier
from seatrial_studies.yu2014.published import LOWER, PUBLISHED_VALUES, UPPER
from seatrial_studies.yu2014.published_loop import FinObjective, objective_values, performance

# searches in the full and in the quick version; our choice
SEEDS, QUICK_SEEDS = 12, 4
BITS = 17
BOX = Box(LOWER, UPPER)
FRAGILE_MS = 2.0
TIMES_TITLE = "Time of one published search of 10,000 evaluations"


@dataclass(frozen=True)
class GeneticSearchSetting:
    """What one set of searches is made with."""

    preamplifier: Preamplifier
    fin_objective: FinObjective = FinObjective.PRINTED
    normaliser: Normaliser = Normaliser.MAX


SETTINGS = tuple(
    GeneticSearchSetting(reading, fins, normaliser)
    for reading in Preamplifier
    for fins, normaliser in (
        (FinObjective.PRINTED, Normaliser.MAX),
        (FinObjective.ONE_SIDED, Normaliser.MAX),
        (FinObjective.PRINTED, Normaliser.BEST),
    )
)


@dataclass(frozen=True, eq=False)
class FinGainSearches:
    """Answers of n seeds.

    Attributes:
        gains: (n, 3).
        Ms: maximum sensitivity (n,).
        objective_ratios: objectives over those of the paper's gains (n, 3), infinite where these are zero.
        reduction: per cent (n,).
        is_dominated: whether a point that some seed evaluated has all three objectives smaller (n,).
        seconds: CPU time of each search with its front (n,).
    """

    setting: GeneticSearchSetting
    gains: Array
    Ms: Array
    objective_ratios: Array
    reduction: Array
    is_dominated: NDArray[np.bool_]
    seconds: Array

    @property
    def relative_spread(self) -> Array:
        """Return the spread of each gain, largest minus smallest over the width of the box, (3,)."""
        return np.ptp(self.gains, axis=0) / BOX.width

    @property
    def distance_to_published(self) -> float:
        """How far the nearest answer is from the paper's: its worst gain, over the width of the box."""
        return float((np.abs(self.gains - PUBLISHED_VALUES) / BOX.width).max(axis=1).min())

    @property
    def fragile_count(self) -> int:
        """Return how many answers have an Ms above 2."""
        return int(np.sum(self.Ms > FRAGILE_MS))


def search_over_seeds(setting: GeneticSearchSetting, seeds: int, seed: int) -> FinGainSearches:
    """Run one search for each seed."""
    of = performance(setting.preamplifier)
    made = [_search(of, setting, np.random.default_rng([seed, k])) for k in range(seeds)]
    gains = np.stack([run.gains for run in made])
    front = np.concatenate([run.front.objectives for run in made])
    found, paper = (
        of.evaluate(gains),
        objective_values(of.evaluate(PUBLISHED_VALUES, with_Ms=False).variances, setting.fin_objective)[0],
    )
    J = objective_values(found.variances, setting.fin_objective)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(paper > 0.0, J / paper, np.where(J > 0.0, np.inf, 1.0))
    front = front[non_dominated(front)]
    beaten = np.any((front[:, None] < J).all(axis=2), axis=0)
    reduction = 100.0 * (1.0 - np.sqrt(found.variances[:, 0] / of.uncontrolled_variances[0]))
    return FinGainSearches(setting, gains, found.Ms, shares, reduction, beaten, np.array([r.cpu_s for r in made]))


def _search(loop_performance: Performance, setting: GeneticSearchSetting, generator: np.random.Generator) -> GeneticRun:
    """One search, the same that `seatrial tune --method genetic` makes."""

    def objectives(gains: Array) -> Array:
        return objective_values(loop_performance.evaluate(gains, with_Ms=False).variances, setting.fin_objective)

    return genetic_run(objectives, BOX, GeneticSettings(bits=BITS, normaliser=setting.normaliser), generator)


def time_domain_seconds(seed: int) -> tuple[float, float]:
    """CPU time [s] one search takes with a record of 1000 s at 0.1 s for each gain set, exact zero-order hold.

    By a compiled scalar loop, and by scipy's lsim: the time of one record times all evaluations; the sea free of cost.
    """
    settings = GeneticSettings()
    compiled, lsim = record_cost(performance(Preamplifier.WASHOUT).loop, PUBLISHED_VALUES, seed)
    count = settings.generations * settings.population
    return compiled * count, lsim * count
