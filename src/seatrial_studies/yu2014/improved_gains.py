"""What beats the published gains: another point of the same three, and two more terms in the controller."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, DifferentialEvolution, EvolutionSettings, search
from seatrial.physics.loops import Performance, Preamplifier, five_gain_loop
from seatrial.physics.sea import bretschneider, ittc, jonswap
from seatrial_studies.yu2014.published import HEIGHT, PUBLISHED_VALUES, Table1Row
from seatrial_studies.yu2014.published_loop import (
    DESIGN_SEA,
    VARIANCE_ROWS,
    FinObjective,
    SeaCondition,
    calibrated_K_q,
    effective_slope,
    objective_values,
    performance,
    stabiliser_loop,
)
from seatrial_studies.yu2014.searches import BOX

MS_LIMIT = 2.0
SHORT_CRESTED = SeaCondition(spreading=1.0, name="ITTC 3.3 m, short-crested")
_JONSWAP = jonswap(HEIGHT, 2.0 * math.pi / ittc(HEIGHT).modal_frequency)
# seen by no search
HELD_OUT_SEAS = (
    SeaCondition(spectrum=_JONSWAP, name="JONSWAP 3.3 m, 9.1 s, long-crested"),
    SeaCondition(spectrum=_JONSWAP, spreading=1.0, name="JONSWAP 3.3 m, 9.1 s, short-crested"),
    SeaCondition(spectrum=bretschneider(HEIGHT, 9.7), spreading=1.0, name="Bretschneider 3.3 m, 9.7 s, short-crested"),
    SeaCondition(spectrum=bretschneider(HEIGHT, 8.0), name="Bretschneider 3.3 m, 8 s, long-crested"),
    SeaCondition(heading=135.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 135°"),
    SeaCondition(heading=45.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 45°"),
    SeaCondition(heading=45.0, name="ITTC 3.3 m, long-crested, 45°"),
)
_INFEASIBLE_COST = 10.0
FIVE_FREE, THREE_FREE = np.ones(5), np.array([1.0, 1.0, 1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class ThreeGainOptimum:
    """A controller beside the paper's gains in the same reading and sea.

    Attributes:
        gains: (g,); objective_ratios: J1, J2, J3 over the paper's, (3,).
    """

    preamplifier: Preamplifier
    ms_limit: float
    gains: Array
    Ms: float
    objective_ratios: Array


@dataclass(frozen=True)
class FiveGainComparison:
    """Five gains beside the paper's in one sea: variances of roll, fin angle, fin rate over the paper's; both
    reductions, per cent."""

    sea: SeaCondition
    roll_ratio: float
    fin_ratio: float
    rate_ratio: float
    paper_reduction: float
    reduction: float


@dataclass(frozen=True, eq=False)
class FiveGainDesign:
    """The controller with five gains, washout.

    Attributes:
        gains: (5,).
        design_seas: results in the two seas of the search.
        held_out_seas: results in others.
        three_gains: what three gains reach, in the same two seas and under the same limits.
        rate_ratios: fin-rate variance allowed, over the paper's, (k,).
        roll_ratios: by number of gains, worst roll variance over the paper's in both seas at these rates, (k,).
    """

    gains: Array
    Ms: float
    design_seas: tuple[FiveGainComparison, ...]
    held_out_seas: tuple[FiveGainComparison, ...]
    three_gains: tuple[FiveGainComparison, ...]
    rate_ratios: Array
    roll_ratios: dict[int, Array]


def design_five_gains(seed: int, rates: Array) -> FiveGainDesign:
    """Search five gains, compare them with the paper's, and trace roll against fin rate."""
    reading = Preamplifier.WASHOUT

    def optimise(rate: float, free: Array) -> Array:
        return minimise_roll(reading, rate, np.random.default_rng([seed, 5]), free)

    def compare_in_design_seas(gains: Array) -> tuple[FiveGainComparison, ...]:
        return tuple(compare_with_published(reading, gains, sea) for sea in (DESIGN_SEA, SHORT_CRESTED))

    gains, plain = optimise(1.0, FIVE_FREE), optimise(1.0, THREE_FREE)
    roll = {
        count: np.array(
            [max(c.roll_ratio for c in compare_in_design_seas(optimise(float(rate), free))) for rate in rates]
        )
        for count, free in ((3, THREE_FREE), (5, FIVE_FREE))
    }
    held_out = tuple(compare_with_published(reading, gains, sea) for sea in HELD_OUT_SEAS)
    return FiveGainDesign(
        gains,
        five_gain_Ms(reading, gains),
        compare_in_design_seas(gains),
        held_out,
        compare_in_design_seas(plain),
        rates,
        roll,
    )


