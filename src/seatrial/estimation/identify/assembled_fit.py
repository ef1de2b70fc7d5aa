"""A fit from an estimate: predictions of all runs, identifiability, findings, and what a report shows."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Fit, Identifiability, Posterior, Profile, Seakeeping
from seatrial.core.results.fields import MissingParts
from seatrial.core.values import Finding
from seatrial.core.values.versions import versions
from seatrial.data.trial.records import approach_condition
from seatrial.data.trial.settings import window_lengths
from seatrial.estimation.estimate import Estimation, IntervalMethod
from seatrial.estimation.identify import fit_result
from seatrial.estimation.identify.assumed_values import (
    box_force_findings,
    box_force_shifts,
    differing_runs,
    errors_of,
    estimated_value_shifts,
    with_effects,
    with_estimated_values,
)
from seatrial.estimation.identify.characteristics import (
    gyradius_findings,
    one_speed_finding,
    roll_characteristics,
    thruster_craft,
    unphysical_finding,
)
from seatrial.estimation.identify.identifiability import course_finding, identifiability, stands_on_box
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.instruments import (
    ErrorInformation,
    antenna_findings,
    delay_findings,
    instrument_errors,
    with_undetected_sensor_errors,
)
from seatrial.estimation.identify.model_selection import HOLDOUT_WINDOW_SHIP_LENGTHS, SelectedModel, with_model_spread
from seatrial.estimation.identify.nonlinear_intervals import (
    default_profiles,
    innovation_profiles,
    profiles,
    sample_posterior,
    sampling_findings,
    short_record_findings,
)
from seatrial.estimation.identify.score_test import own_criterion
from seatrial.estimation.identify.step_times import with_open_step_times
from seatrial.estimation.identify.terms import (
    drifting_thrust_finding,
    held_couplings,
    needless_term_findings,
)
from seatrial.estimation.identify.warnings import (
    abandoned_criterion_finding,
    closed_loop_findings,
    misfit_disturbance,
    narrow_band_findings,
    other_optima,
    refuted_prior_findings,
    response_findings,
    second_order_finding,
    short_time_constant_findings,
    untrained_manoeuvre_findings,
)
from seatrial.estimation.information.frequency_response import frequency_responses
from seatrial.estimation.predict.predict_runs import RunPredictions, predict_runs
from seatrial.estimation.predict.session_offsets import horizon_list, k_step_errors


def assembled_fit(task: Identification, selected: SelectedModel, findings: Sequence[Finding] = ()) -> Fit:
    """Return the fit of the model that is used.

    Args:
        findings: on the estimate, from the strategy.

    Raises:
        InputError: a training run cannot be simulated with the estimated coefficients.
    """
    trial, runs = task.trial, task.runs
    selected, posterior = _with_sampling(task, selected)
    predicted = _predictions(task, selected)
    estimation = with_model_spread(selected.estimation, selected.tied)
    approach = approach_condition(runs.records, trial.model)
    assessment = _identifiability(task, estimation, approach, predicted.interval_basis.training_envelope)
    parts = MissingParts()
    shifts = parts.computed("the effect of estimated values", lambda: estimated_value_shifts(estimation), ())
    by_box = parts.computed("the effect of the box's wave forces", lambda: box_force_shifts(estimation, task.train), ())
    given = {name for symmetry in assessment.structural for name in symmetry.parameters}  # said of all coefficients
    spreads = {p.name for p in estimation.model.parameters if p.prior is not None}
    stated = [shift for shift in shifts if shift.name not in given or shift.name in spreads]
    differing = parts.computed("the differences between runs", lambda: differing_runs(estimation), None)
    by_run = [differing.shift(estimation.estimate.problem.free)] if differing else []
    widened = with_estimated_values(estimation, [*stated, *by_box, *by_run])
    widened = parts.computed(
        "errors of instruments in the intervals",
        lambda: with_undetected_sensor_errors(widened, _instrument_errors(task, selected.estimation)), widened,
    )  # fmt: skip
    widened = parts.computed("times of steps in the intervals", lambda: with_open_step_times(widened, task), widened)
    free = estimation.estimate.problem.free
    ends = widened_ends(interval_ends(assessment.profiles, posterior), selected.estimation, widened)
    coefficients = fit_result.coefficients(widened, trial.truth, ends)
    responses = parts.computed(
        "the frequency responses",
        lambda: frequency_responses(estimation.model, predicted.predictions, task.outputs),
        (),
    )
    predicted_runs = {p.record for p in predicted.predictions}
    scored = [r for r in task.records if r.record.name in predicted_runs]
    roll = parts.computed(
        "period, damping and metacentric height of roll",
        lambda: roll_characteristics(estimation.model, estimation.interval, free, runs.records, trial.ship), None,
    )  # fmt: skip
    waves = parts.computed("the motions in waves", lambda: _seakeeping(task, estimation.model), None)
    craft = parts.computed(
        "speed, turn and stop of the craft",
        lambda: thruster_craft(
            estimation.model, runs.records, predicted.interval_basis, trial.ship.particulars.get("L", 1.0),
            [p.measured for p in predicted.predictions if p.role == "validation"],
        ),
        None,
    )  # fmt: skip
    k_steps = parts.computed(
        "the prediction some samples ahead",
        lambda: k_step_errors(selected.estimation, scored, horizon_list(task.options.horizons)), (),
    )  # fmt: skip
    order = parts.computed(
        "the order of the model", lambda: second_order_finding(task, selected.estimation, predicted.predictions), ()
    )
    return Fit(
        question=trial.question
        or f"Which {trial.model.name} model explains these records, and how well does it predict?",
        ship=trial.ship,
        model=estimation.model,
        coefficients=coefficients,
        covariance=estimation.interval.covariance[: len(free), : len(free)],
        solution=estimation.estimate.optimum.solution,
        method=fit_result.method(widened, has_profiles=bool(assessment.profiles)),
        offsets=fit_result.offsets(estimation),
        offset_populations=fit_result.offset_populations(estimation),
        channel_noise=fit_result.noise(estimation),
        residuals=fit_result.residuals(estimation),
        predictions=predicted.predictions,
        findings=(
            *with_effects(task.findings, estimation, shifts), *box_force_findings(by_box, coefficients),
            *selected.findings, *findings, *fit_result.open_signs(estimation.model, coefficients),
            *unphysical_finding(estimation.model, runs.records, errors_of(shifts, free), roll),
            *fit_result.bounds_hit(estimation), *fit_result.unconverged(estimation), *other_optima(estimation),
            *refuted_prior_findings(estimation),
            *abandoned_criterion_finding(estimation, runs.records),
            *(order or parts.computed(
                "the couplings held at zero",
                lambda: held_couplings(
                    selected.estimation, predicted.predictions, runs.records,
                    HOLDOUT_WINDOW_SHIP_LENGTHS * task.resolved_time,
                ), (),
            )),
            *parts.computed(
                "the thrust over the runs", lambda: drifting_thrust_finding(estimation, runs.records), ()
            ),
            *course_finding(estimation.model, assessment.stability, approach),
            *([differing.finding(estimation.model.parameters[differing.name].unit)] if differing else []),
            *misfit_disturbance([p for p in predicted.predictions if p.role == "training"]),
            *short_record_findings(estimation, assessment.profiles), *closed_loop_findings(estimation),
            *(sampling_findings(posterior) if posterior else ()),
            *parts.computed(
                "the terms that predictions do not need",
                lambda: needless_term_findings(estimation, predicted.predictions, assessment.stability), (),
            ),
            *predicted.findings,
            *response_findings(responses),
            *antenna_findings(predicted.predictions, runs.length),
            *narrow_band_findings(predicted.predictions),
            *untrained_manoeuvre_findings(predicted.predictions),
            *short_time_constant_findings(estimation),
            *(() if order else delay_findings(estimation)),
            *one_speed_finding(roll, runs.records),
            *gyradius_findings(trial.ship, roll.gyradius if roll else None),
            *parts.findings,
        ),
        records=tuple(r.record for r in task.records),
        seed=task.options.seed,
        elapsed_s=time.perf_counter() - task.began,
        versions=versions(),
        identifiability=assessment,
        noise_model=estimation.noise_model,
        candidate_models=selected.candidates,
        interval_basis=predicted.interval_basis,
        seakeeping=waves,
        roll=roll,
        search_attempts=estimation.search_attempts,
        thruster_craft=craft,
        posterior=posterior,
        k_step_errors=k_steps,
        frequency_responses=responses,
    )  # fmt: skip


def _seakeeping(task: Identification, model: Model) -> Seakeeping | None:
    """What a linear model moves in the waves of the first run that knows them; None where none does."""
    if not model.is_affine or all(run.waves is None for run in task.train):
        return None
    from seatrial.estimation.identify.waves import seakeeping

    return seakeeping(model, task.train, task.runs.length)


def _instrument_errors(task: Identification, estimation: Estimation) -> ErrorInformation | None:
    """What the records say of errors of instruments by the criterion that is used: the task's own, or another."""
    estimate = own_criterion(estimation)
    if estimate is task.beginning.shooting:
        return task.instrument_errors
    return instrument_errors(estimate, task.runs.records, task.antenna_length, task.settings.delays)


