"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.demand import shortfall
from seatrial.control.front import spread_points
from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.seaway_simulation import simulate_in_seaway
from seatrial.control.task import TuningTask
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array
from seatrial.numerics.optimise import non_dominated

CANDIDATE_COUNT = 8  # gains of a front that are simulated; chosen
MAX_SATURATION_LOSS = 0.03  # reduction lost to the actuator's limits, as a share of one; chosen
# seas of the selection, and their distance from the seeds of the final simulations; chosen
_SELECTION_SEEDS, _SELECTION_SEED_OFFSET = 8, 100_000
# reductions that differ less count as equal; share of the permitted loss used in the selection; chosen
_EQUAL_REDUCTION, _LOSS_MARGIN = 0.003, 0.85
# rms whose logarithm is still taken, and range that counts as one: guards against zero
_LEAST_RMS, _LEAST_RANGE = 1e-150, 1e-12


@dataclass(frozen=True, eq=False)
class GainChoice:
    """The evaluator of the chosen loop, its gains (g,), the name of the front they come from, and why."""

    evaluator: GainEvaluator
    gains: Array
    front_name: str
    reasons: tuple[str, ...]


def choose(
    task: TuningTask,
    fronts: tuple[tuple[GainEvaluator, ParetoFront], ...],
    seed: int,
    report_progress: Callable[[str], None],
) -> GainChoice:
    """Return the recommendation, from fronts that are not empty."""
    filled = tuple((judge, front) for judge, front in fronts if len(front.gains))
    if task.demand is not None:
        return _choose_by_demand(task, filled[0], report_progress)
    if task.simulation is not None:
        return _choose_by_simulation(task, filled, seed, report_progress)
    judge, front = filled[0]
    some = _non_dominated_gains(judge, front)
    reasons = (_compromise_reason(task, "the front"),)
    return GainChoice(judge, some[_compromise_order(judge, some)[0]], front.name, reasons)


def _compromise_reason(task: TuningTask, candidates: str) -> str:
    decades = "the output's in decades" if task.demand is None else "in decades"
    return (
        f"It is the compromise of {candidates}: nearest to the best of output and actuator at once, each over its "
        f"range, {decades} (least largest distance; Zeleny 1973)."
    )


def _non_dominated_gains(evaluator: GainEvaluator, front: ParetoFront) -> Array:
    """Return gains of the front of which none leaves less of the output at a lower actuator rate, by output, (n, g)."""
    both = _output_and_rate_variances(evaluator, front.gains)
    first = non_dominated(both)
    return front.gains[first[np.argsort(both[first, 0])]]


def _output_and_rate_variances(evaluator: GainEvaluator, gains: Array) -> Array:
    """Return variances of output and actuator rate, means over what the loop meets, (n, 2)."""
    return evaluator.evaluate(gains).variances[:, :, [0, 2]].mean(axis=1)


