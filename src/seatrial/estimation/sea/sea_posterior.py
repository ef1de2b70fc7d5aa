"""Ship and sea of one stretch when the heading to the waves is not known either: draws of all that the motion allows.

A motion's spectrum may fit several seas at several headings, so that no search about one optimum will do. A population
is drawn from points that fill headings and peak periods evenly, with ships and peaks drawn from what was known before,
by the likelihood to a small power. It then moves by differences of its own members (differential evolution Markov
chain: ter Braak 2006, Statistics and Computing 16, 239-249) while the power rises to one, each time so far that half of
the members keep their weight (adaptive tempering: Jasra et al. 2011, Scandinavian Journal of Statistics 38, 1-22).
Before the stretch all headings from following to head seas are equally likely, port and starboard the same, and so is
the logarithm of the peak period.
"""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.sea.legs_in_waves import PEAK_DEVIATION, PEAK_MEAN
from seatrial.estimation.sea.sea_likelihood import (
    HEADING,
    HEADING_CELL,
    NORMAL,
    NORMAL_SIZE,
    PEAK,
    PERIOD,
    POINT_SIZE,
    SHIP,
    SeaLikelihood,
)

_FIRST = 4096  # points that the population is drawn from: more than 20 for each degree of heading; chosen
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # step of the periods: multiples spread evenly over 0 to 1 (Kronecker)
_MEMBERS = 384  # of the population, even; chosen: many times its unknowns, so that none of several headings is lost
_KEPT_WEIGHT = 0.5  # share of the members that a rise of the power leaves; Jasra et al. 2011
_MOVES = 2  # generations at each power; chosen
# generations at one, every so many of which are kept after the first: from seed to seed means then differ by some 0.15
# of their deviations; chosen
_SETTLING, _GENERATIONS, _EVERY = 12, 60, 4
_DIFFERENCE = 2.38  # times the difference of two members, over the root of twice the unknowns; ter Braak 2006, eq. (2)
_STRETCHED = 0.5  # deviation of the logarithm of a factor on it: modes differ in width; chosen
_JUMPS, _JITTER = 0.1, 1e-4  # share of steps of a whole difference, from peak to peak; of every step, random; ter Braak
# shares of the unknowns that a step moves, one of them at random (crossover: Vrugt et al. 2009, International Journal
# of Nonlinear Sciences and Numerical Simulation 10, 273-290)
_CROSSOVERS = (0.3, 0.6, 1.0)
_BISECTIONS = 40  # of the next power: to 1e-12; chosen


@dataclass(frozen=True, eq=False)
class ShipInSea:
    """Draws: headings [rad] (n,), of `PLANT_FACTORS` (n, 3), and of `SEA_UNKNOWNS` (n, 3)."""

    headings: Array
    ships: Array
    seas: Array


@dataclass(frozen=True, eq=False)
class _Population:
    """Members: points (n, 7), evidence (n,), optimum and deviation of the height's logarithm, (n,)."""

    points: Array
    evidence: Array
    optimum: Array
    deviation: Array

    def chosen(self, places: Index) -> "_Population":
        """Return the members at these places."""
        return _Population(*(part[places] for part in vars(self).values()))

    def stepped(self, likelihood: SeaLikelihood, power: float, rng: np.random.Generator) -> "_Population":
        """Return the next generation: each half moves by differences of two members of the other."""
        first, second = np.split(np.arange(len(self.points)), 2)
        halfway = self._moved(first, second, likelihood, power, rng)
        return halfway._moved(second, first, likelihood, power, rng)

    def _moved(
        self, movers: Index, partners: Index, likelihood: SeaLikelihood, power: float, rng: np.random.Generator
    ) -> "_Population":
        """Return the population with the movers where Metropolis' rule takes them."""
        here, count = self.points[movers], len(movers)
        one = rng.integers(count, size=count)
        other = (one + rng.integers(1, count, size=count)) % count
        scale = _DIFFERENCE / math.sqrt(2.0 * POINT_SIZE) * np.exp(_STRETCHED * rng.standard_normal(count))
        scale = np.where(rng.random(count) < _JUMPS, 1.0, scale)
        moves = rng.random(here.shape) < rng.choice(_CROSSOVERS, size=(count, 1))
        step = scale[:, None] * (self.points[partners[one]] - self.points[partners[other]]) * moves
        there = here + step + _JITTER * rng.standard_normal(here.shape)
        heights = likelihood.heights(there)
        gain = power * (heights.evidence - self.evidence[movers])
        gain += 0.5 * (np.sum(here[:, NORMAL] ** 2, axis=1) - np.sum(there[:, NORMAL] ** 2, axis=1))
        accepted = np.log(rng.random(count)) < gain
        moved = _Population(*(part.copy() for part in vars(self).values()))
        moved.points[movers[accepted]] = there[accepted]
        for name in ("evidence", "optimum", "deviation"):
            getattr(moved, name)[movers[accepted]] = getattr(heights, name)[accepted]
        return moved


