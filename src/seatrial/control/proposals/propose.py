"""Gains for the sea and the craft at hand: those of the schedule that cost least on average over what both may be."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.control.gain_evaluation import GainEvaluator, exceedance_share
from seatrial.control.proposals.gain_schedule import GainSchedule
from seatrial.control.task import Effectiveness, Seaway, TuningTask
from seatrial.core.results.online import Estimated, GainMargins
from seatrial.core.values import Array, Index
from seatrial.estimation.sea import ShipInSea, altered_loop, sea_spectrum
from seatrial.physics.loops import margins

JUDGED = 40  # draws of sea and craft that gains are judged on; chosen: a 95 % interval leaves out one at each end
_CANDIDATES = 16  # conditions whose gains are compared; chosen
_INSIDE = 0.5  # least share of the draws within the schedule, below which nothing is proposed; chosen
_FRAILEST = 0.95  # share of the draws that must keep the largest Ms: one in twenty may lie beyond; chosen
# largest Ms of those draws over that which the loop file allows of its model: 2.0, the upper end of the usual range
# (Astrom & Hagglund 2006, Advanced PID Control, section 4.6), over the default of 1.6
_MS_RATIO = 1.25
_WORTHWHILE = 0.03  # of the mean cost, less than which gains that hold are left as they are; chosen
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
class _Judged:
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
    judged = _judged(evaluators, candidates)
    short = [judged.shortfall(k, task) for k in range(len(candidates))]
    cost = judged.mean_cost
    if all(short):
        least = int(np.argmin(np.where(np.isfinite(cost), cost, np.inf)))
        return Refusal((f"no gains of the schedule hold: the best of them has {short[least]}",))
    best = int(np.argmin(np.where([not one for one in short], cost, np.inf)))
    stays = current is not None and not short[0] and cost[0] <= (1.0 + _WORTHWHILE) * cost[best]
    chosen = 0 if stays else best
    reasons = (*_reasons(judged, chosen, current is not None, short), *_coverage_text(schedule, conditions, holds))
    is_new = current is None or not np.array_equal(candidates[chosen], current)
    return ChosenGains(candidates[chosen], is_new, _margins(evaluators, judged, chosen, candidates[chosen]), reasons)


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


def _judged(evaluators: list[GainEvaluator], candidates: Array) -> _Judged:
    rows = [(one, one.evaluate(candidates)) for one in evaluators]
    limit = evaluators[0].task.constraints.limit
    return _Judged(
        np.array([np.sqrt(row.objectives[:, 0] / one.uncontrolled_variance) for one, row in rows]),
        np.array([row.Ms for _, row in rows]),
        np.array([[exceedance_share(limit, v) for v in row.variances[:, 0, 1].tolist()] for _, row in rows]),
    )


def _margins(evaluators: list[GainEvaluator], judged: _Judged, k: int, gains: Array) -> GainMargins:
    every = [margins(one.loop.with_gains(gains)) for one in evaluators]

    def over_draws(value: Callable[[int], float]) -> Estimated:
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


def estimated(values: Array) -> Estimated:
    """Return the median of draws (n,) with the ends of their middle 95 %; what is infinite counts as largest."""
    low, middle, high = np.quantile(values, _MIDDLE_95, method="nearest").tolist()
    return Estimated(middle, low, high)


def _reasons(judged: _Judged, chosen: int, had_gains: bool, short: list[str]) -> tuple[str, ...]:
    """Return why these, compared with the others and with those proposed before."""
    cost, left = judged.mean_cost, estimated(judged.cost[:, chosen])
    kept = sum(not one for one in short)
    reasons = [
        f"Of {len(short)} sets of the schedule {kept} keep their margins; this one leaves {100.0 * left.value:.0f} % "
        f"[{100.0 * left.lower:.0f}, {100.0 * left.upper:.0f}] of the motion without control, over {len(judged.cost)} "
        "draws of sea and craft that the stretch allows."
    ]
    if had_gains and chosen == 0:
        reasons.append(f"They were proposed before; no other set leaves {100.0 * _WORTHWHILE:.0f} % less.")
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
