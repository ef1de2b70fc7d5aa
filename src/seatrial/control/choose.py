"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

from collections.abc import Callable

import numpy as np

from seatrial.control.choose_by_simulation import choose_by_simulation
from seatrial.control.demand import shortfall
from seatrial.control.front import spread_points
from seatrial.control.gain_choice import GainChoice, non_dominated_gains, output_and_rate_variances
from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.task import TuningTask
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array

CANDIDATE_COUNT = 16  # gains of a front that follow the demand; chosen
# rms whose logarithm is still taken, and range that counts as one: guards against zero
_LEAST_RMS, _LEAST_RANGE = 1e-150, 1e-12


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
        return choose_by_simulation(task, filled, seed, report_progress)
    judge, front = filled[0]
    some = non_dominated_gains(judge, front)
    reasons = (_compromise_reason(task, "the front"),)
    return GainChoice(judge, some[_compromise_order(judge, some)[0]], front.name, reasons)


def _compromise_reason(task: TuningTask, candidates: str) -> str:
    decades = "the output's in decades" if task.demand is None else "in decades"
    return (
        f"It is the compromise of {candidates}: nearest to the best of output and actuator at once, each over its "
        f"range, {decades} (least largest distance; Zeleny 1973)."
    )


def _compromise_order(evaluator: GainEvaluator, gains: Array) -> list[int]:
    """Order of some gains by their largest distance from the best, rms of output against rms of actuator rate.

    In decades; the rate as it is where no demand is followed: there gains of zero are on the front, decades from any.
    """
    both = np.sqrt(output_and_rate_variances(evaluator, gains))
    decades = slice(0, 1 if evaluator.task.demand is None else 2)
    both[:, decades] = np.log(np.maximum(both[:, decades], _LEAST_RMS))
    far = (both - both.min(axis=0)) / np.maximum(np.ptp(both, axis=0), _LEAST_RANGE)
    return np.argsort(far.max(axis=1), kind="stable").tolist()


def _choose_by_demand(
    task: TuningTask, fronts: tuple[GainEvaluator, ParetoFront], report_progress: Callable[[str], None]
) -> GainChoice:
    """Return the compromise among those that follow the demand without overshooting, in simulation."""
    assert task.demand is not None
    judge, front = fronts
    some = non_dominated_gains(judge, front)
    some = some[spread_points(output_and_rate_variances(judge, some), CANDIDATE_COUNT)]
    short = []
    for gains in some:
        short.append(shortfall(task, judge.loop, gains))
        report_progress(f"choice of gains: {len(short)} of {len(some)} candidates tried on the demand")
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
