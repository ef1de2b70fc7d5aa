"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, reduce
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.special import stdtrit

from seatrial.control.controller import shortfall
from seatrial.control.front import rate_curve
from seatrial.control.gain_evaluation import (
    ON_BOUND,
    GainChoice,
    GainEvaluation,
    GainEvaluator,
    NamedGains,
    exceedance_share,
    gains_on_bound,
    least_output_gains,
    motion_and_rate_variances,
    spread_gains,
)
from seatrial.control.simulation import seaway_reductions
from seatrial.control.task import Demand, TuningTask
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array, DivergedError
from seatrial.physics.loops import delay_margin
from seatrial.physics.loops.objective import ENERGY

# The choice of a stabiliser: optima at rates of the actuator and with more margin, all through the same seas.

MAX_SATURATION_LOSS = 0.03  # reduction lost to the actuator's limits, as a share of one; chosen
# seas after which candidates are left out, all in the end, and how long each is [s]: many short ones, as each has an
# actuator of its own; and how far their seeds lie from those of the final simulations; chosen
_HEATS, _SEA_SECONDS, _SELECTION_SEED_OFFSET = (3, 6, 20), 250.0, 100_000
# reductions that differ less count as equal; share of the permitted loss used in the selection; chosen
_EQUAL_REDUCTION, _LARGEST_LOSS = 0.003, 0.85 * MAX_SATURATION_LOSS
_ABOUT = 7  # rates between the neighbours of the best one, that one among them; chosen
_CONFIDENCE = 0.95  # level of the paired interval within which a benefit is none; chosen
_SAFER_MS, _EQUAL_MS = (1.3, 1.45), 0.05  # caps of designs with more margin; Ms that count as equal; chosen
# reduction of a loop that runs away with an actuator of the spread: the motion at least doubles; chosen
_RUN_AWAY = -1.0
_LEAST_SHARE = 1e-12  # of amplitudes beyond a limit; guards the logarithm
ROBUST, HARD_WORKING = "robust", "hard-working"
"""Names of the two designs that stand beside the chosen one."""


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A candidate simulated in some seas.

    Attributes:
        limited, stalled: reductions in each sea with the actuator's limits, without and with stall, (seeds,).
        linear: those without limits, simulated at the first call: only the loss to the limits needs them.
        effort: energy if an objective, else variance of the rate.
        is_on_bound: whether a gain lies on a bound of the search that is not zero.
        is_delay_kept: whether the delay margin is long enough.
    """

    evaluator: GainEvaluator
    gains: Array
    front_name: str
    limited: Array
    stalled: Array
    linear: Callable[[], Array]
    effort: float
    Ms: float
    is_on_bound: bool
    is_delay_kept: bool

    @cached_property
    def reductions(self) -> Array:
        """Mean of with and without stall, (seeds,)."""
        return 0.5 * (self.limited + self.stalled)

    @property
    def reduction(self) -> float:
        """Mean over the seas."""
        return float(np.mean(self.reductions))

    @cached_property
    def losses(self) -> Array:
        """Reduction lost to angle and rate limits, (seeds,)."""
        return self.linear() - self.limited

    @property
    def is_loss_small(self) -> bool:
        """Whether little is lost to the actuator's limits."""
        return float(np.mean(self.losses)) < _LARGEST_LOSS


