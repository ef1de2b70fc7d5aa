"""Gains proposed on board: the sea and the craft that a stretch of record shows, and the gains that suit both."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.control.gain_evaluation import GainEvaluator, exceedance_share
from seatrial.control.schedule import GainSchedule, schedule_conditions
from seatrial.control.task import Effectiveness, ScheduleGrid, Seaway, TuningTask
from seatrial.control.verification.stabiliser import natural_period, prior_deviations
from seatrial.core.results.online import CraftFactor, GainMargins, HeadingRange, Proposal, SeaEstimate
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.results.tuning import OperatingPoint
from seatrial.core.values import Array, Index, InputError
from seatrial.estimation.problem.spectral_likelihood import hann_transform
from seatrial.estimation.sea import (
    BIN_STRIDE,
    HEADING_CELL,
    MotionSpectrum,
    ObservedLeg,
    SeaLikelihood,
    ShipInSea,
    altered_loop,
    draw_ship_in_sea,
    sea_spectrum,
    stretch_spectra,
)
from seatrial.physics.loops import margins

_SAME = 0.01  # relative difference of Ms that other nodes and versions explain; chosen


def refuse_other_craft(task: TuningTask, points: Sequence[OperatingPoint], source: str) -> None:
    """Refuse a schedule that was not tuned for this loop: other gains, or other margins than it was written with.

    source: the schedule's file, in words.

    Raises:
        InputError: it was tuned for another loop.
    """
    names = task.loop.gains.names
    if set(points[0].gains) != set(names):
        raise InputError(
            f"{source} has gains {', '.join(points[0].gains)}, the loop has {', '.join(names)}: they are of two loops; "
            "run 'seatrial tune' on this loop file again"
        )
    for point in (points[0], points[-1]):
        grid = ScheduleGrid((point.U,), (point.beta,), (point.height,))
        evaluator = schedule_conditions(task, grid)[0].evaluator
        Ms = float(evaluator.evaluate(np.array([[point.gains[name] for name in names]])).Ms[0])
        if not math.isclose(Ms, point.Ms, rel_tol=_SAME):
            raise InputError(
                f"{source} says Ms {point.Ms:.3f} at {point.U:.3g} m/s, with this loop file it is {Ms:.3f}: it was "
                "tuned for another craft, or the loop file has changed; run 'seatrial tune' on it again"
            )


# Gains for the sea and the craft at hand: those of the schedule that cost least on average over what both may be.

JUDGED = 40  # draws of sea and craft that gains are judged on; chosen: a 95 % interval leaves out one at each end
_CANDIDATES = 16  # conditions whose gains are compared; chosen
_INSIDE = 0.5  # least share of the draws within the schedule, below which nothing is proposed; chosen
_FRAILEST = 0.95  # share of the draws that must keep the largest Ms: one in twenty may lie beyond; chosen
# largest Ms of those draws over that which the loop file allows of its model: 2.0, the upper end of the usual range
# (Astrom & Hagglund 2006, Advanced PID Control, section 4.6), over the default of 1.6
_MS_RATIO = 1.25
WORTHWHILE = 0.03  # of the mean cost, less than which gains that hold are left as they are; chosen
_MIDDLE_95 = (0.025, 0.5, 0.975)  # quantiles: the ends of a 95 % interval about the median
_ABEAM = 1e-2  # rad from the bow and from astern within which no roll is computed; chosen


@dataclass(frozen=True, eq=False)
class ChosenGains:
    """Gains out of a schedule: values (g,), whether they differ from those before, margins over the draws, reasons."""

    gains: Array
    is_new: bool
    margins: GainMargins
    reasons: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Refusal:
    """Why no gains are proposed, sentence by sentence."""

    reasons: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class JudgedGains:
    """Candidates on every draw, each (draws, n): cost, rms over that without control; Ms; saturation, a share."""

    cost: Array
    Ms: Array
    saturation: Array

    @property
    def mean_cost(self) -> Array:
        """Return the mean over the draws, (n,); infinite where one is unstable."""
        return np.mean(self.cost, axis=0)

    def shortfall(self, k: int, task: TuningTask) -> str:
        """Return which margin a candidate does not keep, in words; nothing where it keeps all."""
        lost = int(np.sum(~np.isfinite(self.Ms[:, k])))
        if lost:
            return f"an unstable loop on {lost} of {len(self.Ms)} draws of the craft"
        frail, largest = float(np.quantile(self.Ms[:, k], _FRAILEST)), _MS_RATIO * task.constraints.Ms
        saturation = float(np.median(self.saturation[:, k]))
        if frail > largest:
            return f"Ms {frail:.2f} on the frailest twentieth of the draws of the craft ({largest:.3g} at most)"
        if saturation > task.constraints.saturation:
            allowed = 100.0 * task.constraints.saturation
            return f"{100.0 * saturation:.0f} % of the actuator's amplitudes beyond its limit ({allowed:.0f} % at most)"
        return ""


def propose_gains(
    task: TuningTask, schedule: GainSchedule, draws: ShipInSea, U: float, current: Array | None
) -> ChosenGains | Refusal:
    """Return the gains of the schedule that fit the draws of sea and craft at a speed U [m/s], or why there are none.

    Candidates are the schedule's gains in the conditions drawn, linear between its own, and `current` (g,), proposed
    before. The one of least mean cost over all draws is taken among those that keep every craft drawn stable, 1.25
    times the task's largest Ms on 95 % of them, and its saturation on half; `current` stays where it keeps them too
    and costs no more than 3 % beyond.
    """
    conditions = np.column_stack([np.full(len(draws.headings), U), draws.headings, np.exp(draws.seas[:, 0])])
    holds = schedule.holds(conditions)
    inside = np.all(holds, axis=1)
    if np.mean(inside) < _INSIDE:
        return Refusal((_outside_text(schedule, conditions, holds),))
    candidates = np.unique(schedule.gains_at(conditions[inside][_spread(int(np.sum(inside)), _CANDIDATES)]), axis=0)
    if current is not None:
        candidates = np.vstack([current, candidates])
    evaluators = [_evaluator(task, draws, k, U) for k in _spread(len(draws.headings), JUDGED).tolist()]
    judged = judged_gains(evaluators, candidates)
    short = [judged.shortfall(k, task) for k in range(len(candidates))]
    cost = judged.mean_cost
    if all(short):
        least = int(np.argmin(np.where(np.isfinite(cost), cost, np.inf)))
        return Refusal((f"no gains of the schedule hold: the best of them has {short[least]}",))
    best = int(np.argmin(np.where([not one for one in short], cost, np.inf)))
    stays = current is not None and not short[0] and cost[0] <= (1.0 + WORTHWHILE) * cost[best]
    chosen = 0 if stays else best
    reasons = (*_reasons(judged, chosen, current is not None, short), *_coverage_text(schedule, conditions, holds))
    is_new = current is None or not np.array_equal(candidates[chosen], current)
    return ChosenGains(
        candidates[chosen], is_new, margins_over(evaluators, judged, chosen, candidates[chosen]), reasons
    )


def _spread(count: int, wanted: int) -> Index:
    """Return places spread evenly over `count` draws, which stand in the order of their generations."""
    return np.unique(np.linspace(0, count - 1, min(wanted, count)).round().astype(int))


def _evaluator(task: TuningTask, draws: ShipInSea, k: int, U: float) -> GainEvaluator:
    """Return the evaluator of one draw of craft and sea."""
    met = next(one for one in task.disturbances if isinstance(one, Seaway))
    beta = float(np.clip(draws.headings[k], _ABEAM, np.pi - _ABEAM))
    sea = replace(met, spectrum=sea_spectrum(draws.seas[k]), U=U, beta=beta, spreading=None)
    loop = altered_loop(task.loop_at(U), draws.ships[k])
    there = replace(
        task, loop=loop, disturbances=(sea,), U=U, effectiveness=Effectiveness.CONSTANT, baselines={},
        extended_structures=(), schedule_grid=None,
    )  # fmt: skip
    return GainEvaluator(there, loop, (task.motion,))


def judged_gains(evaluators: list[GainEvaluator], candidates: Array) -> JudgedGains:
    """Return what candidates (n, g) do on every draw of craft and sea: an evaluator each, the motion first."""
    rows = [(one, one.evaluate(candidates)) for one in evaluators]
    limit = evaluators[0].task.constraints.limit
    return JudgedGains(
        np.array([np.sqrt(np.mean(row.variances[:, :, 3], axis=1) / one.uncontrolled_variance) for one, row in rows]),
        np.array([row.Ms for _, row in rows]),
        np.array(
            [[exceedance_share(limit, v) for v in row.variances[:, :, 1].max(axis=1).tolist()] for _, row in rows]
        ),
    )


def margins_over(evaluators: list[GainEvaluator], judged: JudgedGains, k: int, gains: Array) -> GainMargins:
    every = [margins(one.loop.with_gains(gains)) for one in evaluators]

    def over_draws(value: Callable[[int], float]) -> IntervalEstimate:
        return estimated(np.array([value(i) for i in range(len(every))]))

    return GainMargins(
        Ms=over_draws(lambda i: every[i].Ms),
        gain_margin=over_draws(lambda i: every[i].gain),
        phase_margin=over_draws(lambda i: every[i].phase),
        delay_margin=over_draws(lambda i: every[i].delay),
        reduction=over_draws(lambda i: 1.0 - float(judged.cost[i, k])),
        saturation=over_draws(lambda i: float(judged.saturation[i, k])),
        stable_draws=sum(one.is_stable for one in every),
        draws=len(every),
    )


def estimated(values: Array) -> IntervalEstimate:
    """Return the median of draws (n,) with the ends of their middle 95 %; what is infinite counts as largest."""
    low, middle, high = np.quantile(values, _MIDDLE_95, method="nearest").tolist()
    return IntervalEstimate(middle, low, high)


def _reasons(judged: JudgedGains, chosen: int, had_gains: bool, short: list[str]) -> tuple[str, ...]:
    """Return why these, compared with the others and with those proposed before."""
    cost, left = judged.mean_cost, estimated(judged.cost[:, chosen])
    kept = sum(not one for one in short)
    reasons = [
        f"Of {len(short)} sets of the schedule {kept} keep their margins; this one leaves {100.0 * left.value:.0f} % "
        f"[{100.0 * left.lower:.0f}, {100.0 * left.upper:.0f}] of the motion without control, over {len(judged.cost)} "
        "draws of sea and craft that the stretch allows."
    ]
    if had_gains and chosen == 0:
        reasons.append(f"They were proposed before; no other set leaves {100.0 * WORTHWHILE:.0f} % less.")
    elif had_gains and short[0]:
        reasons.append(f"Those proposed before no longer hold: {short[0]}.")
    elif had_gains:
        reasons.append(f"Those proposed before leave {100.0 * (cost[0] / cost[chosen] - 1.0):.0f} % more.")
    return tuple(reasons)


_QUANTITIES = (("speed", "m/s", 1.0), ("heading to the waves", "deg", 180.0 / math.pi), ("wave height", "m", 1.0))
"""Of a condition: name, unit for people, and that unit in 1 SI (degrees: exact)."""


def _outside_text(schedule: GainSchedule, conditions: Array, holds: NDArray[np.bool_]) -> str:
    """Return which quantity lies outside the schedule most, with its interval and the schedule's range."""
    axis = int(np.argmin(np.mean(holds, axis=0)))
    name, unit, factor = _QUANTITIES[axis]
    value, (first, last) = estimated(factor * conditions[:, axis]), schedule.limits(axis)
    interval = f" [{value.lower:.3g}, {value.upper:.3g}]" if value.upper > value.lower else ""
    return (
        f"the {name}, {value.value:.3g}{interval} {unit}, lies outside the schedule's {factor * first:.3g} to "
        f"{factor * last:.3g} {unit}; tune a schedule that covers it"
    )