def _with_sampling(task: Identification, selected: SelectedModel) -> tuple[SelectedModel, Posterior | None]:
    """Return the estimate with the interval of draws from its posterior, and these, where sampling is required."""
    if task.options.intervals is not IntervalMethod.SAMPLING:
        return selected, None
    estimation, posterior = sample_posterior(selected.estimation, task.options.seed, task.report_progress)
    return replace(selected, estimation=estimation), posterior


def interval_ends(profiles: Sequence[Profile], posterior: Posterior | None) -> fit_result.Limits:
    """Return the ends of intervals that no standard error gives: by draws, or by profile likelihoods."""
    if posterior is not None:
        return {c.name: (c.lower, c.upper) for c in posterior.coefficients}
    return {p.parameter: (p.lower, p.upper) for p in profiles}


def widened_ends(ends: fit_result.Limits, estimation: Estimation, widened: Estimation) -> fit_result.Limits:
    """Return ends as far farther from the estimate as its standard error has grown: independent errors add as squares.

    Args:
        ends: of intervals that no standard error gives, of `estimation`.
        widened: the same with further errors in its covariance.
    """
    problem, values = estimation.estimate.problem, estimation.estimate.common_parameters
    half_widths = widened.interval.half_width**2 - estimation.interval.half_width**2
    grown = dict(zip(problem.free, np.maximum(half_widths, 0.0).tolist(), strict=False))
    at = dict(zip(problem.free, values.tolist(), strict=False))

    def moved(name: str, end: float | None, side: float) -> float | None:
        distance = 0.0 if end is None else abs(end - at[name])
        return None if end is None else end + side * (math.hypot(distance, math.sqrt(grown[name])) - distance)

    return {n: (moved(n, low, -1.0), moved(n, high, 1.0)) for n, (low, high) in ends.items()}


