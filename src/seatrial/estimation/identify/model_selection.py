"""Choice of the model that is used by cross-validation over whole runs, and the spread of models that are tied."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import CandidateModel
from seatrial.core.values import Array, Finding, InputError, Prior, ProgressReporter, Record, Severity
from seatrial.data.check.motion import sample_noise
from seatrial.data.trial import EstimateSettings, ModelFamily
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.plausibility import refuse_singular
from seatrial.estimation.estimate.point_estimate import COLOUR_ROUNDS, PointEstimate, fit_output_error
from seatrial.estimation.estimate.settings import EstimatorOptions, IntervalMethod
from seatrial.estimation.identify.characteristics import objections
from seatrial.estimation.identify.fit_result import refuse_unidentified
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.score_test import holdout_scores
from seatrial.estimation.identify.warnings import abandoned_criterion_finding
from seatrial.estimation.information.whiteness import is_no_worse, standard_error
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.models.candidate_structures import (
    FREED_PARAMETERS,
    OMITTED_PARAMETERS,
    PRIOR_FACTORS,
    SEGMENT_FACTORS,
    with_terms,
)
from seatrial.physics.models.registry import family_of

# Choice of a model by cross-validation over whole runs, and the spread of the models that the runs cannot distinguish.

HOLDOUT_WINDOW_SHIP_LENGTHS = 4.0
"""Length of the windows in which runs left out are predicted, in ship lengths travelled."""

FREED_PRIOR_SHARE = 0.1
"""Prior standard deviation of a parameter that a structure frees, over its characteristic size."""

_ALIKE = 1e-3  # share of an error below which a difference is none, however regular; chosen


@dataclass(frozen=True)
class ModelVariant:
    """What distinguishes a member: parameters freed beyond the model's, factors on priors and on segment length.

    parent: name of the member that it extends; empty: the trial's own model extends none.
    """

    name: str
    freed: tuple[str, ...] = ()
    prior_factor: float = 1.0
    segment_factor: float = 1.0
    parent: str = ""


@dataclass(frozen=True, eq=False)
class FittedVariant:
    """A member fitted to all training runs.

    Attributes:
        estimate: None where the fit failed, with the reason in `note`.
        scores: (runs, 2), mean rms over the windows of each run left out: heading [deg], position [m].
        objections: why it must not be chosen, though it may predict well.
    """

    variant: ModelVariant
    model: Model
    estimate: PointEstimate | None
    scores: Array
    note: str = ""
    objections: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SelectedModel:
    """The fit that is used after the family was compared, the family's table, and the models tied with it."""

    estimation: Estimation
    candidates: tuple[CandidateModel, ...]
    tied: tuple[PointEstimate, ...]
    findings: tuple[Finding, ...] = ()


def select_model(
    estimation: Estimation,
    model: Model,
    runs: Runs,
    window_s: float,
    settings: EstimateSettings,
    options: EstimatorOptions,
    family: ModelFamily | None,
    *,
    choose: bool,
    report_progress: ProgressReporter | None = None,
) -> SelectedModel:
    """Compare the family and take its best where it is to be chosen; where it cannot be compared, say why.

    Raises:
        InputError: a member is to be chosen and the family cannot be compared.
    """
    try:
        fitted = fit_variants(
            estimation, model, runs, window_s, settings, options, family, report_progress, choose=choose
        )
    except InputError as error:
        if choose:
            raise
        what = "intervals are without the spread of tied models: the family of models cannot be compared"
        return SelectedModel(estimation, (), (), (Finding(Severity.INFO, "no-comparison", what, str(error)),))
    rows = rank_candidates(fitted, choose=choose)
    used = selected_estimation(estimation, fitted, rows, runs, settings, options, report_progress)
    findings = _choice_findings(fitted, rows) if choose else _better_candidate_warning(rows)
    return SelectedModel(used, rows, tied_models(fitted, rows), findings)