@dataclass(frozen=True, eq=False)
class _SelectionSeas:
    """The seas in which the candidates of a task are compared: the same ones for all; seed: of the first."""

    task: TuningTask
    seed: int

    def candidate(self, judge: GainEvaluator, front_name: str, gains: Array) -> _Candidate:
        """Return gains (g,) as a candidate that has met no sea yet."""
        judged, loop, none = judge.evaluate(gains[None]), judge.loop, np.empty(0)
        speeds = dict.fromkeys(met.U for met in self.task.disturbances)
        delays = [delay_margin(self.task.loop_at(U, loop).with_gains(gains)) for U in speeds]
        return _Candidate(
            judge, gains, front_name, none, none, lambda: none, _effort(judge, judged), float(judged.Ms[0]),
            bool(gains_on_bound(loop, gains)), min(delays) >= self.task.constraints.delay,
        )  # fmt: skip

    @cached_property
    def _heats(self) -> list[tuple[TuningTask, int]]:
        """The task with the seas of each heat, and the seed of the first of them."""
        trials = self.task.simulation
        assert trials is not None
        short = replace(trials, duration=min(trials.duration, _SEA_SECONDS))
        return [
            (replace(self.task, simulation=replace(short, seeds=last - first)), self.seed + first)
            for first, last in pairwise((0, *_HEATS))
        ]

    def tried(self, candidate: _Candidate) -> _Candidate:
        """Return the candidate in all seas."""
        return reduce(_after_heat, self._heats, candidate)

    def raced(self, candidates: Sequence[_Candidate]) -> list[_Candidate]:
        """Return those in all seas among which the best one of all is.

        After each heat those that surely reduce less than the best are left out (Maron & Moore 1994, Hoeffding
        races, Adv. Neural Inf. Process. Syst. 6; here by paired differences). Of those left before the last heat the
        one that reduces most meets all seas, then those that come before it, until one reduces as much.
        """
        *few, others = self._heats
        equals = list(candidates)
        for heat in few:
            equals = _equals([_after_heat(candidate, heat) for candidate in equals])
        most = _first_kept(equals, _reduction_first)
        tried = [_after_heat(most, others)]
        for candidate in sorted(equals, key=_preference):
            if candidate is most:
                winner = tried[0]
            else:
                tried.append(winner := _after_heat(candidate, others))
            if winner in _equals(tried) and winner.is_loss_small:
                break
        return tried


def _after_heat(one: _Candidate, heat: tuple[TuningTask, int]) -> _Candidate:
    """Return a candidate that has met the seas of one more heat."""
    task, seed = heat
    assert task.simulation is not None

    def reductions(stages: slice) -> Array:
        return seaway_reductions(task, one.evaluator.loop, one.gains, seed, stages).T

    try:
        limited, stalled = reductions(slice(1, None))
    except DivergedError:
        limited = stalled = np.full(task.simulation.seeds, _RUN_AWAY)
    return replace(
        one, limited=np.concatenate([one.limited, limited]), stalled=np.concatenate([one.stalled, stalled]),
        linear=cache(lambda: np.concatenate([one.linear(), *reductions(slice(1))])),
    )  # fmt: skip


def choose_by_simulation(
    task: TuningTask,
    fronts: tuple[tuple[GainEvaluator, ParetoFront], ...],
    seed: int,
    report_progress: Callable[[str], None],
) -> GainChoice:
    """The candidate that reduces the motion most in simulation, with the most margin where others do as well."""
    seas, tried, count = _SelectionSeas(task, seed + _SELECTION_SEED_OFFSET), list[_Candidate](), 0
    for judge, front in fronts:
        curve = rate_curve(judge, seed)
        levels = curve.levels
        for around in ("along the front", "about the best"):
            optima = curve.gains_at(levels)
            made = seas.raced([seas.candidate(judge, front.name, gains) for gains in optima])
            tried += made
            count += len(optima)
            report_progress(f"choice of gains: {front.name}, {len(optima)} candidates {around} simulated")
            best = _best_candidate(made).gains
            levels = _levels_about(levels, int(np.flatnonzero((optima == best).all(axis=1))[0]))
        best = _best_candidate(tried)
        safer = [_gains_with_margin(judge, tried, best, Ms, seed) for Ms in _SAFER_MS if Ms < task.constraints.Ms]
        tried += [seas.tried(seas.candidate(judge, front.name, gains)) for gains in safer]
        count += len(safer)
        report_progress(f"choice of gains: {front.name}, {len(safer)} with more margin simulated")
    best = _best_candidate(tried)
    reasons = (
        f"Of {count} controllers, least motion at rates of the actuator, none surely reduces the motion more "
        f"within the limits, with and without stall: mean {100.0 * best.reduction:.1f} % on {_HEATS[-1]} "
        "realisations kept for the choice. Of equals it has the most margin. The law of stall is assumed. Rate, dead "
        "time and stall of the actuator are drawn about the declared or logged ones.",
        f"It loses {100.0 * np.mean(best.losses):.1f} points of reduction to angle and rate limits there; a loss of "
        f"{100.0 * MAX_SATURATION_LOSS:.0f} points or more is not recommended.",
    )
    return GainChoice(best.evaluator, best.gains, best.front_name, reasons, _designs(tried, best))


def _effort(evaluator: GainEvaluator, evaluated: GainEvaluation) -> float:
    """Return the energy of one set of gains where the task makes that small, else the variance of the rate."""
    names = [objective.name for objective in evaluator.objectives]
    if ENERGY in names:
        return float(evaluated.objectives[0, names.index(ENERGY)])
    return float(evaluated.variances[0, :, 2].mean())


