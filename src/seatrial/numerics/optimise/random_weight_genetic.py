"""The genetic algorithm with random weights (Murata & Ishibuchi 1995), as Yu et al. 2014 print it in section 3."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from seatrial.numerics.kernels.breeding import breed, decode_codes, exchange_tails, selection_shares, spin
from seatrial.numerics.optimise.least_squares import Array
from seatrial.numerics.optimise.population import Box, Population, SearchError, non_dominated, reject_nonfinite_settings

Bits = NDArray[np.uint8]  # 0 and 1
MOST_BITS = 52  # mantissa bits of a double


class Normaliser(Enum):
    """What each objective is divided by (yu2014 eq. 7): among the points of the first generation that can be at all.

    The paper's symbol says MAX, its words say BEST ("the fittest value of the first generation"). An objective whose
    best is zero is divided by its largest; one that is zero throughout stays as it is.
    """

    MAX = "max"
    BEST = "best"


@dataclass(frozen=True)
class GeneticSettings:
    """Settings of the random-weight genetic algorithm, in the notation of Yu et al. 2014.

    Attributes:
        population: individuals, elite included.
        generations: populations evaluated, the first included.
        objectives: numbers given for each point.
        Pc: probability that a pair of parents crosses over.
        Pm: probability that a bit of a child flips.
        bits: length of one unknown's code; not printed, ours.
        largest_weight: the random integers r run from 1 to this; not printed, ours.
        normaliser: what objectives are divided by.
    """

    population: int = 50
    generations: int = 200
    objectives: int = 3
    Pc: float = 0.8
    Pm: float = 0.01
    bits: int = 16
    largest_weight: int = 100
    normaliser: Normaliser = Normaliser.MAX

    def __post_init__(self) -> None:
        reject_nonfinite_settings(self)
        if self.objectives < 1:
            raise SearchError(f"A search needs at least 1 objective, not {self.objectives}.")
        if self.population < self.objectives + 2:
            raise SearchError(
                f"A genetic algorithm needs at least {self.objectives + 2} individuals, a pair beside the best of each "
                f"objective, not {self.population}."
            )
        for name, value in (("Pc", self.Pc), ("Pm", self.Pm)):
            if not 0 <= value <= 1:
                raise SearchError(f"The probability {name} lies between 0 and 1, not at {value}.")
        if not 2 <= self.bits <= MOST_BITS:
            raise SearchError(f"The code of an unknown has 2 to {MOST_BITS} bits, not {self.bits}.")
        if self.largest_weight < 1:
            raise SearchError(f"Random weights need integers from 1 to at least 1, not {self.largest_weight}.")


@dataclass(frozen=True, eq=False)
class NonDominatedSet:
    """Points no other evaluated point beats: points (k, d) and their objectives (k, m), by the first objective."""

    points: Array
    objectives: Array


class RandomWeightGenetic(Population):
    """Binary codes bred for the inverse of a weighted sum of objectives, the weights drawn anew every generation.

    `tell` takes a matrix (n, m) of objectives to be minimised, none below zero; a row with infinity takes no
    part in normalisers and is never chosen while another row can. Parents are drawn by roulette with linear scaling
    over the whole population (yu2014 prints a sum over 3), pairs cross over at one point of the whole code, bits flip;
    the best of each objective are added to the next population as they are.

    Ours, as the print is silent: codes are plain binary numbers, the first ones drawn bit by bit. Which individual of
    the last generation is the paper's one answer is not said: `best` is the fittest under equal weights. It is not
    among those that are kept, so the history, its weighted sum, need not fall.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: GeneticSettings | None = None) -> None:
        self.settings = settings or GeneticSettings()
        super().__init__(box, generator, self.settings.generations)
        drawn = generator.random((self.settings.population, box.size * self.settings.bits))
        self._codes: Bits = (drawn < 0.5).astype(np.uint8)  # fair bits
        self._scale: Array | None = None
        self._points: list[Array] = []
        self._objectives: list[Array] = []

    @property
    def generation(self) -> int:
        """Number of generations evaluated so far."""
        return self.iteration

    @property
    def best(self) -> tuple[Array, float]:
        """The last generation's fittest point under equal weights, shape (d,), and its sum J; infinite if none can be.

        J is the mean of the normalised objectives.
        """
        if self._scale is None:
            return decode(self._codes[0], self.box), np.inf
        J = self._weighted_sums(np.full(self.settings.objectives, 1 / self.settings.objectives))
        first = int(np.argmin(J))
        return self._points[-1][first].copy(), float(J[first])

    @property
    def front(self) -> NonDominatedSet:
        """Points that no other point of all generations beats: the set the paper updates every generation."""
        points, objectives = np.concatenate(self._points), np.concatenate(self._objectives)
        rows = non_dominated(objectives)
        return NonDominatedSet(points[rows], objectives[rows])

    def _propose(self) -> Array:
        if self.iteration:
            self._codes = self._next_codes()
        return decode(self._codes, self.box)

    def _validate(self, points: Array, values: Array) -> None:
        expected = (len(points), self.settings.objectives)
        if values.shape != expected:
            raise SearchError(
                f"The objectives of {expected[0]} points have shape {values.shape}; give {expected[1]} numbers a point."
            )
        wrong = np.argwhere(np.isnan(values) | (values < 0))
        if wrong.size:
            row, column = wrong[0]
            raise SearchError(
                f"Objective {column} of row {row} in generation {self.iteration} is {values[row, column]} at "
                f"{np.array2string(points[row], precision=6)}; fitness is 1/J: give a number that is not negative, and "
                "infinity where the model cannot be evaluated."
            )

    def _learn(self, points: Array, fitness: Array) -> None:
        self._points.append(points)
        self._objectives.append(fitness)
        if self._scale is None:
            self._scale = normalisers(fitness, self.settings.normaliser)

    def _weighted_sums(self, weights: Array) -> Array:
        """Return J of the last generation (yu2014 eq. 7), shape (n,); infinite where a point cannot be."""
        scale = np.ones(self.settings.objectives) if self._scale is None else self._scale
        return np.sum(self._objectives[-1] * (weights / scale), axis=1)

    def _next_codes(self) -> Bits:
        """Return the next population's codes: elite, then children of parents drawn by roulette."""
        settings, generator = self.settings, self._generator
        r = generator.integers(1, settings.largest_weight, settings.objectives, endpoint=True)
        J = self._weighted_sums(r / r.sum())  # eq. 6
        elite = np.argmin(self._objectives[-1], axis=0)[: None if np.isfinite(J).any() else 0]
        count = settings.population - len(elite)
        pairs, length = (count + 1) // 2, self._codes.shape[1]
        spins = generator.random((2, pairs))
        cut = crossover_points(generator, pairs, length, settings.Pc)
        offspring = np.empty_like(self._codes)
        breed(self._codes, J, elite, spins, cut, generator.random((count, length)), settings.Pm, offspring)
        return offspring