def _coverage_text(schedule: GainSchedule, conditions: Array, holds: NDArray[np.bool_]) -> tuple[str, ...]:
    """Return that part of what may be lies outside the schedule, where it does."""
    share = 1.0 - float(np.mean(np.all(holds, axis=1)))
    if share <= 1.0 - _FRAILEST:
        return ()
    sentence = _outside_text(schedule, conditions, holds).removesuffix("; tune a schedule that covers it")
    return (f"With a probability of {100.0 * share:.0f} % {sentence}; gains are taken from inside it.",)


# A stretch of steady speed and heading in, a proposal out: sea, craft and gains, or why there are none.

SEGMENT_PERIODS = 24.0  # natural periods in a segment of those by which gains are regressed; chosen
SHORTEST_PERIODS = 80.0  # natural periods that a stretch must hold: five segments and more; chosen
RATE = 12.0  # samples a natural period that the spectra need; chosen
_LOWEST, _HIGHEST = 0.25, 3.0  # frequencies over the natural one that are looked at; chosen
_QUIET = 4.0  # frequency over the natural one above which there are sensors alone; chosen
_LAST = 0.9  # of the highest frequency, above which there are sensors alone where the samples are slow; chosen
_LEAST_MOTION = math.radians(0.15)  # rms of a motion below which sensors and gusts are as large; chosen
_STILL = 0.02  # of the output's rms, below which the actuator counts as still; chosen
_LEAST_COHERENCE = 0.6  # of the actuator with what any gains of the loop order of the output; chosen
_CELLS = round(math.pi / HEADING_CELL)  # of headings from following to head seas
_GAP = 3  # from a cell to the next of the same range at most, in cells: two between them may be empty; chosen
_PROBABILITY = 0.95  # of the headings that are given
_NARROW = math.radians(45.0)  # width of a range of headings up to which the heading is determined; chosen
_NAMES = ("gain of the actuator", "natural frequency", "damping")


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of record: output and actuator every dt [s], SI, (n, 2), from `start` [s] at a mean speed U [m/s]."""

    start: float
    dt: float
    values: Array
    U: float

    @property
    def stop(self) -> float:
        """Return the time of the last sample [s]."""
        return self.start + self.dt * (len(self.values) - 1)


def look(
    task: TuningTask, schedule: GainSchedule, stretch: Stretch, current: Array | None = None, seed: int = 0
) -> Proposal:
    """Return what is proposed after a stretch; `current`: gains (g,) proposed before.

    Raises:
        InputError: the stretch is too short, or has gaps.
    """
    reason = _why_not(task, stretch)
    if reason:
        return no_proposal(task, stretch.start, stretch.stop, reason, stretch.U)
    observed = _observed(task, stretch)
    coherence = _following(observed, stretch)
    if coherence < _LEAST_COHERENCE:
        reason = (
            f"'{task.loop.actuator}' does not follow '{task.loop.output}' by any gains of this loop (coherence "
            f"{coherence:.2f}): is it the loop that is on, and are both channels positive as the notation has them?"
        )
        return no_proposal(task, stretch.start, stretch.stop, reason, stretch.U)
    rng = np.random.default_rng(seed)
    draws = draw_ship_in_sea(_sea_likelihood(task, stretch, observed), rng)
    choice = propose_gains(task, schedule, draws, stretch.U, current)
    is_chosen = isinstance(choice, ChosenGains)
    return Proposal(
        loop=task.name,
        start=stretch.start,
        stop=stretch.stop,
        gains=dict(zip(schedule.names, choice.gains.tolist(), strict=True)) if is_chosen else {},
        reasons=choice.reasons,
        gain_units={gain.name: gain.unit for gain in task.loop.gains},
        is_new=is_chosen and choice.is_new,
        U=stretch.U,
        sea=sea_estimate(draws),
        craft=tuple(
            CraftFactor(name, estimated(np.exp(column))) for name, column in zip(_NAMES, draws.ships.T, strict=True)
        ),
        margins=choice.margins if is_chosen else None,
    )


def no_proposal(task: TuningTask, start: float, stop: float, reason: str, U: float = math.nan) -> Proposal:
    """Return a proposal without gains, and why."""
    return Proposal(task.name, start, stop, {}, (reason,), U=U)


def _sea_likelihood(task: TuningTask, stretch: Stretch, observed: ObservedLeg) -> SeaLikelihood:
    """Return the likelihood of the stretch in the sea of the task whose height, period and heading are not known."""
    seaway = next(met for met in task.disturbances if isinstance(met, Seaway))
    expected = 2.0 * math.pi / seaway.spectrum.modal_frequency
    motion = _motion_spectrum(task, stretch, observed)
    return SeaLikelihood(motion, task.loop_at(stretch.U), stretch.U, seaway.effect, expected, prior_deviations(task))


def _observed(task: TuningTask, stretch: Stretch) -> ObservedLeg:
    """Return the spectra of segments, by which gains are regressed."""
    period = natural_period(task.loop)
    spectra = stretch_spectra(stretch.values, stretch.dt, SEGMENT_PERIODS * period)
    natural = 2.0 * math.pi / period
    return ObservedLeg(spectra.band_limited(_LOWEST * natural, _HIGHEST * natural), task.loop_at(stretch.U))


def _motion_spectrum(task: TuningTask, stretch: Stretch, observed: ObservedLeg) -> MotionSpectrum:
    """Return the band of the whole stretch's transform in which the craft answers waves, and the noise above it."""
    natural = 2.0 * math.pi / natural_period(task.loop)
    omega, transforms = hann_transform(stretch.values, stretch.dt)
    density = np.abs(transforms[:, 0]) ** 2
    kept = np.flatnonzero((omega >= _LOWEST * natural) & (omega <= _HIGHEST * natural))[::BIN_STRIDE]
    quiet = omega > min(_QUIET * natural, _LAST * float(omega[-1]))
    followed = observed.controller_at(omega[quiet]) * observed.loop.plant.frequency_response(omega[quiet])
    band = omega[kept]
    return MotionSpectrum(
        omega=band,
        step=float(omega[1] - omega[0]),
        density=density[kept],
        controller=observed.controller_at(band),
        independent_actuator=np.interp(band, observed.spectra.omega, observed.independent_actuator),
        noise=float(np.mean(density[quiet] * np.abs(1.0 + followed) ** 2)),
    )