def least_ratio_in_row(preamplifier: Preamplifier, row: Table1Row, generator: np.random.Generator) -> float:
    """The larger of roll and fin-rate variance over the paper's that three gains can have in a long-crested sea of
    table 1, under the paper's own Ms or 2."""
    of = performance(preamplifier, SeaCondition(row.speed, row.heading))
    paper = of.evaluate(PUBLISHED_VALUES)
    cap = max(MS_LIMIT, float(paper.Ms[0]))

    def worst(points: Array) -> Array:
        found = of.evaluate(points)
        shares = (found.variances / paper.variances)[:, (0, 2)].max(axis=1)
        return np.where(found.Ms <= cap, shares, np.inf)

    return float(worst(_minimise(BOX, worst, generator)[None])[0])


def three_gain_cost(preamplifier: Preamplifier, ms_limit: float) -> Callable[[Array], Array]:
    """Return points (n, 3) -> the worst objective over the paper's, infinite where Ms exceeds the limit, (n,)."""
    of = performance(preamplifier)
    paper = objective_values(of.evaluate(PUBLISHED_VALUES).variances, FinObjective.PRINTED)[0]

    def worst(points: Array) -> Array:
        found = of.evaluate(points)
        shares = (objective_values(found.variances, FinObjective.PRINTED) / paper).max(axis=1)
        return np.where(found.Ms <= ms_limit, shares, np.inf)

    return worst


def optimise_three_gains(
    preamplifier: Preamplifier, ms_limit: float, generator: np.random.Generator
) -> ThreeGainOptimum:
    """The three gains in the paper's box whose worst objective, over the paper's, is smallest under Ms <= cap."""
    of = performance(preamplifier)
    paper = objective_values(of.evaluate(PUBLISHED_VALUES).variances, FinObjective.PRINTED)[0]
    gains = _minimise(BOX, three_gain_cost(preamplifier, ms_limit), generator)
    found = of.evaluate(gains)
    return ThreeGainOptimum(
        preamplifier,
        ms_limit,
        gains,
        float(found.Ms[0]),
        objective_values(found.variances, FinObjective.PRINTED)[0] / paper,
    )


@cache
def _five_gain_performance(preamplifier: Preamplifier, sea: SeaCondition) -> Performance:
    return Performance(
        five_gain_loop(stabiliser_loop(preamplifier, sea.speed, calibrated_K_q(preamplifier))),
        effective_slope(sea),
        VARIANCE_ROWS,
    )


def five_gain_cost(preamplifier: Preamplifier, rate: float) -> Callable[[Array], Array]:
    """Return points (n, 5) -> roll variance over the paper's, (n,); 10 and more where a limit is exceeded.

    The limits: Ms <= 2 and at most `rate` times the paper's fin-rate variance. Both count in the long- and the
    short-crested sea of 3.3 m, the worse one each.
    """
    both = [
        (
            _five_gain_performance(preamplifier, sea),
            performance(preamplifier, sea).evaluate(PUBLISHED_VALUES).variances[0],
        )
        for sea in (DESIGN_SEA, SHORT_CRESTED)
    ]

    def cost(points: Array) -> Array:
        roll, over = np.zeros(len(points)), np.zeros(len(points))
        for k, (of, paper) in enumerate(both):
            found = of.evaluate(points, with_Ms=k == 0)
            roll = np.maximum(roll, found.variances[:, 0] / paper[0])
            over = np.maximum(over, found.variances[:, 2] / paper[2] - rate)
            over = np.maximum(over, found.Ms - MS_LIMIT)
        return np.where(over > 0.0, _INFEASIBLE_COST + over, roll)

    return cost


def five_gain_box(preamplifier: Preamplifier) -> Box:
    """Return the bounds of the five gains."""
    gains = _five_gain_performance(preamplifier, DESIGN_SEA).loop.gains
    return Box(*(np.array([getattr(g, side) for g in gains]) for side in ("lower", "upper")))


def minimise_roll(preamplifier: Preamplifier, rate: float, generator: np.random.Generator, free: Array) -> Array:
    """Gains (5,) of least `five_gain_cost`; `free`: which gains may differ from zero, (5,)."""
    cost = five_gain_cost(preamplifier, rate)
    return _minimise(five_gain_box(preamplifier), lambda points: cost(points * free), generator) * free


def compare_with_published(preamplifier: Preamplifier, gains: Array, sea: SeaCondition) -> FiveGainComparison:
    """Five gains beside the paper's three."""
    plain, of = performance(preamplifier, sea), _five_gain_performance(preamplifier, sea)
    paper, ours = plain.evaluate(PUBLISHED_VALUES).variances[0], of.evaluate(gains).variances[0]
    reductions = [100.0 * (1.0 - math.sqrt(v[0] / plain.uncontrolled_variances[0])) for v in (paper, ours)]
    return FiveGainComparison(sea, *(float(v) for v in ours / paper), *reductions)


def five_gain_Ms(preamplifier: Preamplifier, gains: Array) -> float:
    """Ms of five gains at the speed of the setting."""
    return float(_five_gain_performance(preamplifier, DESIGN_SEA).evaluate(gains).Ms[0])


def _minimise(box: Box, cost: Callable[[Array], Array], generator: np.random.Generator) -> Array:
    settings = EvolutionSettings(population=40, iterations=250)
    return search(DifferentialEvolution(box, generator, settings), cost).point