def _choice_findings(fitted: Sequence[FittedVariant], rows: Sequence[CandidateModel]) -> tuple[Finding, ...]:
    """Return that the chosen model's error is the least of several, and which members were not taken, and why."""
    names = f"{len(rows)} models were compared on the same runs left out"
    what = (
        f"{names}: the error of the one that was chosen, '{next(r.name for r in rows if r.is_chosen)}', is optimistic"
    )
    advice = "judge it by a run that took no part in the choice: name one under 'validate'"
    findings = [Finding(Severity.INFO, "several-looks", what, f"{len(rows)} looks", advice)]
    refused = [f"'{f.variant.name}': {', '.join(f.objections)}" for f in fitted if f.objections]
    if refused:
        advice = "fix these parameters or narrow their priors under [model.priors], and choose again"
        is_every = len(refused) == sum(f.estimate is not None for f in fitted)
        severity = Severity.WARNING if is_every else Severity.INFO
        what = (
            "every model of the family has values that no craft has, so that none was preferred to the trial's own"
            if is_every
            else "models whose values no craft has were not taken"
        )
        findings.append(Finding(severity, "unphysical-values", what, "; ".join(refused), advice))
    return tuple(findings)


def _better_candidate_warning(candidates: Sequence[CandidateModel]) -> tuple[Finding, ...]:
    """A warning where the model that is used is worse than the best beyond the scatter over runs."""
    used = next(r for r in candidates if r.is_chosen)
    judged = [r for r in candidates if r.is_tied and r.heading_deg is not None]
    if used.is_tied or used.heading_deg is None or not judged:
        return ()
    best = min(judged, key=lambda r: r.heading_deg or 0.0)
    what = f"the runs left out are predicted better by another member of the family, '{best.name}'"
    evidence = f"heading {best.heading_deg:.3g} deg against {used.heading_deg:.3g} deg in windows"
    return (Finding(Severity.WARNING, "better-model", what, evidence),)


def variants(model: Model, family: ModelFamily | None, is_segmented: bool) -> tuple[ModelVariant, ...]:
    """The model as the trial has it, then each structure, each width of priors, each segment length by itself.

    family: what the trial declares; without it the default family of this model.
    """
    free, priors = set(model.parameters.free_names), any(p.prior for p in model.parameters.free)
    built_in = {n: names for n, names in FREED_PARAMETERS.get(family_of(model.name), {}).items() if _has(model, names)}
    structures = built_in if family is None else family.structures
    factors = (PRIOR_FACTORS, SEGMENT_FACTORS) if family is None else ((), ())
    first = "as in the trial"
    members = [ModelVariant(first)]
    members += [ModelVariant(name, freed) for name, freed in structures.items() if not set(freed) <= free]
    members += [ModelVariant(f"priors x {f:g}", prior_factor=f) for f in factors[0] if priors and f != 1.0]
    members += [ModelVariant(f"segments x {f:g}", segment_factor=f) for f in factors[1] if is_segmented and f != 1.0]
    return (members[0], *(replace(v, parent=first) for v in members[1:]))


def _has(model: Model, names: Sequence[str]) -> bool:
    """Return whether the model or its candidate terms have all of these; a craft with thrusters by its layout."""
    return set(names) <= set(with_terms(model, names).parameters.names)


def apply_variant(model: Model, variant: ModelVariant) -> Model:
    """The variant's model: priors widened, further parameters free about their values."""
    model = with_terms(model, variant.freed)
    p = model.parameters
    wider = {
        q.name: replace(q.prior, standard_deviation=q.prior.standard_deviation * variant.prior_factor)
        for q in p.free
        if q.prior is not None
    }
    new = {
        n: Prior(p[n].value, FREED_PRIOR_SHARE * p[n].characteristic_scale, "a tenth of its characteristic size")
        for n in variant.freed
        if n not in p.free_names
    }
    return model.with_parameters(p.freed(*new).with_priors({**wider, **new}))


def fit_variants(
    estimation: Estimation,
    model: Model,
    runs: Runs,
    window_s: float,
    settings: EstimateSettings,
    options: EstimatorOptions,
    family: ModelFamily | None = None,
    report_progress: ProgressReporter | None = None,
    *,
    choose: bool = False,
) -> tuple[FittedVariant, ...]:
    """Every member fitted and scored, the trial's own first; where one is to be chosen, structures that gain joined.

    Raises:
        InputError: too few runs, but one member, or none that can be fitted.
    """
    if len(runs) < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"models are compared on whole runs left out, which needs at least {RUNS_FOR_JACKKNIFE} training runs; the "
            f"trial has {len(runs)}, add runs"
        )
    fitter = _Fitter(estimation.shooting, model, runs, window_s, settings, options, report_progress)
    members = variants(model, family, fitter.is_segmented)
    if len(members) < 2:
        raise InputError(f"model '{model.name}' has no family to choose from; declare [family] with structures")
    fitted = fitter.fitted(members)
    if all(f.estimate is None for f in fitted):
        raise InputError(f"no member of the family can be fitted; the first fails because {fitted[0].note}")
    return _with_joined_structures(fitter, fitted) if choose else fitted