def _compromise_order(evaluator: GainEvaluator, gains: Array) -> list[int]:
    """Order of some gains by their largest distance from the best, rms of output against rms of actuator rate.

    In decades; the rate as it is where no demand is followed: there gains of zero are on the front, decades from any.
    """
    both = np.sqrt(_output_and_rate_variances(evaluator, gains))
    decades = slice(0, 1 if evaluator.task.demand is None else 2)
    both[:, decades] = np.log(np.maximum(both[:, decades], _LEAST_RMS))
    far = (both - both.min(axis=0)) / np.maximum(np.ptp(both, axis=0), _LEAST_RANGE)
    return np.argsort(far.max(axis=1), kind="stable").tolist()


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A candidate simulated: mean reduction with limits, with and without stall, points lost to limits, rms rate."""

    evaluator: GainEvaluator
    gains: Array
    front_name: str
    reduction: float
    saturation_loss: float
    rate: float


def _choose_by_simulation(
    task: TuningTask,
    fronts: tuple[tuple[GainEvaluator, ParetoFront], ...],
    seed: int,
    report_progress: Callable[[str], None],
) -> GainChoice:
    """The candidate that reduces the motion most in simulation with the actuator's limits, losing little to them."""
    assert task.simulation is not None
    few = replace(task, simulation=replace(task.simulation, seeds=_SELECTION_SEEDS))

    def simulated(judge: GainEvaluator, front: ParetoFront, gains: Array) -> _Candidate:
        made = simulate_in_seaway(few, judge.loop, "candidate", gains, seed + _SELECTION_SEED_OFFSET)
        reduction = 0.5 * float(np.mean(made.limited) + np.mean(made.stalled))
        rate = float(judge.evaluate(gains[None]).variances[0, :, 2].mean())
        return _Candidate(judge, gains, front.name, reduction, made.saturation_loss, rate)

    tried: list[_Candidate] = []
    for judge, front in fronts:
        some = _non_dominated_gains(judge, front)
        near = some[np.unique(np.linspace(0, len(some) - 1, CANDIDATE_COUNT).astype(int))]
        for around in ("along the front", "about the best"):
            made = [simulated(judge, front, gains) for gains in near]
            tried += made
            report_progress(f"choice: {front.name}, {len(made)} candidates {around} simulated")
            near = _neighbouring_gains(some, _best_candidate(made).gains)
    best = _best_candidate(tried)
    reasons = (
        f"Of {len(tried)} controllers along the fronts it reduces the motion most when simulated within the actuator's "
        f"limits, with and without stall, whose law is assumed (mean {100.0 * best.reduction:.1f} % on "
        f"{_SELECTION_SEEDS} seas kept for the choice); of equals it moves the actuator least.",
        f"It loses {100.0 * best.saturation_loss:.1f} points of reduction to angle and rate limits there; a loss of "
        f"{100.0 * MAX_SATURATION_LOSS:.0f} points or more is not recommended.",
    )
    return GainChoice(best.evaluator, best.gains, best.front_name, reasons)


def _best_candidate(candidates: list[_Candidate]) -> _Candidate:
    """The best reduction of those that lose little, else of all; of equals the one that moves the actuator least."""
    keeping = [one for one in candidates if one.saturation_loss < _LOSS_MARGIN * MAX_SATURATION_LOSS] or candidates
    most = max(one.reduction for one in keeping)
    return min((one for one in keeping if one.reduction >= most - _EQUAL_REDUCTION), key=lambda one: one.rate)


def _neighbouring_gains(candidates: Array, gains: Array) -> Array:
    """Return gains between the neighbours, a candidate's distance away, of one of `candidates`, (n, g)."""
    place = int(np.argmin(np.abs(candidates - gains).max(axis=1)))
    step = max(len(candidates) // CANDIDATE_COUNT, 1)
    low, high = max(place - step, 0), min(place + step, len(candidates) - 1)
    return candidates[np.unique(np.linspace(low, high, CANDIDATE_COUNT).astype(int))]


def _choose_by_demand(
    task: TuningTask, fronts: tuple[GainEvaluator, ParetoFront], report_progress: Callable[[str], None]
) -> GainChoice:
    """Return the compromise among those that follow the demand without overshooting, in simulation."""
    assert task.demand is not None
    judge, front = fronts
    some = _non_dominated_gains(judge, front)
    some = some[spread_points(_output_and_rate_variances(judge, some), 2 * CANDIDATE_COUNT)]
    short = []
    for gains in some:
        short.append(shortfall(task, judge.loop, gains))
        report_progress(f"choice: {len(short)} of {len(some)} candidates carried through the demand")
    keeping = some[np.array([far == 0.0 for far, _ in short])]
    if not len(keeping):
        least = min(range(len(some)), key=lambda i: short[i][0])
        why = (f"No candidate follows the demand as asked; this one comes nearest, but {short[least][1]}.",)
        return GainChoice(judge, some[least], front.name, why)
    why = (
        f"{len(keeping)} of {len(some)} controllers along the front follow the demand in the nonlinear model, with no "
        f"more than {100.0 * task.demand.overshoot:.3g} % of overshoot, and keep every ship stable that the fit "
        "allows.",
        _compromise_reason(task, "those"),
    )
    return GainChoice(judge, keeping[_compromise_order(judge, keeping)[0]], front.name, why)
