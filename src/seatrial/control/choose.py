"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.choose_by_simulation import choose_by_simulation
from seatrial.control.demand import shortfall
from seatrial.control.gain_choice import GainChoice, motion_and_rate_variances, non_dominated_gains
from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.least_output import least_output_gains
from seatrial.control.task import Demand, TuningTask
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array

CANDIDATE_COUNT = 16  # gains of a front that follow the demand; chosen
# rms whose logarithm is still taken, and range that counts as one: guards against zero
_LEAST_RMS, _LEAST_RANGE = 1e-150, 1e-12
_ROUNDING = 1e-9  # relative, of a rate that counts as kept


@dataclass(frozen=True, eq=False)
class _Candidate:
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
        return _choose_by_demand(task, task.demand, filled, report_progress)
    if task.simulation is not None:
        return choose_by_simulation(task, filled, seed, report_progress)
    best = _compromise(task, _candidates(*filled[0]))
    return GainChoice(best.evaluator, best.gains, best.front_name, (_compromise_reason(task, "the front"),))


def _candidates(judge: GainEvaluator, front: ParetoFront) -> list[_Candidate]:
    """Return gains of a front of which none leaves less of the output at a lower actuator rate."""
    some = non_dominated_gains(judge, front)
    variances = motion_and_rate_variances(judge, some)
    return [_Candidate(judge, front.name, gains, both) for gains, both in zip(some, variances, strict=True)]


def _candidates_by_rate(judge: GainEvaluator, front: ParetoFront) -> list[_Candidate]:
    """Return the gains that leave least of the motion at actuator rates spread evenly over the front, in decades.

    Rates are those of the worst disturbance. Each set is pressed against its rate, so that the candidates are what the
    loop is and not where a search has met its front.
    """
    some = non_dominated_gains(judge, front)
    rates = judge.evaluate(some).variances[:, :, 2].max(axis=1)
    levels = np.geomspace(max(float(rates.min()), _LEAST_RMS), max(float(rates.max()), _LEAST_RMS), CANDIDATE_COUNT)
    made = []
    for level in levels:
        # the share exp(-1/2) of a Rayleigh distribution lies beyond its rms, so that the variance allowed is the level
        within = replace(judge.task.constraints, rate=math.sqrt(level), rate_saturation=math.exp(-0.5))
        evaluator = GainEvaluator(replace(judge.task, constraints=within), judge.loop, (judge.task.motion,))
        made.append(least_output_gains(evaluator, some[rates <= level * (1.0 + _ROUNDING)]))
    both = motion_and_rate_variances(judge, np.array(made))
    return [_Candidate(judge, front.name, gains, row) for gains, row in zip(made, both, strict=True)]


def _compromise_reason(task: TuningTask, candidates: str) -> str:
    decades = "the output's in decades" if task.demand is None else "in decades"
    return (
        f"It is the compromise of {candidates}: nearest to the best of output and actuator at once, each over its "
        f"range, {decades} (least largest distance; Zeleny 1973)."
    )


def _compromise(task: TuningTask, candidates: list[_Candidate]) -> _Candidate:
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
    report_progress: Callable[[str], None],
) -> GainChoice:
    """Return the compromise among those of all fronts that follow the demand in time, without overshooting."""
    tried = [one for judge, front in fronts for one in _candidates_by_rate(judge, front)]
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
        f"{len(keeping)} of {len(tried)} controllers along the fronts follow the demand in the nonlinear model, with "
        f"no more than {100.0 * demand.overshoot:.3g} % of overshoot{in_time}, and keep every ship stable that the fit "
        "allows.",
        _compromise_reason(task, "those"),
    )
    return GainChoice(best.evaluator, best.gains, best.front_name, why)
