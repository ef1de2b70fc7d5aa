"""Choice of a model by cross-validation over whole runs, and the spread of the models that the runs cannot distinguish.

Every member of a declared family (structure, width of priors, segment length) is fitted to all training runs; each run
is then predicted by the member without it (one-step jackknife), in windows. Members that are not worse than the best
one beyond the scatter over runs are tied with it (one-sided paired t-test, 95 %).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.results import CandidateModel
from seatrial.core.values import Array, Finding, InputError, Prior, ProgressReporter, Record, Severity
from seatrial.data.trial import EstimateSettings, ModelFamily
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.resampling import one_step_jackknife
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.predict.holdout_windows import HoldoutProtocol, split_windows, window_errors
from seatrial.estimation.predict.predict_runs import TiedModel
from seatrial.estimation.predict.prediction_intervals import holdout_model
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.models.candidate_structures import FREED_PARAMETERS, PRIOR_FACTORS, SEGMENT_FACTORS

HOLDOUT_WINDOW_SHIP_LENGTHS = 4.0
"""Length of the windows in which runs left out are predicted, in ship lengths travelled."""

FREED_PRIOR_SHARE = 0.1
"""Prior standard deviation of a parameter that a structure frees, over its characteristic size."""


@dataclass(frozen=True)
class ModelVariant:
    """What distinguishes a member: parameters freed beyond the model's, factors on priors and on segment length."""

    name: str
    freed: tuple[str, ...] = ()
    prior_factor: float = 1.0
    segment_factor: float = 1.0


@dataclass(frozen=True, eq=False)
class FittedVariant:
    """A member fitted to all training runs.

    Attributes:
        made: None where the fit failed, with the reason in `note`.
        scores: (runs, 2), mean rms over the windows of each run left out: heading [deg], position [m].
    """

    variant: ModelVariant
    model: Model
    estimate: PointEstimate | None
    scores: Array
    note: str = ""


@dataclass(frozen=True, eq=False)
class SelectedModel:
    """The fit that is used after the family was compared, the family's table, and the models tied with it."""

    estimation: Estimation
    candidates: tuple[CandidateModel, ...]
    tied: tuple[TiedModel, ...]
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
        fitted = fit_variants(estimation, model, runs, window_s, settings, options, family, report_progress)
    except InputError as error:
        if choose:
            raise
        what = "intervals are without the spread of tied models: the family of models cannot be compared"
        return SelectedModel(estimation, (), (), (Finding(Severity.INFO, "no-family", what, str(error)),))
    rows = rank_candidates(fitted, choose=choose)
    used = selected_estimation(estimation, fitted, rows, runs, settings, options, report_progress)
    return SelectedModel(used, rows, tied_models(fitted, rows), _better_candidate_warning(rows))


def _better_candidate_warning(candidates: Sequence[CandidateModel]) -> tuple[Finding, ...]:
    """A warning where the model that is used is worse than the best beyond the scatter over runs."""
    used = next(r for r in candidates if r.is_chosen)
    judged = [r for r in candidates if r.is_tied and r.heading_deg is not None]
    if used.is_tied or used.heading_deg is None or not judged:
        return ()
    best = min(judged, key=lambda r: r.heading_deg or 0.0)
    what = f"the runs left out are predicted better by another member of the family, '{best.name}'"
    evidence = f"heading {best.heading_deg:.3g} deg against {used.heading_deg:.3g} deg in windows"
    return (Finding(Severity.WARNING, "better-model", what, evidence, "--choose takes the best member"),)


def variants(model: Model, family: ModelFamily | None, is_segmented: bool) -> tuple[ModelVariant, ...]:
    """The model as the trial has it, then each structure, each width of priors, each segment length by itself.

    family: what the trial declares; without it the default family of this model.
    """
    free, priors = set(model.parameters.free_names), any(p.prior for p in model.parameters.free)
    structures = FREED_PARAMETERS.get(model.name, {}) if family is None else family.structures
    factors = (PRIOR_FACTORS, SEGMENT_FACTORS) if family is None else (family.prior_factors, family.segment_factors)
    members = [ModelVariant("as in the trial")]
    members += [ModelVariant(name, freed) for name, freed in structures.items() if not set(freed) <= free]
    members += [ModelVariant(f"priors x {f:g}", prior_factor=f) for f in factors[0] if priors and f != 1.0]
    members += [ModelVariant(f"segments x {f:g}", segment_factor=f) for f in factors[1] if is_segmented and f != 1.0]
    return tuple(members)


