"""The published search over seeds and in time, and what beats it: three, five and joint gains."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from seatrial.control import GeneticRun, genetic_run
from seatrial.core.values import Array
from seatrial.numerics.optimise import (
    Box,
    DifferentialEvolution,
    EvolutionSettings,
    GeneticSettings,
    Normaliser,
    hypervolume,
    non_dominated,
    search,
)
from seatrial.physics.loops import Performance, Preamplifier, TransferLoop, five_gain_loop, state_space
from seatrial.physics.sea import Spacing, bretschneider, ittc, jonswap, realise
from seatrial.physics.simulate import loop_record
from seatrial_studies.heave_pitch_search import is_smaller
from seatrial_studies.study_file import study_setting
from seatrial_studies.yu2014.published import (
    DESIGN_SEA,
    KNOT,
    LOWER,
    PUBLISHED,
    PUBLISHED_LOOP,
    PUBLISHED_VALUES,
    TABLE_1,
    UPPER,
    VARIANCE_ROWS,
    FinObjective,
    RollResponse,
    SeaCondition,
    Table1Row,
    calibrated_K_q,
    effective_slope,
    objective_values,
    performance,
    roll_response,
    stabiliser_loop,
)
from seatrial_studies.yu2014.reproduction import LINES, response_to_slope

# The published genetic algorithm on the published objectives, over seeds.

# searches in the full and in the quick version; our choice
SEEDS, BITS = study_setting("yu2014", "seeds", int), study_setting("yu2014", "bits", int).value
BOX = Box(LOWER, UPPER)
FRAGILE_MS = 2.0


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


@dataclass(frozen=True, eq=False)
class WeightComparison:
    """The published search with random weights and with fixed, equal ones, from the same first generations.

    Attributes:
        J: mean of the normalised objectives of the answer, random and fixed, (2, n).
        volume: what the points evaluated dominate of the box from zero to twice the objectives of the paper's gains, as
            a share of it, (2, n).
    """

    preamplifier: Preamplifier
    J: Array
    volume: Array

    def count_better(self) -> tuple[int, int]:
        """Return in how many pairs random weights have the smaller J, and in how many the larger volume."""
        return int(np.sum(self.J[0] < self.J[1])), int(np.sum(self.volume[0] > self.volume[1]))

    @property
    def is_better(self) -> bool:
        """Whether random weights are better in both by a sign test."""
        return is_smaller(*self.J) and is_smaller(*-self.volume)

    @property
    def is_worse(self) -> bool:
        """Whether fixed weights are better in both by a sign test."""
        return is_smaller(*self.J[::-1]) and is_smaller(*-self.volume[::-1])


def compare_weights(preamplifier: Preamplifier, seed: int) -> WeightComparison:
    """Run the search of each seed twice: weights drawn anew every generation, eq. (6), and equal ones throughout."""
    loop = performance(preamplifier)

    def objectives(gains: Array) -> Array:
        return objective_values(loop.evaluate(gains, with_Ms=False).variances, FinObjective.PRINTED)

    corner = _CORNER * objectives(PUBLISHED_VALUES[None])[0]
    runs = [
        [
            genetic_run(
                objectives, BOX, GeneticSettings(bits=BITS, largest_weight=most), np.random.default_rng([seed, k])
            )
            for k in range(SEEDS.value)
        ]
        for most in (GeneticSettings.largest_weight, 1)  # integers from 1 to 1: equal weights
    ]
    volumes = [[_dominated_share(run.front.objectives, corner) for run in pair] for pair in runs]
    return WeightComparison(preamplifier, np.array([[run.J for run in pair] for pair in runs]), np.array(volumes))


def _dominated_share(objectives: Array, corner: Array) -> float:
    """What points (n, m) dominate of the box from zero to a corner (m,), as a share of it."""
    inside = objectives[np.all(objectives < corner, axis=1)] / corner
    return hypervolume(inside, np.ones(len(corner))) if len(inside) else 0.0


_REPEATS = 3  # of which the fastest counts; chosen


def record_cost(loop: TransferLoop, gains: Array, seed: int) -> tuple[float, float]:
    """Measure the CPU time [s] of a record of 1000 s at 0.1 s, by a compiled scalar loop and by scipy.signal.lsim.

    Of one loop with the gains (g,) in white noise: each one holds its input exactly.
    """
    from scipy.signal import lsim

    states = state_space(loop)
    disturbance = np.random.default_rng(seed).standard_normal(round(PUBLISHED.record_seconds / PUBLISHED.step) + 1)
    system = (states.closed_loop_matrix(gains), states.b[:, None], states.c[None], np.zeros((1, 1)))
    times = PUBLISHED.step * np.arange(len(disturbance))
    return (
        _least_cpu_time(lambda: loop_record(states, gains, disturbance, PUBLISHED.step)),
        _least_cpu_time(lambda: lsim(system, disturbance, times, interp=False)),
    )


def _least_cpu_time(run: Callable[[], object]) -> float:
    seconds = []
    for _ in range(_REPEATS):
        began = time.process_time()
        run()
        seconds.append(time.process_time() - began)
    return min(seconds)


def time_domain_seconds(seed: int) -> tuple[float, float]:
    """CPU time [s] one search takes with a record of 1000 s at 0.1 s for each gain set, exact zero-order hold.

    By a compiled scalar loop, and by scipy's lsim: the time of one record times all evaluations; the sea free of cost.
    """
    settings = GeneticSettings()
    compiled, lsim = record_cost(performance(Preamplifier.WASHOUT).loop, PUBLISHED_VALUES, seed)
    count = settings.generations * settings.population
    return compiled * count, lsim * count


# What beats the published gains: another point of the same three, and two more terms in the controller.

MS_LIMIT = 2.0
SHORT_CRESTED = SeaCondition(spreading=1.0, name="ITTC 3.3 m, short-crested")
_JONSWAP = jonswap(PUBLISHED.height, 2.0 * math.pi / ittc(PUBLISHED.height).modal_frequency)
# seen by no search
HELD_OUT_SEAS = (
    SeaCondition(spectrum=_JONSWAP, name="JONSWAP 3.3 m, 9.1 s, long-crested"),
    SeaCondition(spectrum=_JONSWAP, spreading=1.0, name="JONSWAP 3.3 m, 9.1 s, short-crested"),
    SeaCondition(
        spectrum=bretschneider(PUBLISHED.height, 9.7), spreading=1.0, name="Bretschneider 3.3 m, 9.7 s, short-crested"
    ),
    SeaCondition(spectrum=bretschneider(PUBLISHED.height, 8.0), name="Bretschneider 3.3 m, 8 s, long-crested"),
    SeaCondition(heading=135.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 135°"),
    SeaCondition(heading=45.0, spreading=1.0, name="ITTC 3.3 m, short-crested, 45°"),
    SeaCondition(heading=45.0, name="ITTC 3.3 m, long-crested, 45°"),
)
_INFEASIBLE_COST = 10.0
_MOST_RATE = 1e6  # rad^2/s^2, in the place of infinity
_CORNER = 2.0  # of a box of objectives, over those of the paper's gains, which may lie on the front; chosen
_BAND = (0.05, 0.95)  # shares of the energy: ends of a band that holds 90 % of it; chosen
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


@dataclass(frozen=True)
class HardestSea:
    """Why five gains leave most of the roll in one sea.

    Attributes:
        band, design_band: rad/s, between which 90 % of the roll's energy is met there and in the sea of the search.
        natural: rad/s, of the roll.
        least_ratio: roll variance over the paper's that five gains tuned in that sea alone leave, at Ms <= 2 and no
            more fin rate than the paper's.
    """

    sea: SeaCondition
    band: tuple[float, float]
    design_band: tuple[float, float]
    natural: float
    least_ratio: float


@dataclass(frozen=True, eq=False)
class FiveGainDesign:
    """The controller with five gains, washout.

    Attributes:
        gains: (5,).
        design_seas: results in the two seas of the search.
        held_out_seas: results in others; hardest: of that with the largest roll variance over the paper's.
        three_gains: what three gains reach, in the same two seas and under the same limits.
        rate_ratios: fin-rate variance allowed, over the paper's, (k,).
        roll_ratios: by number of gains, worst roll variance over the paper's in both seas at these rates, (k,).
    """

    gains: Array
    Ms: float
    design_seas: tuple[FiveGainComparison, ...]
    held_out_seas: tuple[FiveGainComparison, ...]
    three_gains: tuple[FiveGainComparison, ...]
    hardest: "HardestSea"
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
        hardest_sea(
            reading, max(held_out, key=lambda compared: compared.roll_ratio).sea, np.random.default_rng([seed, 6])
        ),
        rates,
        roll,
    )


def hardest_sea(preamplifier: Preamplifier, sea: SeaCondition, generator: np.random.Generator) -> HardestSea:
    """Return where the waves of a sea are met, and what five gains can do in it."""
    roll, loop = PUBLISHED_LOOP.disturbance, _five_gain_performance(preamplifier, sea)
    paper = performance(preamplifier, sea).evaluate(PUBLISHED_VALUES).variances[0]

    def cost(points: Array) -> Array:
        evaluated = loop.evaluate(points)
        rate = np.minimum(evaluated.variances[:, 2], _MOST_RATE) / paper[2] - 1.0
        over = np.maximum(rate, evaluated.Ms - MS_LIMIT)
        return np.where(over > 0.0, _INFEASIBLE_COST + over, evaluated.variances[:, 0] / paper[0])

    least = float(cost(_minimise(five_gain_box(preamplifier), cost, generator)[None])[0])
    natural = float(np.sqrt(roll.den[-1] / roll.den[0]))
    return HardestSea(sea, _roll_band(preamplifier, sea), _roll_band(preamplifier, DESIGN_SEA), natural, least)


def _roll_band(preamplifier: Preamplifier, sea: SeaCondition) -> tuple[float, float]:
    """Frequencies of encounter [rad/s] between which 90 % of the energy of the roll lies, with the paper's gains."""
    slope, loop = effective_slope(sea), performance(preamplifier, sea).loop
    response = loop.disturbance.frequency_response(slope.omega_e) / (1.0 + loop.open_loop(slope.omega_e))
    order = np.argsort(slope.omega_e)
    share = np.cumsum((np.abs(response) ** 2 * slope.energy)[order])
    ends = [order[int(np.searchsorted(share, q * share[-1]))] for q in _BAND]
    return float(slope.omega_e[ends[0]]), float(slope.omega_e[ends[1]])


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


