"""One set of gains for all six conditions of table 1: what "global" would have to mean."""

from dataclasses import dataclass

import numpy as np

from seatrial.control import GeneticRun, genetic_run
from seatrial.core.values import Array
from seatrial.numerics.optimise import DifferentialEvolution, EvolutionSettings, GeneticSettings, search
from seatrial.physics.loops import Performance, Preamplifier
from seatrial_studies.yu2014.published import PUBLISHED_VALUES, TABLE_1
from seatrial_studies.yu2014.published_loop import FinObjective, SeaCondition, objective_values, performance
from seatrial_studies.yu2014.searches import BITS, BOX

MS_LIMIT = 2.0  # largest sensitivity peak where the paper's own is smaller; our choice, as elsewhere in this study


@dataclass(frozen=True, eq=False)
class JointOptimum:
    """Gains searched over all six conditions at once, long-crested, beside the paper's.

    Attributes:
        gains: (3,), of the least larger one of roll and fin-rate variance over the paper's in the worst condition, Ms
            within 2 or the paper's own where that is larger.
        ratios: roll, fin and fin-rate variance over the paper's in each condition, (6, 3); Ms, published_Ms: (6,).
        genetic_gains: the published search on the means of its objectives over the six, by seed (n, 3).
        genetic_ratios: their roll, fin and fin-rate variance over the paper's, (n, 6, 3); genetic_Ms: worst (n,).
    """

    preamplifier: Preamplifier
    gains: Array
    ratios: Array
    Ms: Array
    published_Ms: Array
    genetic_gains: Array
    genetic_ratios: Array
    genetic_Ms: Array

    @property
    def Ms_ratio(self) -> float:
        """Return the largest Ms over the paper's largest."""
        return float(self.Ms.max() / self.published_Ms.max())

    @property
    def genetic_worst_ratios(self) -> list[float]:
        """Return the same of each answer of the published algorithm."""
        return [float(ratios[:, (0, 2)].max()) for ratios in self.genetic_ratios]

    @property
    def worst_ratio(self) -> float:
        """Return the largest of roll and fin-rate variance over the paper's: below 1 it beats them everywhere."""
        return float(self.ratios[:, (0, 2)].max())


def joint_optimum(preamplifier: Preamplifier, seeds: int, seed: int) -> JointOptimum:
    """Search one set of gains for the six conditions, by differential evolution and by the published algorithm."""
    seas = [performance(preamplifier, SeaCondition(row.speed, row.heading)) for row in TABLE_1]
    paper = [of.evaluate(PUBLISHED_VALUES) for of in seas]
    caps = np.array([max(MS_LIMIT, float(p.Ms[0])) for p in paper])

    def worst(points: Array) -> Array:
        ratios, Ms = _judge(seas, paper_variances, points)
        return np.where((Ms <= caps).all(axis=1), ratios[:, :, (0, 2)].max(axis=(1, 2)), np.inf)

    paper_variances = np.stack([p.variances[0] for p in paper])
    evolution = DifferentialEvolution(
        BOX, np.random.default_rng([seed, 8]), EvolutionSettings(population=40, iterations=150)
    )
    gains = search(evolution, worst).point
    ratios, Ms = _judge(seas, paper_variances, gains[None])
    runs = [_genetic(seas, np.random.default_rng([seed, 9, k])) for k in range(seeds)]
    answers = np.stack([run.gains for run in runs])
    seen, peaks = _judge(seas, paper_variances, answers)
    return JointOptimum(
        preamplifier,
        gains,
        ratios[0],
        Ms[0],
        np.array([float(p.Ms[0]) for p in paper]),
        answers,
        seen,
        peaks.max(axis=1),
    )


def _judge(seas: list[Performance], paper: Array, points: Array) -> tuple[Array, Array]:
    """Variances over the paper's (n, 6, 3) and Ms (n, 6)."""
    made = [of.evaluate(points) for of in seas]
    return np.stack([one.variances for one in made], axis=1) / paper, np.stack([one.Ms for one in made], axis=1)


def _genetic(seas: list[Performance], generator: np.random.Generator) -> GeneticRun:
    """The published search on the mean of each objective over the conditions."""

    def objectives(points: Array) -> Array:
        variances = [of.evaluate(points, with_Ms=False).variances for of in seas]
        return np.mean([objective_values(v, FinObjective.PRINTED) for v in variances], axis=0)

    return genetic_run(objectives, BOX, GeneticSettings(bits=BITS), generator)