def apply_variant(model: Model, variant: ModelVariant) -> Model:
    """The variant's model: priors widened, further parameters free about their values."""
    p = model.parameters
    wider = {
        q.name: replace(q.prior, standard_deviation=q.prior.standard_deviation * variant.prior_factor)
        for q in p.free
        if q.prior is not None
    }
    new = {
        n: Prior(p[n].value, FREED_PRIOR_SHARE * p[n].characteristic_scale, "house default")
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
) -> tuple[FittedVariant, ...]:
    """Every member fitted and scored, the trial's own first.

    Raises:
        InputError: too few runs, but one member, or none that can be fitted.
    """
    base = estimation.shooting
    if len(runs) < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"models are compared on whole runs left out, which needs at least {RUNS_FOR_JACKKNIFE} training runs; the "
            f"trial has {len(runs)}, add runs"
        )
    seconds = _segment_seconds(base)
    is_segmented = base.problem.data.count > len(base.problem.data.runs)
    members = variants(model, family, is_segmented)
    if len(members) < 2:
        raise InputError(
            f"model '{model.name}' has no family to choose from; declare [family] with structures or prior_factors"
        )

    def one(variant: ModelVariant) -> FittedVariant:
        if report_progress:
            report_progress(f"family: {variant.name}")
        varied = apply_variant(model, variant)
        segment_s = seconds * variant.segment_factor if is_segmented else np.inf
        try:
            problem = output_error_problem(varied, runs, segment_s, settings, workers=1)
            old = base.problem
            problem = replace(problem, noise=old.noise, inflation=old.inflation, huber=old.huber)
            shared = _warm_start(base, problem.free, problem.start())
            local = base.optimum.local if variant.segment_factor == 1.0 else problem.measured_initial_states()
            estimate = fit_output_error(problem, shared, local, runs.noise, evaluations=options.evaluations)
            return FittedVariant(variant, varied, estimate, holdout_scores(estimate, varied, runs.records, window_s))
        except InputError as error:
            return FittedVariant(variant, varied, None, np.empty((0, 2)), str(error))

    fitted = tuple(map_in_threads(one, members, workers=options.workers))
    if all(f.estimate is None for f in fitted):
        raise InputError(f"no member of the family can be fitted; the first fails because {fitted[0].note}")
    return fitted


def _segment_seconds(estimate: PointEstimate) -> float:
    data = estimate.problem.data
    return float(np.median(np.diff(data.offsets) - 1)) * data.dt


def _warm_start(base: PointEstimate, free: Sequence[str], start: Array) -> Array:
    known = dict(zip(base.problem.free, base.common_parameters, strict=False))
    own = [known.get(n, start[i]) for i, n in enumerate(free)]
    return np.concatenate([own, base.common_parameters[len(base.problem.free) :]])


def holdout_scores(estimate: PointEstimate, model: Model, records: Sequence[Record], window_s: float) -> Array:
    """Mean window error of each run by the estimate without it, (runs, 2): heading [deg], position [m].

    Runs shorter than a window are left out, unless all are.

    Raises:
        InputError: a window diverges, or a run lacks position or heading in all of its windows.
    """
    problem, points = estimate.problem, one_step_jackknife(estimate)
    protocol, scores = HoldoutProtocol(window_s=window_s), []
    judged = [r for r, record in enumerate(records) if split_windows(record, protocol)] or range(len(records))
    for r in judged:
        record, session = records[r], problem.data.sessions[problem.data.session[problem.data.run_segments(r)[0]]]
        by = holdout_model(replace(problem, model=model), points[r], session, record)
        errors = window_errors(problem, by.model, [record], [by.nuisances], ["run"], protocol)
        if not errors:
            raise InputError(f"run '{record.name}' has no window in which both position and heading are measured")
        scores.append((np.mean([e.heading_deg for e in errors]), np.mean([e.position_m for e in errors])))
    return np.array(scores)


def rank_candidates(fitted: Sequence[FittedVariant], *, choose: bool) -> tuple[CandidateModel, ...]:
    """Mean errors and ties; used is the best member where it is to be chosen, else the trial's own, which is first."""
    known = [i for i, f in enumerate(fitted) if f.estimate is not None]
    unit = np.mean(np.concatenate([fitted[i].scores for i in known]), axis=0)
    single = {i: np.mean(fitted[i].scores / unit, axis=1) for i in known}
    best = min(single, key=lambda i: float(single[i].mean()))
    tied = {i for i, score in single.items() if _is_tied(score - single[best])}
    used = best if choose else 0
    return tuple(_candidate(f, tied=i in tied, used=i == used) for i, f in enumerate(fitted))


def _is_tied(excess: Array) -> bool:
    """Whether scores of runs are worse by no more than their scatter explains."""
    error = np.std(excess, ddof=1) / np.sqrt(len(excess)) if len(excess) > 1 else np.inf
    return bool(excess.mean() <= stdtrit(max(len(excess) - 1, 1), 0.95) * error)  # one-sided level; chosen


def _candidate(f: FittedVariant, *, tied: bool, used: bool) -> CandidateModel:
    free = len(f.model.parameters.free)
    if f.estimate is None:
        return CandidateModel(f.variant.name, free, None, None, is_tied=False, is_chosen=used, note=f.note)
    heading, position = f.scores.mean(axis=0)
    return CandidateModel(f.variant.name, free, float(heading), float(position), tied, used)


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


def tied_models(fitted: Sequence[FittedVariant], candidates: Sequence[CandidateModel]) -> tuple[TiedModel, ...]:
    """The tied members but the one that is used."""
    tied = []
    for f, row in zip(fitted, candidates, strict=True):
        if row.is_tied and not row.is_chosen and f.estimate is not None:
            values: Mapping[str, float] = dict(zip(f.estimate.problem.free, f.estimate.common_parameters, strict=False))
            tied.append(TiedModel(f.estimate, f.model.with_values(values)))
    return tuple(tied)


def with_model_spread(estimation: Estimation, tied: Sequence[TiedModel]) -> Estimation:
    """The fit with the scatter of tied models about it added to the covariance of its coefficients."""
    if not tied:
        return estimation
    free, interval = estimation.estimate.problem.free, estimation.interval
    here = estimation.estimate.common_parameters[: len(free)]
    away = np.array([[t.model.parameters[n].value for n in free] for t in tied]) - here
    covariance = interval.covariance.copy()
    covariance[: len(free), : len(free)] += away.T @ away / len(tied)
    meaning = f"{interval.meaning}, with the spread of {len(tied)} tied model{'s' * (len(tied) != 1)}"
    widened = replace(interval, covariance=covariance, meaning=meaning)
    return replace(estimation, uncertainty=replace(estimation.uncertainty, interval=widened))