def normalisers(objectives: Array, kind: Normaliser) -> Array | None:
    """Return what objectives (n, m) are divided by, shape (m,); none while no row is finite."""
    feasible = objectives[np.isfinite(objectives).all(axis=1)]
    if not feasible.size:
        return None
    largest = feasible.max(axis=0)
    largest[largest == 0] = 1.0
    if kind is Normaliser.MAX:
        return largest
    best = feasible.min(axis=0)
    return np.where(best > 0, best, largest)


def selection_probabilities(fitness: Array) -> Array:
    """Return linear scaling (f - f_min) / sum (f - f_min), shape (n,); even where all are alike."""
    share = np.empty(len(fitness))
    selection_shares(np.ascontiguousarray(fitness, dtype=np.float64), share)
    return share


def roulette(probabilities: Array, uniforms: Array) -> NDArray[np.int64]:
    """Return rows on which numbers drawn from [0, 1), shape (k,), fall; rows of probability zero never."""
    rows = np.empty((1, len(uniforms)), dtype=np.int64)
    spin(probabilities, np.ascontiguousarray(uniforms)[None], rows)
    return rows[0]


def crossover_points(generator: np.random.Generator, pairs: int, length: int, Pc: float) -> NDArray[np.int64]:
    """First bit each pair exchanges, from 1 to length - 1, or the length where it exchanges none; shape (pairs,)."""
    crossing = generator.random(pairs) < Pc
    return np.where(crossing, generator.integers(1, length, pairs), length)


def cross_over(mothers: Bits, fathers: Bits, crossover_point: NDArray[np.int64]) -> Bits:
    """Return children of pairs, shape (2 pairs, length): all codes are exchanged from the cut on."""
    children = np.empty((2 * len(mothers), mothers.shape[1]), dtype=np.uint8)
    exchange_tails(mothers, fathers, crossover_point, children)
    return children


def decode(codes: Bits, box: Box) -> Array:
    """Points (..., d) of codes (..., d * bits), highest bit first: all zeros lower bound, all ones upper bound."""
    unit = np.empty((codes.size // codes.shape[-1], box.size))
    decode_codes(np.ascontiguousarray(codes, dtype=np.uint8).reshape(len(unit), -1), unit)
    return box.scaled(unit).reshape(*codes.shape[:-1], box.size)


def encode(points: Array, box: Box, bits: int) -> Bits:
    """Return codes (..., d * bits) nearest to points (..., d) of the box."""
    steps = np.rint((points - box.lower) / box.width * (2.0**bits - 1)).astype(np.int64)
    digits = steps[..., None] >> np.arange(bits - 1, -1, -1) & 1
    return digits.astype(np.uint8).reshape(*points.shape[:-1], -1)
