"""A trial in, a fit out: records read and checked, their situation recognised, its strategy followed."""

import time
from collections.abc import Callable, Mapping
from types import MappingProxyType

from seatrial.core.results import Fit
from seatrial.core.values import InputError, ProgressReporter
from seatrial.data.trial import FitCriterion, Trial, checked_records
from seatrial.estimation.estimate import EstimatorOptions, IntervalMethod
from seatrial.estimation.estimate.settings import WEAK_FORM_SHIP_LENGTHS
from seatrial.estimation.identify.baselines import with_baselines
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.situation import Situation, is_explained, situation_of
from seatrial.estimation.identify.strategies.recorded_waves import identify_in_recorded_waves
from seatrial.estimation.identify.strategies.roll import identify_driven_roll, identify_free_decay
from seatrial.estimation.identify.strategies.steered import identify_steered, identify_with_static_forces
from seatrial.estimation.identify.strategies.unknown_waves import identify_in_unknown_waves
from seatrial.estimation.identify.strategies.wave_spectrum import identify_by_wave_spectrum

STRATEGIES: Mapping[Situation, Callable[[Identification], Fit]] = MappingProxyType({
    Situation.STEERED: identify_steered,
    Situation.STATIC_FORCES: identify_with_static_forces,
    Situation.RECORDED_WAVES: identify_in_recorded_waves,
    Situation.WAVE_SPECTRUM: identify_by_wave_spectrum,
    Situation.UNKNOWN_WAVES: identify_in_unknown_waves,
    Situation.FREE_DECAY: identify_free_decay,
    Situation.DRIVEN_ROLL: identify_driven_roll,
})  # fmt: skip
"""The strategy of each situation."""


def identify(
    trial: Trial,
    seed: int = 0,
    report_progress: ProgressReporter | None = None,
    *,
    intervals: IntervalMethod = IntervalMethod.AUTO,
    choose: bool = False,
    compare: bool = False,
) -> Fit:
    """Estimate the trial's model from its training runs and predict its validation runs open loop, with intervals.

    Args:
        seed: of the draws behind the intervals of predictions, and of a bootstrap.
        intervals: where intervals of coefficients come from; a jackknife brings the spread of tied models with it.
        choose: whether the best member of the family takes the place of the trial's model.
        compare: whether regressions on the same training runs are compared with the fit.

    Raises:
        InputError: the records do not pass the checks, show no excitation, do not determine the coefficients, or are
            too few for the intervals that are required.
    """
    began = time.perf_counter()
    checked = checked_records(trial)
    if trial.estimate.method.is_published:
        raise InputError(f"method '{trial.estimate.method}' is offered by studies only as yet; leave [estimate] method")
    options = EstimatorOptions(intervals, seed)
    task = Identification(trial, checked.records, checked.findings, options, choose, began, report_progress)
    situation = identification_situation(task)
    fit = STRATEGIES[situation](task)
    if not compare or situation is Situation.UNKNOWN_WAVES:  # no input, so that there is nothing to regress on
        return fit
    window = WEAK_FORM_SHIP_LENGTHS * task.characteristic_time
    return with_baselines(fit, task.runs.records, window, report_progress)


def identification_situation(task: Identification) -> Situation:
    """Return the situation of the training runs.

    Raises:
        InputError: there is no training run, or roll without inputs cannot be estimated.
    """
    if not task.train:
        raise InputError("the trial has no training run; leave at least one file out of 'validate' and 'leave_out'")
    return situation_of(
        task.trial.model,
        task.train,
        has_force_points=bool(task.trial.forces),
        is_criterion_free=task.settings.criterion is FitCriterion.AUTO,
        is_explained=lambda: is_explained(task.estimation.shooting),
    )
