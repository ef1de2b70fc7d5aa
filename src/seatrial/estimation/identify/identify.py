"""A trial in, a fit out: read, check, estimate, predict what was not fitted."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.values import NOTATION, Array, DivergedError, InputError, ProgressReporter, Record
from seatrial.core.values.versions import versions
from seatrial.data.trial import Role, Trial, TrialRecord, load_records, refuse_errors
from seatrial.data.trial.approach import approach_condition
from seatrial.data.trial.roll_decay_start import require_decay
from seatrial.estimation.estimate.fit import Estimation, characteristic_time, estimate_model, is_pure_roll
from seatrial.estimation.estimate.force_consistency import force_consistency
from seatrial.estimation.estimate.settings import (
    INITIAL_STATE_SHIP_LENGTHS,
    WEAK_FORM_SHIP_LENGTHS,
    FitCriterion,
    IntervalMethod,
    Settings,
)
from seatrial.estimation.estimate.singular import refuse_singular
from seatrial.estimation.estimate.unmeasured_waves import refuse_unmeasured_waves
from seatrial.estimation.identify import fit_result
from seatrial.estimation.identify.baselines import with_baselines
from seatrial.estimation.identify.identifiability import identifiability
from seatrial.estimation.identify.model_selection import HOLDOUT_WINDOW_SHIP_LENGTHS as HOLDOUT_WINDOW
from seatrial.estimation.identify.model_selection import SelectedModel, select_model, with_model_spread
from seatrial.estimation.identify.profile import profiles
from seatrial.estimation.identify.roll_characteristics import roll_characteristics
from seatrial.estimation.identify.roll_model_selection import select_roll_model
from seatrial.estimation.identify.seakeeping import seakeeping
from seatrial.estimation.identify.spectral import fit_spectrum
from seatrial.estimation.identify.unknown_waves import fit_in_unknown_waves, is_free_decay, is_roll_in_unknown_waves
from seatrial.estimation.information.frequency_range import frequency_range, frequency_range_finding
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
from seatrial.estimation.predict.predict_runs import predict_runs
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.static_forces import StaticForces

_OFFSET_DEVIATION = {"rad": float(np.radians(2.0)), "m/s": 0.1, "rps": 0.1}
_GAIN_DEVIATION = 0.1
_DELAY_DEVIATION = 0.2


def settings_from_trial(trial: Trial, records: Sequence[Record]) -> Settings:
    """The trial's wishes as settings; offsets without a stated spread get the house's."""
    wishes = trial.estimate
    seconds = wishes.segment_s
    if seconds is None and wishes.segment_lengths:
        seconds = wishes.segment_lengths * characteristic_time(trial.model, records, trial.ship.length)
    units = {name: NOTATION[name].unit for name in wishes.offsets}
    zeros = [(name, "zero", spread or _OFFSET_DEVIATION.get(units[name], 0.1), units[name])
             for name, spread in wishes.offsets.items()]  # fmt: skip
    gains = [(name, "gain", spread or _GAIN_DEVIATION, "1") for name, spread in wishes.gains.items()]
    delays = [(name, "delay", spread or _DELAY_DEVIATION, "s") for name, spread in wishes.delays.items()]
    return Settings(
        criterion=FitCriterion(wishes.criterion), segment_seconds=seconds, robust=wishes.robust,
        noise=dict(trial.noise), channels=wishes.channels, current=wishes.current,
        corrections=(*zeros, *gains, *delays), forces=trial.forces,
    )  # fmt: skip


def _by_role(records: Sequence[TrialRecord], role: Role) -> list[TrialRecord]:
    return [r for r in records if r.role is role]


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
        choose: take the member of the family that predicts runs left out best, not the model as the trial has it.
        compare: put other estimators on the same training runs beside the fit.

    Raises:
        InputError: the records do not pass the checks, show no excitation, cannot tell the parameters apart, or are too
            few for the intervals that are wanted.
    """
    began = time.perf_counter()
    records, findings = load_records(trial)
    findings = refuse_errors(findings, trial.accept)
    rate = trial.estimate.rate
    if rate is not None:
        records = tuple(replace(r, record=r.record.resampled(rate)) for r in records)
    train = _by_role(records, Role.TRAIN)
    if not train:
        raise InputError("the trial has no training run; leave at least one file out of 'validate' and 'leave_out'")
    runs, sessions, length = [r.record for r in train], [r.session for r in train], trial.ship.length
    if any(r.waves is not None and r.waves.spectrum is not None for r in train):
        fit = fit_spectrum(trial, train, findings, seed, began)
        window = WEAK_FORM_SHIP_LENGTHS * characteristic_time(trial.model, runs, length)
        return with_baselines(fit, runs, window) if compare else fit
    settings = replace(settings_from_trial(trial, runs), intervals=intervals, seed=seed)
    forces = tuple(name for points in trial.forces for name in StaticForces(trial.model, points).force_names)
    outputs = compared_outputs(trial.model, runs, settings.channels)
    refuse_unidentifiable(trial.model, outputs, forces)
    symmetries = structural_symmetries(trial.model, outputs, forces)
    found = estimate_model(trial.model, runs, sessions, length, settings, report_progress)
    if settings.criterion is FitCriterion.AUTO and is_roll_in_unknown_waves(found, runs):
        return fit_in_unknown_waves(trial, runs, findings, seed, began)
    if is_free_decay(found, runs):
        for run in runs:
            require_decay(run)
    refuse_unmeasured_waves(found, runs)
    refuse_singular(*_coefficient_information(found))
    untold = fit_result.unidentified(found)
    unit = characteristic_time(trial.model, runs, length, trial.estimate.segment_s)
    others = SelectedModel(found, (), ())
    seconds = trial.estimate.initial_s or INITIAL_STATE_SHIP_LENGTHS * unit
    if choose and is_pure_roll(trial.model):
        kept_out = [r.record for r in _by_role(records, Role.VALIDATE)]
        others = select_roll_model(
            found, trial.model, runs, sessions, kept_out, length, seconds, settings, trial.family, report_progress
        )
    elif choose or intervals is IntervalMethod.JACKKNIFE:
        others = select_model(
            found, trial.model, runs, sessions, length, HOLDOUT_WINDOW * unit, settings, trial.family,
            choose=choose, report_progress=report_progress,
        )  # fmt: skip
    found, tied = others.estimation, others.tied
    try:
        told = predict_runs(found, records, seconds, length, seed, report_progress, tied)
    except DivergedError as error:
        raise InputError(fit_result.divergence_message(found, error)) from None
    found = with_model_spread(found, tied)
    known = identifiability(found, symmetries, approach_condition(runs, found.model), length)
    if intervals is IntervalMethod.PROFILE:
        drawn = profiles(found.estimate, found.interval.standard_error, found.estimate.problem.free, report_progress)
        known = replace(known, profiles=drawn)
    unprofiled = intervals is IntervalMethod.PROFILE and not known.profiles
    said = (*force_consistency(found.estimate), *untold, *fit_result.bounds_hit(found), *fit_result.unconverged(found))
    said += (fit_result.NO_PROFILE,) if unprofiled else ()
    shown = frequency_range(runs, outputs) if trial.model.is_affine else {}
    said += (frequency_range_finding(shown),) if shown else ()
    fit = Fit(
        question=trial.question
        or f"Which {trial.model.name} model explains these records, and how well does it predict?",
        ship=trial.ship,
        model=found.model,
        coefficients=fit_result.coefficients(found, trial.truth, known.profiles),
        covariance=found.interval.covariance[: len(found.estimate.problem.free), : len(found.estimate.problem.free)],
        solution=found.estimate.optimum.solution,
        method=fit_result.method(found),
        offsets=fit_result.offsets(found),
        noise=fit_result.noise(found),
        residuals=fit_result.residuals(found),
        predictions=told.predictions,
        findings=(*findings, *others.findings, *said),
        records=tuple(r.record for r in records),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
        identifiability=known,
        noise_model=found.noise_model,
        candidate_models=others.candidates,
        interval_basis=told.interval_basis,
        seakeeping=seakeeping(found.model, train, length),
        roll=roll_characteristics(found.model, found.interval, found.estimate.problem.free, runs, trial.ship),
    )
    return with_baselines(fit, runs, WEAK_FORM_SHIP_LENGTHS * unit, report_progress) if compare else fit


def _coefficient_information(estimation: Estimation) -> tuple[Array, tuple[str, ...], Array]:
    problem = estimation.estimate.problem
    count = len(problem.free)
    return (
        estimation.estimate.optimum.normal.without_local()[1][:count, :count],
        problem.free,
        estimation.estimate.common_parameters[:count],
    )