# One set of gains for all six conditions of table 1: what "global" would have to mean.


@dataclass(frozen=True, eq=False)
class JointOptimum:
    """Gains searched over all six conditions at once, long-crested, beside the paper's.

    Attributes:
        gains: (3,), of the least larger one of roll and fin-rate variance over the paper's in the worst condition, Ms
            within 2 or the paper's own where that is larger.
        ratios: roll, fin and fin-rate variance over the paper's in each condition, (6, 3); Ms, published_Ms: (6,).
        genetic_ratios: roll, fin and fin-rate variance over the paper's of the published search on the means of its
            objectives over the six, by seed (n, 6, 3); genetic_Ms: worst (n,).
    """

    preamplifier: Preamplifier
    gains: Array
    ratios: Array
    Ms: Array
    published_Ms: Array
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
    seen, peaks = _judge(seas, paper_variances, np.stack([run.gains for run in runs]))
    return JointOptimum(
        preamplifier,
        gains,
        ratios[0],
        Ms[0],
        np.array([float(p.Ms[0]) for p in paper]),
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


# The search as the paper ran it, each individual simulated for 1000 s in steps of 0.1 s; once, in the full study.

_DIVERGED = 1e3  # rad^2, variance from which on a record has run away: far beyond a full turn


@dataclass(frozen=True, eq=False)
class TimeDomainSearch:
    """One search by records of one sea, and the same search by the sea's spectrum.

    Attributes:
        gains: answers by records and by the spectrum, same random numbers, each (3,).
        responses: of both in the spectrum.
        cpu_s: CPU time of both searches, s.
        evaluations: records simulated.
    """

    preamplifier: Preamplifier
    gains: tuple[Array, Array]
    responses: tuple[RollResponse, RollResponse]
    cpu_s: tuple[float, float]
    evaluations: int


def time_domain_search(preamplifier: Preamplifier, seed: int) -> TimeDomainSearch:
    """Search once by 10,000 records of 1000 s in one realised sea, the seed's, and once by its spectrum."""
    of = performance(preamplifier)
    states, slope = state_space(of.loop), wave_slope_record(np.random.default_rng([seed, 10]))

    def by_records(points: Array) -> Array:
        records = (loop_record(states, gains, slope, PUBLISHED.step) for gains in points)
        with np.errstate(over="ignore", invalid="ignore"):
            variances = np.array([record.var(axis=0) for record in records])
        bounded = np.where(np.isfinite(variances) & (variances < _DIVERGED), variances, np.inf)
        return objective_values(bounded, FinObjective.PRINTED)

    def by_spectrum(points: Array) -> Array:
        return objective_values(of.evaluate(points, with_Ms=False).variances, FinObjective.PRINTED)

    runs = [
        genetic_run(objectives, BOX, GeneticSettings(bits=BITS), np.random.default_rng([seed, 0]))
        for objectives in (by_records, by_spectrum)
    ]
    first, second = runs
    return TimeDomainSearch(
        preamplifier,
        (first.gains, second.gains),
        (roll_response(of, first.gains), roll_response(of, second.gains)),
        (first.cpu_s, second.cpu_s),
        first.evaluations,
    )


def wave_slope_record(generator: np.random.Generator) -> Array:
    """Return the effective wave slope [rad] of 1000 s at 0.1 s, 18 kn, 90 deg, long-crested ITTC 3.3 m."""
    beta = math.radians(DESIGN_SEA.heading)
    lines = realise(
        ittc(PUBLISHED.height), DESIGN_SEA.speed * KNOT, beta, generator, count=LINES, spacing=Spacing.JITTERED
    )
    time = np.arange(round(PUBLISHED.record_seconds / PUBLISHED.step) + 1, dtype=np.float64) * PUBLISHED.step
    return response_to_slope(lines, np.ones(len(lines.omega), dtype=np.complex128), np.asarray(time))
