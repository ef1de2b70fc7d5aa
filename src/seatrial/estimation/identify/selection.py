"""The model that is used: the trial's own, or the best member of its family, of roll as of manoeuvring."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import CandidateModel
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Record, Severity
from seatrial.data.check.motion import sample_noise
from seatrial.data.trial import EstimateSettings, ModelFamily
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.plausibility import refuse_singular
from seatrial.estimation.estimate.settings import EstimatorOptions, IntervalMethod
from seatrial.estimation.identify.fit_result import refuse_unidentified
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.model_selection import HOLDOUT_WINDOW_SHIP_LENGTHS, SelectedModel, select_model
from seatrial.estimation.identify.roll_characteristics import objections
from seatrial.estimation.identify.warnings import abandoned_criterion_finding
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.models.candidate_structures import OMITTED_PARAMETERS

# Choice of a roll model by runs it was not fitted to: each is predicted open loop from its first seconds on.

TIE_TOLERANCE = 0.1
"""A structure of fewer coefficients is taken where its error is larger than the least one by no more than this part."""

NOISE_FACTOR = 1.2
"""Error of a decay's other half, over what the fit leaves of the first, up to which the model explains it; chosen."""

# rms error over rms roll beyond which no structure predicts anything, ours
_MAX_RESIDUAL_SHARE = 0.5
_ERROR_KEY = "phi_deg"


def roll_structures(model: Model, family: ModelFamily | None) -> dict[str, Model]:
    """Return name -> model, the trial's own first; default ones have fewer coefficients, a declared family's more.

    Raises:
        InputError: there is but one.
    """
    parameters, structures = model.parameters, {"as in the trial": model}
    if family is not None:
        for name, freed in family.structures.items():
            structures[name] = model.with_parameters(parameters.freed(*freed))
    else:
        house = OMITTED_PARAMETERS.get(model.name, {})
        gone = {n for dropped in house.values() for n in dropped if n not in parameters.free_names}
        absent = {n for n in gone if parameters[n].value == 0.0}
        for name, dropped in house.items():
            known = [n for n in dropped if n not in gone]
            if known and absent <= set(dropped):
                structures[name] = model.with_parameters(
                    parameters.with_values(dict.fromkeys(known, 0.0)).fixed(*known)
                )
    if len(structures) < 2:
        raise InputError(
            f"model '{model.name}' has no family to choose from; free more coefficients, or declare [family]"
        )
    return structures


def select_roll_model(
    estimation: Estimation,
    model: Model,
    train: Runs,
    seconds: float,
    settings: EstimateSettings,
    options: EstimatorOptions,
    family: ModelFamily | None,
    report_progress: ProgressReporter | None = None,
) -> SelectedModel:
    """The structure that predicts runs best of those it was not fitted to, or a simpler one that does as well (10 %).

    estimation: the trial's own model fitted to all training runs; seconds: of each run, that give its initial state.

    Raises:
        InputError: there is but one structure, or none predicts anything.
    """
    members = roll_structures(model, family)
    quiet = replace(options, workers=1, intervals=IntervalMethod.AUTO)
    splits = _runs_left_out(train) if len(train) > 1 else (halves(train),)

    def scored(item: tuple[str, Model]) -> _Scored:
        if report_progress:
            report_progress(f"models compared: {item[0]}")
        try:
            complete = estimation if item[1] is model else estimate_model(item[1], train, settings, quiet)
            parts = [estimate_model(item[1], split.fitted, settings, quiet) for split in splits]
            errors = [_roll_error(part, split.judged, seconds) for part, split in zip(parts, splits, strict=True)]
        except InputError as failed:
            return _Scored(np.inf, np.nan, str(failed))
        noise = np.degrees([np.sqrt(np.nanmean(part.residuals**2)) for part in parts])
        return _Scored(
            float(np.mean(errors)), float(np.mean(noise)), ", ".join(objections(complete.model, train.records))
        )

    scores = map_in_threads(scored, list(members.items()), workers=options.workers)
    errors = np.array([s.error for s in scores])
    _refuse_unpredicted(errors, [split.judged for split in splits], scores[0].note)
    free = [len(m.parameters.free) for m in members.values()]
    allowed = np.array([np.isfinite(s.error) and not s.note for s in scores])
    if not np.any(allowed):
        allowed = np.isfinite(errors)
    tied = allowed & (errors <= (1.0 + TIE_TOLERANCE) * errors[allowed].min())
    best = min(np.flatnonzero(tied), key=lambda i: (free[i], errors[i]))
    rows = tuple(
        CandidateModel(name, free[i], None, None, bool(tied[i]), bool(i == best), s.note, _finite_or_none(s.error))
        for i, (name, s) in enumerate(zip(members, scores, strict=True))
    )
    used = (
        estimation
        if best == 0
        else estimate_model(list(members.values())[best], train, settings, options, report_progress)
    )
    return SelectedModel(used, rows, (), _halves_finding(train, rows[best].name, scores[best]))


