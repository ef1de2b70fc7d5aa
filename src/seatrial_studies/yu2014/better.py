"""What beats the published gains: another point of the same three, and two more terms in the controller."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, DifferentialEvolution, EvolutionSettings, search
from seatrial.physics.loops import Performance
from seatrial.physics.loops.fin import Preamplifier
from seatrial.physics.loops.structures import five_gains
from seatrial.physics.sea.spectrum import bretschneider, ittc, jonswap
from seatrial_studies.yu2014.published import FOUND, HEIGHT, Row
from seatrial_studies.yu2014.readings import ROWS, SETTING, Fins, Sea, calibrated, loop, met, objectives, performance
from seatrial_studies.yu2014.searches import BOX

CAP = 2.0
SHORT_CRESTED = Sea(spreading=1.0, name="ITTC 3.3 m, short-crested")
_JONSWAP = jonswap(HEIGHT, 2.0 * math.pi / ittc(HEIGHT).modal_frequency)
# seen by no search
HELD_OUT = (
    Sea(spectrum=_JONSWAP, name="JONSWAP 3.3 m, 9.1 s, long-crested"),
    Sea(spectrum=_JONSWAP, spreading=1.0, name="JONSWAP 3.3 m, 9.1 s, short-crested"),
    Sea(spectrum=bretschneider(HEIGHT, 9.7), spreading=1.0, name="Bretschneider 3.3 m, 9.7 s, short-crested"),
    Sea(spectrum=bretschneider(HEIGHT, 8.0), name="Bretschneider 3.3 m, 8 s, long-crested"),
    Sea(heading=135.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 135°"),
    Sea(heading=45.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 45°"),
    Sea(heading=45.0, name="ITTC 3.3 m, long-crested, 45°"),
)
_BROKEN = 10.0
ALL, ONLY_THREE = np.ones(5), np.array([1.0, 1.0, 1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Better:
    """A controller beside the paper's gains in the same reading and sea.

    Attributes:
        gains: (g,); peak: Ms; shares: J1, J2, J3 over the paper's, (3,).
    """

    reading: Preamplifier
    cap: float
    gains: Array
    peak: float
    shares: Array


@dataclass(frozen=True)
class Compared:
    """Five gains beside the paper's in one sea: variances of roll, fin angle, fin rate over the paper's; both
    reductions, per cent."""

    sea: Sea
    roll: float
    fin: float
    rate: float
    paper_reduction: float
    reduction: float


@dataclass(frozen=True, eq=False)
class Richer:
    """The controller with five gains, washout.

    Attributes:
        gains: (5,); peak: Ms; designed: in the two seas it was searched in; held_out: in others.
        three: what three gains reach, in the same two seas and under the same limits.
        rates: fin-rate variance allowed, over the paper's, (k,); roll: by number of gains, worst roll variance over the
            paper's in both seas at these rates, (k,).
    """

    gains: Array
    peak: float
    designed: tuple[Compared, ...]
    held_out: tuple[Compared, ...]
    three: tuple[Compared, ...]
    rates: Array
    roll: dict[int, Array]


def richer(seed: int, rates: Array) -> Richer:
    """Searched, compared, and the trade between roll and fin rate."""
    reading = Preamplifier.WASHOUT

    def found(rate: float, free: Array) -> Array:
        return least_roll(reading, rate, np.random.default_rng([seed, 5]), free)

    def in_both(gains: Array) -> tuple[Compared, ...]:
        return tuple(compared(reading, gains, sea) for sea in (SETTING, SHORT_CRESTED))

    gains, plain = found(1.0, ALL), found(1.0, ONLY_THREE)
    roll = {
        count: np.array([max(c.roll for c in in_both(found(float(rate), free))) for rate in rates])
        for count, free in ((3, ONLY_THREE), (5, ALL))
    }
    held_out = tuple(compared(reading, gains, sea) for sea in HELD_OUT)
    return Richer(gains, peak_of(reading, gains), in_both(gains), held_out, in_both(plain), rates, roll)


def roll_and_rate_elsewhere(reading: Preamplifier, row: Row, generator: np.random.Generator) -> float:
    """The larger of roll and fin-rate variance over the paper's that three gains can have in a long-crested sea of
    table 1, under the paper's own Ms or 2."""
    of = performance(reading, Sea(row.speed, row.heading))
    paper = of.of(FOUND)
    cap = max(CAP, float(paper.peak[0]))

    def worst(points: Array) -> Array:
        found = of.of(points)
        shares = (found.variances / paper.variances)[:, (0, 2)].max(axis=1)
        return np.where(found.peak <= cap, shares, np.inf)

    return float(worst(_searched(BOX, worst, generator)[None])[0])


def best_of_three(reading: Preamplifier, cap: float, generator: np.random.Generator) -> Better:
    """The three gains in the paper's box whose worst objective, over the paper's, is smallest under Ms <= cap."""
    of = performance(reading)
    paper = objectives(of.of(FOUND).variances, Fins.PRINTED)[0]

    def worst(points: Array) -> Array:
        found = of.of(points)
        shares = (objectives(found.variances, Fins.PRINTED) / paper).max(axis=1)
        return np.where(found.peak <= cap, shares, np.inf)

    gains = _searched(BOX, worst, generator)
    found = of.of(gains)
    return Better(reading, cap, gains, float(found.peak[0]), objectives(found.variances, Fins.PRINTED)[0] / paper)


@cache
def _five(reading: Preamplifier, sea: Sea) -> Performance:
    return Performance(five_gains(loop(reading, sea.speed, calibrated(reading))), met(sea), ROWS)


def least_roll(reading: Preamplifier, rate: float, generator: np.random.Generator, free: Array) -> Array:
    """Gains (5,) with the least roll variance, Ms <= 2 and at most `rate` times the paper's fin-rate variance.

    Both count in the long- and the short-crested sea of 3.3 m, the worse one each. `free`: which gains may differ from
    zero, (5,).
    """
    both = [(_five(reading, sea), performance(reading, sea).of(FOUND).variances[0]) for sea in (SETTING, SHORT_CRESTED)]

    def cost(points: Array) -> Array:
        roll, over = np.zeros(len(points)), np.zeros(len(points))
        for k, (of, paper) in enumerate(both):
            found = of.of(points * free, with_peak=k == 0)
            roll = np.maximum(roll, found.variances[:, 0] / paper[0])
            over = np.maximum(over, found.variances[:, 2] / paper[2] - rate)
            over = np.maximum(over, found.peak - CAP)
        return np.where(over > 0.0, _BROKEN + over, roll)

    gains = both[0][0].loop.gains
    box = Box(*(np.array([getattr(g, side) for g in gains]) for side in ("lower", "upper")))
    return _searched(box, cost, generator) * free


def compared(reading: Preamplifier, gains: Array, sea: Sea) -> Compared:
    """Five gains beside the paper's three."""
    plain, of = performance(reading, sea), _five(reading, sea)
    paper, ours = plain.of(FOUND).variances[0], of.of(gains).variances[0]
    reductions = [100.0 * (1.0 - math.sqrt(v[0] / plain.uncontrolled[0])) for v in (paper, ours)]
    return Compared(sea, *(float(v) for v in ours / paper), *reductions)


def peak_of(reading: Preamplifier, gains: Array) -> float:
    """Ms of five gains at the speed of the setting."""
    return float(_five(reading, SETTING).of(gains).peak[0])


def _searched(box: Box, cost: Callable[[Array], Array], generator: np.random.Generator) -> Array:
    settings = EvolutionSettings(population=40, iterations=250)
    return search(DifferentialEvolution(box, generator, settings), cost).point
