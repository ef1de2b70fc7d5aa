"""The published genetic algorithm on the published objectives, over seeds."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lsim

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, GeneticSettings, Normaliser, RandomWeightGenetic, non_dominated
from seatrial.physics.loops import Performance
from seatrial.physics.loops.fin import Preamplifier
from seatrial.physics.loops.state_space import state_space
from seatrial.physics.simulate.population import Forcing, trajectories
from seatrial_studies.yu2014.published import FOUND, LOWER, RECORD, STEP, UPPER
from seatrial_studies.yu2014.readings import Fins, objectives, performance

SEEDS, QUICK_SEEDS = 12, 4
BITS = 17
BOX = Box(LOWER, UPPER)
FRAGILE = 2.0


@dataclass(frozen=True)
class Setting:
    """What one set of searches is made with."""

    reading: Preamplifier
    fins: Fins = Fins.PRINTED
    normaliser: Normaliser = Normaliser.MAX


SETTINGS = tuple(
    Setting(reading, fins, normaliser)
    for reading in Preamplifier
    for fins, normaliser in (
        (Fins.PRINTED, Normaliser.MAX),
        (Fins.ONE_SIDED, Normaliser.MAX),
        (Fins.PRINTED, Normaliser.BEST),
    )
)


@dataclass(frozen=True, eq=False)
class Searches:
    """Answers of n seeds.

    Attributes:
        gains: (n, 3); peak: Ms (n,); shares: objectives over those of the paper's gains (n, 3), infinite where these
            are zero; reduction: per cent (n,).
        beaten: whether a point that some seed evaluated has all three objectives smaller (n,).
        seconds: of each search with its front (n,).
    """

    setting: Setting
    gains: Array
    peak: Array
    shares: Array
    reduction: Array
    beaten: NDArray[np.bool_]
    seconds: Array

    @property
    def spread(self) -> Array:
        """Of each gain, largest minus smallest over the width of the box, (3,)."""
        return np.ptp(self.gains, axis=0) / BOX.width

    @property
    def nearest(self) -> float:
        """How far the nearest answer is from the paper's: its worst gain, over the width of the box."""
        return float((np.abs(self.gains - FOUND) / BOX.width).max(axis=1).min())

    @property
    def fragile(self) -> int:
        """How many have an Ms above 2."""
        return int(np.sum(self.peak > FRAGILE))


def searches(setting: Setting, seeds: int, seed: int) -> Searches:
    """One search for each seed."""
    of = performance(setting.reading)
    made = [_one(of, setting, np.random.default_rng([seed, k])) for k in range(seeds)]
    gains = np.stack([genetic.best[0] for genetic, _ in made])
    front = np.concatenate([genetic.front.objectives for genetic, _ in made])
    found, paper = of.of(gains), objectives(of.of(FOUND, with_peak=False).variances, setting.fins)[0]
    J = objectives(found.variances, setting.fins)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(paper > 0.0, J / paper, np.where(J > 0.0, np.inf, 1.0))
    front = front[non_dominated(front)]
    beaten = np.any((front[:, None] < J).all(axis=2), axis=0)
    reduction = 100.0 * (1.0 - np.sqrt(found.variances[:, 0] / of.uncontrolled[0]))
    return Searches(setting, gains, found.peak, shares, reduction, beaten, np.array([s for _, s in made]))


def _one(of: Performance, setting: Setting, generator: np.random.Generator) -> tuple[RandomWeightGenetic, float]:
    """A search and its time [s], the front included."""
    began = time.perf_counter()
    genetic = RandomWeightGenetic(BOX, generator, GeneticSettings(bits=BITS, normaliser=setting.normaliser))
    while not genetic.done:
        variances = of.of(genetic.ask(), with_peak=False).variances
        genetic.tell(objectives(variances, setting.fins))
    genetic.front  # noqa: B018
    return genetic, time.perf_counter() - began


def in_time(seed: int) -> tuple[float, float]:
    """s one search would take with a record of 1000 s at .1 s for each gain set, exact zero-order hold.

    First compiled, a population in vector lanes: one is simulated, and its time multiplied by the generations. Then
    scipy's lsim: one record is simulated, and its time multiplied by all evaluations. Roll alone, the sea free of cost.
    """
    settings = GeneticSettings()
    generator = np.random.default_rng([seed, 4])
    states = state_space(performance(Preamplifier.WASHOUT).loop)
    gains = np.concatenate([FOUND[None], BOX.drawn(generator, settings.population - 1)])
    A = states.A[0] + np.tensordot(gains, states.A[1:], 1)
    B = np.repeat(states.b[None, :, None], len(gains), axis=0)
    slope = generator.normal(size=(round(RECORD / STEP) + 1, 1))
    began = time.perf_counter()
    trajectories(A, B, Forcing(slope, STEP, is_held=True), np.zeros(A.shape[1]), (0,))
    compiled = time.perf_counter() - began
    system = (A[0], B[0], states.c[None], np.zeros((1, 1)))
    began = time.perf_counter()
    lsim(system, slope, STEP * np.arange(len(slope)), interp=False)
    single = time.perf_counter() - began
    return compiled * settings.generations, single * settings.generations * settings.population