@dataclass(frozen=True)
class _Scored:
    """Rms error [deg] of what is predicted, and of what it was fitted to; why it failed or must not be taken."""

    error: float
    noise: float
    note: str


@dataclass(frozen=True, eq=False)
class Split:
    """Runs that are fitted, and the one that is predicted then."""

    fitted: Runs
    judged: Record


def _runs_left_out(train: Runs) -> tuple[Split, ...]:
    """Each run in turn, predicted by the others."""
    indices = range(len(train))
    return tuple(Split(train.selected([j for j in indices if j != i]), train.records[i]) for i in indices)


def halves(train: Runs) -> Split:
    """Of the only run, the half of the larger swings is fitted and predicts the other."""
    (record,) = train.records
    middle = len(record.time) // 2
    halves = [record.rows(slice(0, middle)).renamed(f"{record.name}, first half"),
              record.rows(slice(middle, None)).renamed(f"{record.name}, second half")]  # fmt: skip
    smaller, larger = sorted(halves, key=lambda half: float(np.nanstd(half["phi"])))
    return Split(replace(train, records=(larger,)), smaller)


def _halves_finding(train: Runs, name: str, scored: _Scored) -> tuple[Finding, ...]:
    """Return that the model of a single decay does not explain its other half."""
    if len(train) > 1 or scored.error <= NOISE_FACTOR * scored.noise:
        return ()
    sensor = float(np.degrees(sample_noise(train.records[0]["phi"])))
    what = (
        f"fitted to the half of the larger swings, '{name}' misses the other half by {scored.error:.2g} deg, "
        f"{scored.error / scored.noise:.2g} times what it leaves of the first; that is "
        f"{scored.noise / max(sensor, np.finfo(float).tiny):.2g} times the noise from sample to sample"
    )
    advice = (
        "take its damping as a mean over the amplitudes recorded; record a second decay, so that each judges "
        "the other; two decays may differ more than the halves of one"
    )
    return (Finding(Severity.INFO, "half-missed", what, f"'{train.records[0].name}'", advice),)


def _roll_error(estimation: Estimation, record: Record, seconds: float) -> float:
    """Rms [deg] of roll over the whole run."""
    offsets = new_session_offsets(estimation.estimate, record).expected
    run = simulate_open_loop(estimation.estimate.problem, estimation.model, record, offsets, seconds)
    return rms_errors(record, run.record)[_ERROR_KEY]


def _refuse_unpredicted(errors: Array, runs: Sequence[Record], note: str) -> None:
    if not np.any(np.isfinite(errors)):
        raise InputError(f"no member of the family can be fitted; the first fails because {note}")
    moved = float(np.mean([np.degrees(np.nanstd(r["phi"])) for r in runs]))
    if errors.min() > _MAX_RESIDUAL_SHARE * moved:
        raise InputError(
            f"no model predicts the runs left out (rms {errors.min():.2g} deg of {moved:.2g} deg); record the wave "
            "slope alpha_w, or choose by decays in calm water"
        )


def _finite_or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


# The model that is used: the trial's own, or the best member of its family; with the models tied with it.


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
    if task.choose and not model.has_course:
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