def _predictions(task: Identification, selected: SelectedModel) -> RunPredictions:
    """Return all runs predicted with the model that is used, intervals without the spread of tied models."""
    return predict_runs(
        selected.estimation, task.records, task.initial_seconds, task.runs.length, task.options.seed,
        task.report_progress, selected.tied, window_lengths(task.options.windows),
        offsets_from_start=task.trial.estimate.offsets_from_start,
    )  # fmt: skip


def _identifiability(
    task: Identification, estimation: Estimation, approach: Mapping[str, float], envelope: Mapping[str, float]
) -> Identifiability:
    """Return what the records determine, with profile likelihoods where these are required."""
    assessment = identifiability(
        estimation, task.symmetries, approach, task.runs.length, stands_on_box(task.trial),
        envelope.get("fastest", math.inf),
    )  # fmt: skip
    return replace(assessment, profiles=_profiles(task, estimation))


def _profiles(task: Identification, estimation: Estimation) -> tuple[Profile, ...]:
    """Return profile likelihoods where these are required, or where the records are too short for anything else."""
    estimate, errors, report_progress = estimation.estimate, estimation.interval.standard_error, task.report_progress
    if task.options.intervals is IntervalMethod.SAMPLING:
        return ()
    if task.options.intervals is not IntervalMethod.PROFILE:
        return default_profiles(estimation, report_progress)
    if estimation.has_process_noise and estimation.process_noise is not None:
        return innovation_profiles(estimation.process_noise, errors, estimate.problem.free, report_progress)
    return profiles(estimate, errors, estimate.problem.free, report_progress)