def sea_estimate(draws: ShipInSea) -> SeaEstimate:
    """Return height, period and heading with their intervals."""
    ranges = likeliest_headings(draws.headings)
    return SeaEstimate(
        height=estimated(np.exp(draws.seas[:, 0])),
        period=estimated(np.exp(draws.seas[:, 1])),
        heading=estimated(draws.headings),
        headings=ranges,
        is_heading_determined=len(ranges) == 1 and ranges[0].upper - ranges[0].lower <= _NARROW,
    )


def likeliest_headings(headings: Array) -> tuple[HeadingRange, ...]:
    """Return the fewest degrees of heading that hold 95 % of draws (n,) as ranges, the likeliest first.

    Ranges up to two degrees apart are one.
    """
    edges = np.linspace(0.0, math.pi, _CELLS + 1)
    shares = np.histogram(headings, edges)[0] / len(headings)
    order = np.argsort(-shares, kind="stable")
    cells = np.sort(order[: int(np.searchsorted(np.cumsum(shares[order]), _PROBABILITY)) + 1])
    runs = np.split(cells, np.flatnonzero(np.diff(cells) > _GAP) + 1)
    ends = [(int(run[0]), int(run[-1]) + 1) for run in runs]
    ranges = [HeadingRange(float(edges[i]), float(edges[j]), float(np.sum(shares[i:j]))) for i, j in ends]
    return tuple(sorted(ranges, key=lambda one: -one.probability))


def _why_not(task: TuningTask, stretch: Stretch) -> str:
    """Return why nothing can be estimated of a stretch; nothing where it can."""
    needed = SHORTEST_PERIODS * natural_period(task.loop)
    length = stretch.stop - stretch.start
    if length < needed:
        return f"the stretch takes {length:.0f} s; {needed:.0f} s at one speed and heading are needed"
    rms = float(np.std(stretch.values[:, 0]))
    if rms < _LEAST_MOTION:
        return (
            f"'{task.loop.output}' moves {math.degrees(rms):.2g} deg rms; below {math.degrees(_LEAST_MOTION):.2g} deg "
            "the motion shows too little of sea and craft"
        )
    return ""


def _following(leg: ObservedLeg, stretch: Stretch) -> float:
    """Return the coherence of the actuator with what the leg's gains order; 1 where the actuator stood still."""
    outputs, actuators = np.std(stretch.values, axis=0)
    if actuators < _STILL * outputs:
        return 1.0
    moved = leg.spectra.cross_density(1, 1).real
    return math.sqrt(max(0.0, 1.0 - float(np.sum(leg.independent_actuator) / np.sum(moved))))