def _gains_with_margin(judge: GainEvaluator, tried: list[_Candidate], like: _Candidate, Ms: float, seed: int) -> Array:
    """Return gains (g,) that leave least of the output within that Ms, with no more actuator than another uses.

    tried: candidates to begin from beside spread gains; terms that their loop lacks have no gain.
    """
    task, worst = judge.task, like.evaluator.evaluate(like.gains[None]).variances[0, :, 1:3].max(axis=0)
    limits = task.constraints
    amplitudes, rates = (
        min(share, max(exceedance_share(limit, float(used)), _LEAST_SHARE))
        for share, limit, used in zip(
            (limits.saturation, limits.rate_saturation), (limits.limit, limits.rate), worst, strict=True
        )
    )
    within = replace(limits, Ms=Ms, saturation=amplitudes, rate_saturation=rates)
    evaluator = replace(judge.within(within), objectives=(task.motion,))
    named = [dict(zip(one.evaluator.loop.gains.names, one.gains.tolist(), strict=True)) for one in tried]
    known = np.array([[gains.get(name, 0.0) for name in judge.loop.gains.names] for gains in named])
    near = [known[i] for i, one in enumerate(tried) if one is like]
    return least_output_gains(evaluator, np.concatenate([spread_gains(evaluator, seed), known]), near)


def _best_candidate(candidates: list[_Candidate]) -> _Candidate:
    """Of those that surely reduce no less than the best one: off the bounds of the search, then with the least Ms."""
    return _first_kept(_equals(candidates), _preference)


def _preference(one: _Candidate) -> tuple[bool, int, float]:
    """Return the order of those that reduce the motion as much."""
    return one.is_on_bound, round(one.Ms / _EQUAL_MS), one.effort


def _reduction_first(one: _Candidate) -> float:
    """Return the order by reduction."""
    return -one.reduction


def _equals(candidates: list[_Candidate]) -> list[_Candidate]:
    """Return those that surely reduce no less than the best one that loses little to the actuator's limits."""
    some = _in_time(candidates)
    most = _first_kept(some, _reduction_first)
    return [one for one in some if _benefit(most, one) <= _EQUAL_REDUCTION]


def _in_time(candidates: list[_Candidate]) -> list[_Candidate]:
    """Return those with the delay margin; all where there is none."""
    return [one for one in candidates if one.is_delay_kept] or candidates


def _first_kept(candidates: list[_Candidate], key: Callable[[_Candidate], Any]) -> _Candidate:
    """Return the first by a key that loses little to the actuator's limits; the first where none does."""
    in_order = sorted(candidates, key=key)
    return next((one for one in in_order if one.is_loss_small), in_order[0])


def _benefit(one: _Candidate, other: _Candidate) -> float:
    """Return by how much `one` surely reduces more than `other`: lower end of the paired interval (Student 1908)."""
    return _lower_end(one.reductions - other.reductions)


def _lower_end(values: Array) -> float:
    """Return the lower end of the interval of the mean of values (n,)."""
    n = len(values)
    return float(np.mean(values) - stdtrit(n - 1, 0.5 + 0.5 * _CONFIDENCE) * np.std(values, ddof=1) / math.sqrt(n))


def _designs(tried: list[_Candidate], chosen: _Candidate) -> tuple[NamedGains, ...]:
    """Return the best one with Ms of 1.3 at most, and the one that reduces most whatever its margin, if others."""
    some = _in_time(tried)
    with_margin = [one for one in some if one.Ms <= _SAFER_MS[0] + _EQUAL_MS]
    hard = _first_kept(some, _reduction_first)
    robust = _first_kept(with_margin, _reduction_first) if with_margin else chosen
    named = {ROBUST: robust, HARD_WORKING: hard}
    return tuple(NamedGains(name, one.evaluator, one.gains) for name, one in named.items() if not _is_same(one, chosen))


def _is_same(one: _Candidate, other: _Candidate) -> bool:
    return one.front_name == other.front_name and bool(np.allclose(one.gains, other.gains, rtol=ON_BOUND))


def _levels_about(levels: Array, place: int) -> Array:
    """Return rates between the neighbours of one of `levels`, without those themselves and without it."""
    low, high = levels[max(place - 1, 0)], levels[min(place + 1, len(levels) - 1)]
    return np.setdiff1d(np.linspace(low, high, _ABOUT + 2)[1:-1], levels)


