"""Yu et al. 2014: three and five gains of a fin stabiliser, with both readings of its preamplifier."""

from collections.abc import Callable
from functools import cache

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, DifferentialEvolution, EvolutionSettings, search
from seatrial.physics.loops import Preamplifier
from seatrial.problems import BenchmarkProblem, KnownOptimum, Placement, ProblemDraw
from seatrial_studies.yu2014.improved_gains import MS_LIMIT, five_gain_box, five_gain_cost, three_gain_cost
from seatrial_studies.yu2014.published import SOURCE
from seatrial_studies.yu2014.published_loop import PREAMPLIFIER_LABELS
from seatrial_studies.yu2014.searches import BOX

# evaluations of the paper's genetic algorithm: 50 individuals in 200 generations
_BUDGET = 10_000
# factor by which a draw scales each gain, between its inverse and itself; chosen
_SCALE = 1.4
# the search for the least objective: populations, their size, and how often it is repeated; far beyond the budget
_LONG_SEARCH, _SEARCHES = EvolutionSettings(population=60, iterations=800), 3

_GAIN_NAMES = ("KP", "KI", "KD", "KB", "KL")


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return three and five gains, each with both preamplifiers."""
    return tuple(_problem(count, reading) for count in (3, 5) for reading in Preamplifier)


def _problem(count: int, reading: Preamplifier) -> BenchmarkProblem:
    label = PREAMPLIFIER_LABELS[reading]
    words = {3: "worst of three objectives over the paper's", 5: "roll variance at the paper's fin rate, two seas"}

    def draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
        is_shifted = placement is Placement.SHIFTED
        factors = _SCALE ** rng.uniform(-1.0, 1.0, count) if is_shifted else np.ones(count)
        return scaled_gains(_box(count, reading), _cost(count, reading), _least(count, reading), factors)

    return BenchmarkProblem(
        f"yu2014-{count}-{reading.name.lower()}", 1,
        f"{count} gains of a fin stabiliser, preamplifier {label}: {words[count]}, Ms at most {MS_LIMIT:g}",
        SOURCE, "none: variances by spectra", _BUDGET, draw,
    )  # fmt: skip


def scaled_gains(box: Box, cost: Callable[[Array], Array], least: float, factors: Array) -> ProblemDraw:
    """Return a draw in which each gain is a factor times the loop's; gains beyond the loop's bounds cost infinity.

    The bounds of the search stay the same for every draw, so that the optimum moves in them.
    """
    ends = np.stack([box.lower, box.upper])
    reach = np.concatenate([ends * _SCALE, ends / _SCALE])

    def fitness(points: Array, _: int = 0) -> Array:
        gains = points / factors
        is_inside = np.all((gains >= box.lower) & (gains <= box.upper), axis=1)
        values = np.full(len(points), np.inf)
        values[is_inside] = cost(gains[is_inside])
        return values

    names = _GAIN_NAMES[: box.size]
    searched = Box(reach.min(axis=0), reach.max(axis=0))
    return ProblemDraw(names, ("1",) * box.size, searched, fitness, KnownOptimum(fitness, least))


def _box(count: int, reading: Preamplifier) -> Box:
    return BOX if count == BOX.size else five_gain_box(reading)


@cache
def _cost(count: int, reading: Preamplifier) -> Callable[[Array], Array]:
    return three_gain_cost(reading, MS_LIMIT) if count == BOX.size else five_gain_cost(reading, 1.0)


@cache
def _least(count: int, reading: Preamplifier) -> float:
    """The least objective, the best of long searches; the same bits in every process."""
    box, cost = _box(count, reading), _cost(count, reading)
    searches = (DifferentialEvolution(box, np.random.default_rng([2014, k]), _LONG_SEARCH) for k in range(_SEARCHES))
    return min(search(method, cost).value for method in searches)
