"""A trial in, a fit out: records read and checked, their situation recognised, its strategy followed."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from seatrial.core.results import Fit
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, InputError, ProgressReporter
from seatrial.data.check.phases import begins_before_release
from seatrial.data.trial import EstimateMethod, FitCriterion, Role, Trial, checked_records
from seatrial.data.trial.records import require_decay
from seatrial.data.trial.settings import window_lengths
from seatrial.estimation.estimate import EstimatorOptions, IntervalMethod
from seatrial.estimation.estimate.criterion_choice import is_explained
from seatrial.estimation.estimate.fit import refuse_roll_in_unmeasured_waves, refuse_unmeasured_waves
from seatrial.estimation.estimate.plausibility import OutsidePhysicsError
from seatrial.estimation.estimate.point_estimate import force_consistency
from seatrial.estimation.estimate.settings import weak_form_half_width
from seatrial.estimation.identify.assembled_fit import assembled_fit
from seatrial.estimation.identify.identification import (
    Identification,
    Situation,
    sensor_error_finding,
    situation_of,
    with_detected_sensor_errors,
    with_likelier_courses,
    with_sensors_of,
    with_timed_readings,
)
from seatrial.estimation.identify.model_selection import selected_model
from seatrial.estimation.identify.step_times import with_step_times
from seatrial.estimation.identify.warnings import single_order_findings, with_unexcited_thrust_held
from seatrial.estimation.information.frequency_response import frequency_range, frequency_range_finding
from seatrial.estimation.predict.session_offsets import horizon_list

# A ship in waves whose forces, or whose elevation, were recorded.


def identify_in_recorded_waves(task: Identification) -> Fit:
    """Return the fit of a ship in recorded waves: output error over whole runs, with the range of frequencies covered.

    Raises:
        InputError: the ship moves although no wave is recorded, or the records do not determine the coefficients.
    """
    from seatrial.estimation.identify.waves import contradicted_waves

    try:
        refuse_unmeasured_waves(task.estimation, task.runs.records)
        selected = selected_model(task)
    except InputError as error:
        contradicted = contradicted_waves(task)
        cause = f"; {contradicted.message}; {contradicted.evidence}" if contradicted else ""
        raise InputError(f"{error}{cause}") from None
    is_white = task.estimation.whiteness.is_white and not task.estimation.has_process_noise
    contradicted = None if is_white else contradicted_waves(task)
    findings = [*force_consistency(selected.estimation.estimate), *([contradicted] if contradicted else [])]
    fit = assembled_fit(task, selected, findings)
    if not task.trial.model.is_affine:
        return fit
    covered = frequency_range(task.runs.records, task.outputs)
    return replace(fit, findings=(*fit.findings, frequency_range_finding(covered))) if covered else fit


# A ship in waves of which the spectrum is known, or nothing.


def _identify_by_wave_spectrum(task: Identification) -> Fit:
    from seatrial.estimation.identify.waves import identify_by_wave_spectrum

    return identify_by_wave_spectrum(task)


def _identify_in_unknown_waves(task: Identification) -> Fit:
    from seatrial.estimation.identify.waves import identify_in_unknown_waves

    return identify_in_unknown_waves(task)


# A ship that rolls about its rest: out from a release, or by recorded inputs.


def identify_free_decay(task: Identification) -> Fit:
    """Return the fit of roll decays, which their initial states explain.

    Raises:
        InputError: a roll that does not decay, one that begins before its release and that no initial state explains,
            or records that do not determine the coefficients.
    """
    for record in task.runs.records:
        require_decay(record)
    late = [record.name for record in task.runs.records if begins_before_release(record)]
    if late and not is_explained(task.estimation.shooting):
        raise InputError(
            f"no initial state explains the roll of {enumeration(late)}, which begins before the release of the ship; "
            "set from_release = true under [[records]], which drops what lies before it"
        )
    return assembled_fit(task, selected_model(task))


def identify_driven_roll(task: Identification) -> Fit:
    """Return the fit of roll that recorded inputs drive.

    Raises:
        InputError: waves that nobody recorded roll the ship, or the records do not determine the coefficients, or lead
            to no model that can be simulated.
    """
    refuse_roll_in_unmeasured_waves(task.estimation, task.runs.records)
    return assembled_fit(task, selected_model(task))


# A ship that is steered, with or without static force points.


def identify_steered(task: Identification) -> Fit:
    """Return the fit of a steered ship: multiple shooting, then output or prediction error by the decision table.

    Raises:
        InputError: the records do not determine the coefficients, or lead to no model that can be simulated.
    """
    return assembled_fit(task, selected_model(task))


def identify_with_static_forces(task: Identification) -> Fit:
    """Return the fit of a steered ship to runs and static force points, with their consistency as findings.

    Raises:
        InputError: as `identify_steered`.
    """
    selected = selected_model(task)
    return assembled_fit(task, selected, force_consistency(selected.estimation.estimate))


STRATEGIES: Mapping[Situation, Callable[[Identification], Fit]] = MappingProxyType({
    Situation.STEERED: identify_steered,
    Situation.STATIC_FORCES: identify_with_static_forces,
    Situation.RECORDED_WAVES: identify_in_recorded_waves,
    Situation.WAVE_SPECTRUM: _identify_by_wave_spectrum,
    Situation.UNKNOWN_WAVES: _identify_in_unknown_waves,
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
    windows: str = "",
    horizons: str = "",
) -> Fit:
    """Estimate the trial's model from its training runs and predict its validation runs open loop, with intervals.

    A published method that the trial names gives no intervals; the package's own estimate stands in the fit with it.

    Args:
        seed: of the draws behind the intervals of predictions, of a bootstrap, and of sampling.
        intervals: where intervals of coefficients come from; a jackknife brings the spread of tied models with it;
            sampling brings the draws with it, and is refused where the waves were not recorded.
        choose: whether the best member of the family takes the place of the trial's model.
        compare: whether regressions on the same training runs, for a linear model searches as well, are compared with
            the fit, and the terms that Lasso selects with its own.
        windows: in which validation runs are predicted as well, as ``10s,5L``; empty: as the trial has them, else by
            the length of the run.
        horizons: of the k-step errors, samples or seconds, as ``1,10,5s``; empty: by the length of the runs.

    Raises:
        InputError: the records do not pass the checks, show no excitation, do not determine the coefficients, or are
            too few for the intervals that are required.
    """
    began = time.perf_counter()
    method = trial.estimate.method
    own_progress = report_progress
    if method.is_published or trial.estimate.search is not None:
        from seatrial.estimation.identify.search import check_search_settings, own_estimate_progress, refuse_options

        check_search_settings(trial)
        refuse_options(method, choose=choose, compare=compare)
        own_progress = own_estimate_progress(report_progress)
    checked = checked_records(trial)
    window_lengths(windows)  # what is misspelt is refused before the fit
    horizon_list(horizons)
    options = EstimatorOptions(intervals, seed, windows=windows or trial.estimate.windows, horizons=horizons)
    train = [r.record for r in checked.records if r.role is Role.TRAIN]
    model, held = with_unexcited_thrust_held(trial.model, train)
    held = (*held, *single_order_findings(model, train))
    trial, findings = replace(trial, model=model), (*checked.findings, *held)
    task = Identification(trial, checked.records, findings, options, choose, began, own_progress)
    situation = identification_situation(task)
    _refuse_sampling(intervals, situation, method)
    if method.is_published:
        from seatrial.estimation.identify.search import identify_by_published_method

        return identify_by_published_method(task, situation, STRATEGIES[situation], report_progress)
    errors: tuple[Finding, ...] = ()
    if situation is Situation.STEERED:
        task, errors = _with_inputs_and_instruments(task)
    fit = STRATEGIES[situation](task)
    fit = replace(fit, method=replace(fit.method, name=method.value), findings=(*errors, *fit.findings))
    if not compare or situation is Situation.UNKNOWN_WAVES:  # no input, so that there is nothing to regress on
        return fit
    from seatrial.estimation.identify.baselines import with_baselines, with_search_baselines, with_term_selection

    window = weak_form_half_width(task.trial.model, task.runs.records, task.resolved_time)
    fit = with_baselines(fit, task.runs.records, window, report_progress, trial.compare.svr)
    if trial.model.is_affine and situation is Situation.RECORDED_WAVES:
        fit = with_search_baselines(fit, trial, seed, report_progress)
    return with_term_selection(fit, task.runs.records, window)


def _with_inputs_and_instruments(task: Identification) -> tuple[Identification, tuple[Finding, ...]]:
    """The task with inputs as they ran between samples, and with the errors of instruments that its records show."""
    task = with_timed_readings(task)
    timed = with_step_times(task)
    sensed, detected = with_detected_sensor_errors(with_likelier_courses(task) if timed is task else timed)
    if not detected:
        return sensed, ()
    if timed is not task:  # times of steps stand on what the instruments show
        sensed = with_step_times(with_sensors_of(task, sensed))
    return sensed, (sensor_error_finding(sensed.estimation, detected),)


def _refuse_sampling(intervals: IntervalMethod, situation: Situation, method: EstimateMethod) -> None:
    """Raises:
    InputError: draws are required of a fit that has no likelihood of its own runs.
    """
    if intervals is not IntervalMethod.SAMPLING:
        return
    if method.is_published:
        raise InputError(
            f"method '{method}' gives no intervals, so that there is nothing to sample; leave out --intervals sampling"
        )
    if situation in (Situation.WAVE_SPECTRUM, Situation.UNKNOWN_WAVES):
        raise InputError("--intervals sampling needs what moves the ship in every sample, and here the waves were not "
                         "recorded; leave the choice of intervals to the program")  # fmt: skip


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
        is_explained=lambda: _is_explained_by_its_start(task),
    )


def _is_explained_by_its_start(task: Identification) -> bool:
    """Whether the initial states explain the motion; a search that they lead outside physics says that they do not."""
    try:
        return is_explained(task.estimation.shooting)
    except OutsidePhysicsError:
        return False