# One controller out of the fronts, with reasons: by simulation where there is one, else the compromise.

# rms whose logarithm is still taken, and range that counts as one: guards against zero
_LEAST_RMS, _LEAST_RANGE = 1e-150, 1e-12


@dataclass(frozen=True, eq=False)
class _DemandCandidate:
    """Gains (g,) of a front; variances: of the motion that counts and the actuator rate, (2,)."""

    evaluator: GainEvaluator
    front_name: str
    gains: Array
    variances: Array


def choose(
    task: TuningTask,
    fronts: tuple[tuple[GainEvaluator, ParetoFront], ...],
    seed: int,
    report_progress: Callable[[str], None],
) -> GainChoice:
    """Return the recommendation, from fronts that are not empty."""
    filled = tuple((judge, front) for judge, front in fronts if len(front.gains))
    if task.demand is not None:
        return _choose_by_demand(task, task.demand, filled, seed, report_progress)
    if task.simulation is not None:
        return choose_by_simulation(task, filled, seed, report_progress)
    judge, front = filled[0]
    curve = rate_curve(judge, seed)
    tried = _candidates(judge, front.name, curve.gains_at(curve.levels))
    about = _levels_about(curve.levels, tried.index(_compromise(task, tried)))
    best = _compromise(task, [*tried, *_candidates(judge, front.name, curve.gains_at(about))])
    return GainChoice(best.evaluator, best.gains, best.front_name, (_compromise_reason(task, "the front"),))


def _candidates(judge: GainEvaluator, name: str, gains: Array) -> list[_DemandCandidate]:
    """Return gains (n, g) of a front as candidates."""
    both = motion_and_rate_variances(judge, gains)
    return [_DemandCandidate(judge, name, row_gains, row) for row_gains, row in zip(gains, both, strict=True)]


def _compromise_reason(task: TuningTask, candidates: str) -> str:
    decades = "the output's in decades" if task.demand is None else "in decades"
    return (
        f"It is the compromise of {candidates}: nearest to the best of output and actuator at once, each over its "
        f"range, {decades} (least largest distance; Zeleny 1973)."
    )


def _compromise(task: TuningTask, candidates: list[_DemandCandidate]) -> _DemandCandidate:
    """Return the one of least largest distance from the best, rms of output against rms of actuator rate.

    In decades; the rate as it is where no demand is followed: there gains of zero are on the front, decades from any.
    """
    both = np.sqrt([one.variances for one in candidates])
    decades = slice(0, 1 if task.demand is None else 2)
    both[:, decades] = np.log(np.maximum(both[:, decades], _LEAST_RMS))
    far = (both - both.min(axis=0)) / np.maximum(np.ptp(both, axis=0), _LEAST_RANGE)
    return candidates[int(np.argmin(far.max(axis=1)))]


def _choose_by_demand(
    task: TuningTask,
    demand: Demand,
    fronts: tuple[tuple[GainEvaluator, ParetoFront], ...],
    seed: int,
    report_progress: Callable[[str], None],
) -> GainChoice:
    """Return the compromise among those of all fronts that follow the demand in time, without overshooting."""
    curves = [(judge, front.name, rate_curve(judge, seed)) for judge, front in fronts]
    tried = [
        candidate
        for judge, name, curve in curves
        for candidate in _candidates(judge, name, curve.gains_at(curve.levels))
    ]
    short = []
    for one in tried:
        short.append(shortfall(task, one.evaluator.loop, one.gains))
        report_progress(f"choice of gains: {len(short)} of {len(tried)} candidates tried on the demand")
    keeping = [one for one, (far, _) in zip(tried, short, strict=True) if far == 0.0]
    if not keeping:
        least = min(range(len(tried)), key=lambda i: short[i][0])
        why = (f"No candidate follows the demand as asked; this one comes nearest, but {short[least][1]}.",)
        return GainChoice(tried[least].evaluator, tried[least].gains, tried[least].front_name, why)
    best = _compromise(task, keeping)
    in_time = f", settled within {demand.settling:.3g} s" if math.isfinite(demand.settling) else ""
    why = (
        f"{len(keeping)} of {len(tried)} controllers, least motion at rates of the actuator, follow the demand in the "
        f"nonlinear model, with no more than {100.0 * demand.overshoot:.3g} % of overshoot{in_time}, and keep every "
        "ship stable that the fit allows.",
        _compromise_reason(task, "those"),
    )
    return GainChoice(best.evaluator, best.gains, best.front_name, why)