def draw_ship_in_sea(likelihood: SeaLikelihood, rng: np.random.Generator) -> ShipInSea:
    """Return draws of heading, ship and sea that a stretch allows, in the order in which they were made."""
    population, power = _first_points(likelihood, rng), 0.0
    population, power = _raised(population, power, _MEMBERS, rng)
    while power < 1.0:
        for _ in range(_MOVES):
            population = population.stepped(likelihood, power, rng)
        population, power = _raised(population, power, round(_KEPT_WEIGHT * _MEMBERS), rng)
    kept = []
    for generation in range(_GENERATIONS):
        population = population.stepped(likelihood, 1.0, rng)
        if generation >= _SETTLING and generation % _EVERY == 0:
            kept.append(population)
    points, optimum, deviation = (
        np.concatenate([getattr(one, name) for one in kept]) for name in ("points", "optimum", "deviation")
    )
    height = optimum + deviation * rng.standard_normal(len(points))
    seas = np.column_stack([height, points[:, PERIOD], PEAK_MEAN + PEAK_DEVIATION * points[:, PEAK]])
    # a cell of headings is all that the likelihood resolves: the truth may lie half a cell to either side
    headings = np.clip(points[:, HEADING] + HEADING_CELL * (rng.random(len(points)) - 0.5), 0.0, math.pi)
    return ShipInSea(headings, likelihood.deviations * points[:, SHIP], seas)


def _first_points(likelihood: SeaLikelihood, rng: np.random.Generator) -> _Population:
    """Return points drawn from what was known before the stretch, heading and period evenly (a lattice of rank 1)."""
    index = np.arange(_FIRST)
    places = np.column_stack([(index + 0.5) / _FIRST, (_GOLDEN * index + rng.random()) % 1.0])
    low, high = likelihood.periods
    normal = rng.standard_normal((_FIRST, NORMAL_SIZE))
    points = np.column_stack([math.pi * places[:, 0], low + (high - low) * places[:, 1], normal]).astype(np.float64)
    heights = likelihood.heights(points)
    return _Population(points, heights.evidence, heights.optimum, heights.deviation)


def _raised(population: _Population, power: float, wanted: int, rng: np.random.Generator) -> tuple[_Population, float]:
    """Return `_MEMBERS` drawn for the largest power up to one that leaves so many of equal weight, and that power."""
    low, high = power, 1.0
    if _equal_members((1.0 - power) * population.evidence) >= wanted:
        low = 1.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        is_kept = _equal_members((middle - power) * population.evidence) >= wanted
        low, high = (middle, high) if is_kept else (low, middle)
    places = _resampled((low - power) * population.evidence, _MEMBERS, rng)
    return population.chosen(rng.permutation(places)), low


def _equal_members(log_weight: Array) -> float:
    """Return how many members of equal weight the weights are worth (Kong, Liu & Wong 1994, JASA 89, 278)."""
    weight = np.exp(log_weight - np.max(log_weight))
    return float(np.sum(weight) ** 2 / np.sum(weight**2))


def _resampled(log_weight: Array, count: int, rng: np.random.Generator) -> Index:
    """Return places drawn by weight, (count,), at even steps of the cumulated weight (systematic resampling)."""
    cumulated = np.cumsum(np.exp(log_weight - np.max(log_weight)))
    steps = (np.arange(count) + rng.random()) / count
    return np.minimum(np.searchsorted(cumulated, steps * cumulated[-1]), len(cumulated) - 1)
