"""A trial in, a fit out: read, check, estimate, predict what was not fitted."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.values import NOTATION, Array, DivergedError, InputError, Progress, Record
from seatrial.core.values.versions import versions
from seatrial.data.trial import Role, Trial, TrialRecord, records_of, refuse_errors
from seatrial.data.trial.approach import approach_of
from seatrial.data.trial.release import refuse_undecayed
from seatrial.estimation.estimate.agreement import agreement
from seatrial.estimation.estimate.fit import Identified, identified, swings, unit_of_time
from seatrial.estimation.estimate.settings import (
    START_SECONDS_LENGTHS,
    WINDOW_SHIP_LENGTHS,
    Criterion,
    Intervals,
    Settings,
)
from seatrial.estimation.estimate.singular import refuse_singular
from seatrial.estimation.estimate.unmeasured import refuse_unmeasured_waves
from seatrial.estimation.identify import outcome
from seatrial.estimation.identify.compare import with_rivals
from seatrial.estimation.identify.family import WINDOW_SHIP_LENGTHS as FAMILY_WINDOW
from seatrial.estimation.identify.family import Considered, considered, with_ensemble
from seatrial.estimation.identify.identifiability import identifiability
from seatrial.estimation.identify.profile import profiles
from seatrial.estimation.identify.rolling import rolling
from seatrial.estimation.identify.seakeeping import seakeeping
from seatrial.estimation.identify.spectral import spectral_fit
from seatrial.estimation.identify.swinging import chosen_by_runs
from seatrial.estimation.identify.unknown_waves import fit_in_unknown_waves, is_free_decay, is_rolled_by_unknown_waves
from seatrial.estimation.information.frequency_range import frequency_range, represented
from seatrial.estimation.information.symmetries import refuse_structural, structural
from seatrial.estimation.predict.forecast import forecast
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.static_forces import StaticForces

_OFFSET_SPREAD = {"rad": float(np.radians(2.0)), "m/s": 0.1, "rps": 0.1}
_GAIN_SPREAD = 0.1
_DELAY_SPREAD = 0.2


def settings_of(trial: Trial, records: Sequence[Record]) -> Settings:
    """The trial's wishes as settings; offsets without a stated spread get the house's."""
    wishes = trial.estimate
    seconds = wishes.segment_s
    if seconds is None and wishes.segment_lengths:
        seconds = wishes.segment_lengths * unit_of_time(trial.model, records, trial.ship.length)
    units = {name: NOTATION[name].unit for name in wishes.offsets}
    zeros = [(name, "zero", spread or _OFFSET_SPREAD.get(units[name], 0.1), units[name])
             for name, spread in wishes.offsets.items()]  # fmt: skip
    gains = [(name, "gain", spread or _GAIN_SPREAD, "1") for name, spread in wishes.gains.items()]
    delays = [(name, "delay", spread or _DELAY_SPREAD, "s") for name, spread in wishes.delays.items()]
    return Settings(
        criterion=Criterion(wishes.criterion), segment_seconds=seconds, robust=wishes.robust,
        noise=dict(trial.noise), channels=wishes.channels, current=wishes.current,
        corrections=(*zeros, *gains, *delays), forces=trial.forces,
    )  # fmt: skip


def _by_role(records: Sequence[TrialRecord], role: Role) -> list[TrialRecord]:
    return [r for r in records if r.role is role]


def identify(
    trial: Trial,
    seed: int = 0,
    progress: Progress | None = None,
    *,
    intervals: Intervals = Intervals.AUTO,
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
    records, findings = records_of(trial)
    findings = refuse_errors(findings, trial.accept)
    rate = trial.estimate.rate
    if rate is not None:
        records = tuple(replace(r, record=r.record.resampled(rate)) for r in records)
    train = _by_role(records, Role.TRAIN)
    if not train:
        raise InputError("the trial has no training run; leave at least one file out of 'validate' and 'leave_out'")
    runs, sessions, length = [r.record for r in train], [r.session for r in train], trial.ship.length
    if any(r.waves is not None and r.waves.spectrum is not None for r in train):
        fit = spectral_fit(trial, train, findings, seed, began)
        window = WINDOW_SHIP_LENGTHS * unit_of_time(trial.model, runs, length)
        return with_rivals(fit, runs, window) if compare else fit
    settings = replace(settings_of(trial, runs), intervals=intervals, seed=seed)
    forces = tuple(name for points in trial.forces for name in StaticForces(trial.model, points).names)
    outputs = compared_outputs(trial.model, runs, settings.channels)
    refuse_structural(trial.model, outputs, forces)
    symmetries = structural(trial.model, outputs, forces)
    found = identified(trial.model, runs, sessions, length, settings, progress)
    if settings.criterion is Criterion.AUTO and is_rolled_by_unknown_waves(found, runs):
        return fit_in_unknown_waves(trial, runs, findings, seed, began)
    if is_free_decay(found, runs):
        for run in runs:
            refuse_undecayed(run)
    refuse_unmeasured_waves(found, runs)
    refuse_singular(*_data_and_prior(found))
    untold = outcome.untold(found)
    unit = unit_of_time(trial.model, runs, length, trial.estimate.segment_s)
    others = Considered(found, (), ())
    seconds = trial.estimate.initial_s or START_SECONDS_LENGTHS * unit
    if choose and swings(trial.model):
        kept_out = [r.record for r in _by_role(records, Role.VALIDATE)]
        others = chosen_by_runs(
            found, trial.model, runs, sessions, kept_out, length, seconds, settings, trial.family, progress
        )
    elif choose or intervals is Intervals.JACKKNIFE:
        others = considered(
            found, trial.model, runs, sessions, length, FAMILY_WINDOW * unit, settings, trial.family,
            choose=choose, progress=progress,
        )  # fmt: skip
    found, tied = others.found, others.tied
    try:
        told = forecast(found, records, seconds, length, seed, progress, tied)
    except DivergedError as error:
        raise InputError(outcome.not_sailed(found, error)) from None
    found = with_ensemble(found, tied)
    known = identifiability(found, symmetries, approach_of(runs, found.model), length)
    if intervals is Intervals.PROFILE:
        drawn = profiles(found.made, found.interval.standard_error, found.made.problem.free, progress)
        known = replace(known, profiles=drawn)
    unprofiled = intervals is Intervals.PROFILE and not known.profiles
    said = (*agreement(found.made), *untold, *outcome.bounds_hit(found), *outcome.unconverged(found))
    said += (outcome.NO_PROFILE,) if unprofiled else ()
    shown = frequency_range(runs, outputs) if trial.model.is_affine else {}
    said += (represented(shown),) if shown else ()
    fit = Fit(
        question=trial.question
        or f"Which {trial.model.name} model explains these records, and how well does it predict?",
        ship=trial.ship,
        model=found.model,
        coefficients=outcome.coefficients(found, trial.truth, known.profiles),
        covariance=found.interval.covariance[: len(found.made.problem.free), : len(found.made.problem.free)],
        solution=found.made.optimum.solution,
        method=outcome.method(found),
        offsets=outcome.offsets(found),
        noise=outcome.noise(found),
        residuals=outcome.residuals(found),
        predictions=told.predictions,
        findings=(*findings, *others.findings, *said),
        records=tuple(r.record for r in records),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
        identifiability=known,
        disturbance=found.disturbance,
        family=others.rows,
        margin=told.margin,
        seakeeping=seakeeping(found.model, train, length),
        rolling=rolling(found.model, found.interval, found.made.problem.free, runs, trial.ship),
    )
    return with_rivals(fit, runs, WINDOW_SHIP_LENGTHS * unit, progress) if compare else fit


def _data_and_prior(found: Identified) -> tuple[Array, tuple[str, ...], Array]:
    problem = found.made.problem
    count = len(problem.free)
    return found.made.optimum.normal.reduced()[1][:count, :count], problem.free, found.made.shared[:count]