@dataclass(frozen=True, eq=False)
class _Fitter:
    """What members are fitted to, from where, and how they are judged."""

    base: PointEstimate
    model: Model
    runs: Runs
    window_s: float
    settings: EstimateSettings
    options: EstimatorOptions
    report_progress: ProgressReporter | None

    @property
    def is_segmented(self) -> bool:
        return self.base.problem.data.count > len(self.base.problem.data.runs)

    def fitted(self, members: Sequence[ModelVariant]) -> tuple[FittedVariant, ...]:
        return tuple(map_in_threads(self._fitted, members, workers=self.options.workers))

    def _fitted(self, variant: ModelVariant) -> FittedVariant:
        if self.report_progress:
            self.report_progress(f"models compared: {variant.name}")
        varied, base, runs = apply_variant(self.model, variant), self.base, self.runs
        segment_s = _segment_seconds(base) * variant.segment_factor if self.is_segmented else np.inf
        try:
            problem = output_error_problem(varied, runs, segment_s, self.settings, workers=1)
            old = base.problem
            problem = replace(
                problem, noise=old.noise, inflation=old.inflation, huber=old.huber, population=old.population
            )
            shared = _warm_start(base, problem.free, problem.start())
            is_same_data = variant.segment_factor == 1.0
            if is_same_data:  # segments of several lengths cannot be cut again by one length
                problem, local = replace(problem, data=old.data), base.optimum.local
            else:
                local = problem.measured_initial_states()
            # on the same data all members are compared by one objective, samples counted as for the trial's own
            estimate = fit_output_error(
                problem, shared, local, runs.noise, colour_rounds=0 if is_same_data else COLOUR_ROUNDS,
                evaluations=self.options.evaluations,
            )  # fmt: skip
            scores = holdout_scores(estimate, varied, runs.records, self.window_s)
        except InputError as error:
            return FittedVariant(variant, varied, None, np.empty((0, 2)), str(error))
        values = dict(zip(estimate.problem.free, estimate.common_parameters, strict=False))
        against = objections(varied.with_values(values), runs.records)
        return FittedVariant(variant, varied, estimate, scores, objections=against)


def _with_joined_structures(fitter: _Fitter, fitted: tuple[FittedVariant, ...]) -> tuple[FittedVariant, ...]:
    """Return the members and those that join structures: the best one is extended by one more as long as it gains."""
    single = [f.variant for f in fitted if f.variant.freed]
    while True:
        error = _errors(fitted)
        structural = [i for i in error if fitted[i].variant.freed or i == 0]
        best = fitted[min(structural, key=lambda i: float(error[i].mean()))].variant
        more = [
            ModelVariant(f"{best.name} + {v.name}", tuple(dict.fromkeys((*best.freed, *v.freed))), parent=best.name)
            for v in single
            if best.freed and not set(v.freed) <= set(best.freed)
        ]
        if not more or any(f.variant.parent == best.name for f in fitted):
            return fitted
        fitted = (*fitted, *fitter.fitted(more))


def _segment_seconds(estimate: PointEstimate) -> float:
    data = estimate.problem.data
    return float(np.median(np.diff(data.offsets) - 1)) * data.dt


def _warm_start(base: PointEstimate, free: Sequence[str], start: Array) -> Array:
    known = dict(zip(base.problem.free, base.common_parameters, strict=False))
    own = [known.get(n, start[i]) for i, n in enumerate(free)]
    return np.concatenate([own, base.common_parameters[len(base.problem.free) :]])


def rank_candidates(fitted: Sequence[FittedVariant], *, choose: bool) -> tuple[CandidateModel, ...]:
    """Return mean errors, gains and ties; used is the trial's own, which is first, or the one that is to be chosen."""
    single = _errors(fitted)
    best = min(single, key=lambda i: float(single[i].mean()))
    tied = {i for i, score in single.items() if is_no_worse(score - single[best], _ALIKE)}
    used = _chosen(fitted, single) if choose else 0
    mean = {fitted[i].variant.name: float(score.mean()) for i, score in single.items()}
    return tuple(_candidate(f, mean, tied=i in tied, used=i == used) for i, f in enumerate(fitted))


