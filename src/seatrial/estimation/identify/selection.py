"""The model that is used: the trial's own, or the best member of its family; with the models tied with it."""

from seatrial.estimation.estimate import IntervalMethod
from seatrial.estimation.estimate.singular import refuse_singular
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.abandoned_criterion import abandoned_criterion_finding
from seatrial.estimation.identify.fit_result import refuse_unidentified
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.model_selection import HOLDOUT_WINDOW_SHIP_LENGTHS, SelectedModel, select_model
from seatrial.estimation.identify.roll_model_selection import select_roll_model


def selected_model(task: Identification) -> SelectedModel:
    """Return the estimate that is used.

    Raises:
        InputError: the records do not determine the coefficients, or the family that is to be chosen from cannot be
            compared.
    """
    estimation = task.estimation
    problem = estimation.estimate.problem
    count = len(problem.free)
    hessian = estimation.estimate.optimum.normal.without_local()[1][:count, :count]
    refuse_singular(hessian, problem.free, estimation.estimate.common_parameters[:count])
    refuse_unidentified(estimation, abandoned_criterion_finding(estimation, task.runs.records))
    model, family = task.trial.model, task.trial.family
    if task.choose and is_pure_roll(model):
        return select_roll_model(
            estimation, model, task.runs, task.initial_seconds, task.settings, task.options, family,
            task.report_progress,
        )  # fmt: skip
    if task.choose or task.options.intervals is IntervalMethod.JACKKNIFE:
        window = HOLDOUT_WINDOW_SHIP_LENGTHS * task.characteristic_time
        return select_model(
            estimation, model, task.runs, window, task.settings, task.options, family,
            choose=task.choose, report_progress=task.report_progress,
        )  # fmt: skip
    return SelectedModel(estimation, (), ())
