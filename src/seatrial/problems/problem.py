"""A benchmark problem: what it is, where it comes from, and how one draw of it comes from a seed."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.values import Array
from seatrial.data.trial import Trial
from seatrial.numerics.optimise import Box, LeastSquaresProblem
from seatrial.problems.yardstick import Yardstick

_STREAM = 20
"""First number of the seed of every draw: chosen, so that draws and methods take different random numbers."""


class Placement(StrEnum):
    """Where the truth lies."""

    SHIFTED = "shifted"
    PUBLISHED = "published"

    @property
    def text(self) -> str:
        """What it means, in words."""
        if self is Placement.SHIFTED:
            description = "a known truth scaled, and shifted from the middle of its box, anew by every seed"
            return f"{description}; of measured trials another session left out"
        return "truth as published, in the middle of its box where the paper has it there"


ChangingFitness = Callable[[Array, int], Array]
"""Points (n, d) and the number of the iteration, from 0 -> fitness (n,); infinite where it cannot be evaluated."""


@dataclass(frozen=True, eq=False)
class ProblemDraw:
    """One draw of a problem.

    Attributes:
        unknowns: names; units: SI, of each.
        box: bounds of the search.
        fitness: what optimisers make small.
        start: values that need no search, from physics or an earlier model (d,); without it the middle of the box.
        least_squares: half the sum of squared residuals in standard deviations with its slopes, initial states held.
        trial: records and model; the model's values are those of the start.
        yardstick: what an answer is measured by.
    """

    unknowns: tuple[str, ...]
    units: tuple[str, ...]
    box: Box
    fitness: ChangingFitness
    yardstick: Yardstick
    start: Array | None = None
    least_squares: LeastSquaresProblem | None = None
    trial: Trial | None = None


@dataclass(frozen=True)
class PaperClaim:
    """What a paper says of two methods on its problem.

    Attributes:
        text: one sentence; better, worse: names of built-in methods.
    """

    text: str
    better: str
    worse: str


@dataclass(frozen=True)
class BenchmarkProblem:
    """A named, versioned problem.

    Attributes:
        name: family, then what distinguishes it, with dashes.
        version: raised by whatever changes a draw; part of the identity of every result.
        title: one line; source: where it was published.
        noise: of the records, in words; budget: evaluations that a method may spend.
        is_changing: whether the fitness differs from iteration to iteration, as one that judges sample by sample.
        draw_with: makes a draw from random numbers.
        claims: what its paper says of methods on it.
    """

    name: str
    version: int
    title: str
    source: str
    noise: str
    budget: int
    draw_with: Callable[[np.random.Generator, Placement], ProblemDraw]
    is_changing: bool = False
    claims: tuple[PaperClaim, ...] = ()

    @property
    def label(self) -> str:
        """Name and version, as citations have them."""
        return f"{self.name}@{self.version}"

    def draw(self, seed: int, placement: Placement = Placement.SHIFTED) -> ProblemDraw:
        """Return the draw of a seed: the same bits for the same seed."""
        return self.draw_with(np.random.default_rng([_STREAM, seed]), placement)