def _errors(fitted: Sequence[FittedVariant]) -> dict[int, Array]:
    """Error of each run left out, (runs,), of the members that could be fitted: heading and position in their means."""
    known = [i for i, f in enumerate(fitted) if f.estimate is not None]
    unit = np.mean(np.concatenate([fitted[i].scores for i in known]), axis=0)
    return {i: np.mean(fitted[i].scores / unit, axis=1) for i in known}


def _chosen(fitted: Sequence[FittedVariant], errors: Mapping[int, Array]) -> int:
    """Position of the member of fewest free coefficients within one standard error of the best that is a craft's.

    Where none is a craft's, the trial's own stays, if it could be fitted.
    """
    allowed = {i: error for i, error in errors.items() if not fitted[i].objections}
    if not allowed:
        allowed = {0: errors[0]} if 0 in errors else dict(errors)
    best = min(allowed.values(), key=lambda error: float(error.mean()))
    close = [i for i, error in allowed.items() if (error - best).mean() <= standard_error(error - best)]
    return min(close, key=lambda i: (len(fitted[i].model.parameters.free), float(allowed[i].mean())))


def _candidate(f: FittedVariant, mean: Mapping[str, float], *, tied: bool, used: bool) -> CandidateModel:
    free = len(f.model.parameters.free)
    if f.estimate is None:
        return CandidateModel(f.variant.name, free, None, None, is_tied=False, is_chosen=used, note=f.note)
    heading, position = f.scores.mean(axis=0)
    parent = mean.get(f.variant.parent)
    gain = None if parent is None else 100.0 * (1.0 - mean[f.variant.name] / parent)
    note = ", ".join(f.objections)
    return CandidateModel(f.variant.name, free, float(heading), float(position), tied, used, note, gain_percent=gain)


def selected_estimation(
    estimation: Estimation,
    fitted: Sequence[FittedVariant],
    candidates: Sequence[CandidateModel],
    runs: Runs,
    settings: EstimateSettings,
    options: EstimatorOptions,
    report_progress: ProgressReporter | None = None,
) -> Estimation:
    """The fit of the member that is used: fitted again by the decision table unless it is the trial's own.

    Raises:
        InputError: what `identified` raises.
    """
    used = next(f for f, row in zip(fitted, candidates, strict=True) if row.is_chosen)
    if used is fitted[0]:
        return estimation
    if used.variant.segment_factor != 1.0:
        seconds = settings.segment_s or _segment_seconds(estimation.shooting)
        settings = replace(settings, segment_s=seconds * used.variant.segment_factor)
    return estimate_model(used.model, runs, settings, options, report_progress)


def tied_models(fitted: Sequence[FittedVariant], candidates: Sequence[CandidateModel]) -> tuple[PointEstimate, ...]:
    """The estimates of the tied members but the one that is used."""
    return tuple(
        f.estimate
        for f, row in zip(fitted, candidates, strict=True)
        if row.is_tied and not row.is_chosen and f.estimate is not None
    )


def with_model_spread(estimation: Estimation, tied: Sequence[PointEstimate]) -> Estimation:
    """The fit with the scatter of tied models about it added to the covariance of its coefficients."""
    if not tied:
        return estimation
    free = estimation.estimate.problem.free
    here = estimation.estimate.common_parameters[: len(free)]
    away = np.array([[t.model.parameters[n].value for n in free] for t in tied]) - here
    reason = f"the spread of {len(tied)} tied model{'s' * (len(tied) != 1)}"
    return estimation.widened(away.T @ away / len(tied), reason)


# The model that is used: the trial's own, or the best member of its family, of roll as of manoeuvring.

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
        house = OMITTED_PARAMETERS.get(family_of(model.name), {})
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
        window = HOLDOUT_WINDOW_SHIP_LENGTHS * task.resolved_time
        return select_model(
            estimation, model, task.runs, window, task.settings, task.options, family,
            choose=task.choose, report_progress=task.report_progress,
        )  # fmt: skip
    return SelectedModel(estimation, (), ())
