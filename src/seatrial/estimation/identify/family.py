"""Choice of a model by cross-validation over whole runs, and the spread of the models that the runs cannot tell apart.

Every member of a declared family (structure, width of priors, segment length) is fitted to all training runs; each run
is then predicted by the member without it (one-step jackknife), in windows. Members that are not worse than the best
one beyond the scatter over runs are tied with it (one-sided paired t-test, 95 %).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.core.equations import Model
from seatrial.core.results import Member
from seatrial.core.values import Array, Finding, InputError, Prior, Progress, Record, Severity
from seatrial.data.trial import Family
from seatrial.estimation.estimate.assemble import output_error
from seatrial.estimation.estimate.estimate import Estimate, estimate
from seatrial.estimation.estimate.fit import Identified, identified
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.replicates import stepped
from seatrial.estimation.estimate.settings import Settings
from seatrial.estimation.predict.cross_validation import Protocol, window_errors, windows
from seatrial.estimation.predict.forecast import Tied
from seatrial.estimation.predict.margins import without
from seatrial.numerics.workers import mapped
from seatrial.physics.models.families import PRIOR_FACTORS, SEGMENT_FACTORS, STRUCTURES

WINDOW_SHIP_LENGTHS = 4.0
"""Length of the windows in which runs left out are predicted, in ship lengths travelled."""

NEW_PRIOR = 0.1
"""Prior standard deviation of a parameter that a structure frees, over its characteristic size."""


@dataclass(frozen=True)
class Variant:
    """What distinguishes a member: parameters freed beyond the model's, factors on priors and on segment length."""

    name: str
    freed: tuple[str, ...] = ()
    prior: float = 1.0
    segment: float = 1.0


@dataclass(frozen=True, eq=False)
class Fitted:
    """A member fitted to all training runs.

    Attributes:
        made: None where the fit failed, with the reason in `note`.
        scores: (runs, 2), mean rms over the windows of each run left out: heading [deg], position [m].
    """

    variant: Variant
    model: Model
    made: Estimate | None
    scores: Array
    note: str = ""


@dataclass(frozen=True, eq=False)
class Considered:
    """The fit that is used after the family was compared, the family's table, and the models tied with it."""

    found: Identified
    rows: tuple[Member, ...]
    tied: tuple[Tied, ...]
    findings: tuple[Finding, ...] = ()


def considered(
    found: Identified,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    length: float,
    window_s: float,
    settings: Settings,
    family: Family | None,
    *,
    choose: bool,
    progress: Progress | None = None,
) -> Considered:
    """Compare the family and take its best where it is to be chosen; where it cannot be compared, say why.

    Raises:
        InputError: a member is to be chosen and the family cannot be compared.
    """
    try:
        fitted = compared(found, model, records, sessions, window_s, settings, family, progress)
    except InputError as error:
        if choose:
            raise
        what = "intervals are without the spread of tied models: the family of models cannot be compared"
        return Considered(found, (), (), (Finding(Severity.INFO, "no-family", what, str(error)),))
    rows = table(fitted, choose=choose)
    used = chosen(found, fitted, rows, records, sessions, length, settings, progress)
    return Considered(used, rows, tied_models(fitted, rows), _better(rows))


def _better(rows: Sequence[Member]) -> tuple[Finding, ...]:
    """A warning where the model that is used is worse than the best beyond the scatter over runs."""
    used = next(r for r in rows if r.chosen)
    judged = [r for r in rows if r.tied and r.heading_deg is not None]
    if used.tied or used.heading_deg is None or not judged:
        return ()
    best = min(judged, key=lambda r: r.heading_deg or 0.0)
    what = f"the runs left out are predicted better by another member of the family, '{best.name}'"
    evidence = f"heading {best.heading_deg:.3g} deg against {used.heading_deg:.3g} deg in windows"
    return (Finding(Severity.WARNING, "better-model", what, evidence, "--choose takes the best member"),)


def variants(model: Model, family: Family | None, is_segmented: bool) -> tuple[Variant, ...]:
    """The model as the trial has it, then each structure, each width of priors, each segment length by itself.

    family: what the trial declares; without it the family of the house for this model.
    """
    free, priors = set(model.parameters.free_names), any(p.prior for p in model.parameters.free)
    structures = STRUCTURES.get(model.name, {}) if family is None else family.structures
    factors = (PRIOR_FACTORS, SEGMENT_FACTORS) if family is None else (family.prior_factors, family.segment_factors)
    made = [Variant("as in the trial")]
    made += [Variant(name, freed) for name, freed in structures.items() if not set(freed) <= free]
    made += [Variant(f"priors x {f:g}", prior=f) for f in factors[0] if priors and f != 1.0]
    made += [Variant(f"segments x {f:g}", segment=f) for f in factors[1] if is_segmented and f != 1.0]
    return tuple(made)


def modelled(model: Model, variant: Variant) -> Model:
    """The variant's model: priors widened, further parameters free about their values."""
    p = model.parameters
    wider = {
        q.name: replace(q.prior, standard_deviation=q.prior.standard_deviation * variant.prior)
        for q in p.free
        if q.prior is not None
    }
    new = {
        n: Prior(p[n].value, NEW_PRIOR * p[n].characteristic_scale, "house default")
        for n in variant.freed
        if n not in p.free_names
    }
    return model.with_parameters(p.freed(*new).with_priors({**wider, **new}))


def compared(
    found: Identified,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    window_s: float,
    settings: Settings,
    family: Family | None = None,
    progress: Progress | None = None,
) -> tuple[Fitted, ...]:
    """Every member fitted and scored, the trial's own first.

    Raises:
        InputError: too few runs, but one member, or none that can be fitted.
    """
    base = found.shooting
    if len(records) < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"models are compared on whole runs left out, which needs at least {RUNS_FOR_JACKKNIFE} training runs; the "
            f"trial has {len(records)}, add runs"
        )
    seconds = _segment_seconds(base)
    is_segmented = base.problem.data.count > len(base.problem.data.runs)
    members = variants(model, family, is_segmented)
    if len(members) < 2:
        raise InputError(
            f"model '{model.name}' has no family to choose from; declare [family] with structures or prior_factors"
        )
    quiet = replace(settings, workers=1)

    def one(variant: Variant) -> Fitted:
        if progress:
            progress(f"family: {variant.name}")
        own = modelled(model, variant)
        length = seconds * variant.segment if is_segmented else np.inf
        try:
            problem = output_error(own, records, sessions, length, quiet)
            old = base.problem
            problem = replace(problem, noise=old.noise, inflation=old.inflation, huber=old.huber)
            shared = _carried_over(base, problem.free, problem.start())
            local = base.optimum.local if variant.segment == 1.0 else problem.measured_starts()
            made = estimate(problem, shared, local, settings.noise, evaluations=settings.evaluations)
            return Fitted(variant, own, made, scored(made, own, records, window_s))
        except InputError as error:
            return Fitted(variant, own, None, np.empty((0, 2)), str(error))

    fitted = tuple(mapped(one, members, workers=settings.workers))
    if all(f.made is None for f in fitted):
        raise InputError(f"no member of the family can be fitted; the first fails because {fitted[0].note}")
    return fitted


def _segment_seconds(made: Estimate) -> float:
    data = made.problem.data
    return float(np.median(np.diff(data.offsets) - 1)) * data.dt


def _carried_over(base: Estimate, free: Sequence[str], start: Array) -> Array:
    known = dict(zip(base.problem.free, base.shared, strict=False))
    own = [known.get(n, start[i]) for i, n in enumerate(free)]
    return np.concatenate([own, base.shared[len(base.problem.free) :]])


def scored(made: Estimate, model: Model, records: Sequence[Record], window_s: float) -> Array:
    """Mean window error of each run by the estimate without it, (runs, 2): heading [deg], position [m].

    Runs shorter than a window are left out, unless all are.

    Raises:
        InputError: a window diverges, or a run lacks position or heading in all of its windows.
    """
    problem, points = made.problem, stepped(made)
    protocol, scores = Protocol(window_s=window_s), []
    judged = [r for r, record in enumerate(records) if windows(record, protocol)] or range(len(records))
    for r in judged:
        record, session = records[r], problem.data.sessions[problem.data.session[problem.data.of_run(r)[0]]]
        by = without(replace(problem, model=model), points[r], session)
        errors = window_errors(problem, by.model, [record], [by.own], ["run"], protocol)
        if not errors:
            raise InputError(f"run '{record.name}' has no window in which both position and heading are measured")
        scores.append((np.mean([e.heading_deg for e in errors]), np.mean([e.position_m for e in errors])))
    return np.array(scores)


def table(fitted: Sequence[Fitted], *, choose: bool) -> tuple[Member, ...]:
    """Mean errors and ties; used is the best member where it is to be chosen, else the trial's own, which is first."""
    known = [i for i, f in enumerate(fitted) if f.made is not None]
    unit = np.mean(np.concatenate([fitted[i].scores for i in known]), axis=0)
    single = {i: np.mean(fitted[i].scores / unit, axis=1) for i in known}
    best = min(single, key=lambda i: float(single[i].mean()))
    tied = {i for i, score in single.items() if _is_tied(score - single[best])}
    used = best if choose else 0
    return tuple(_member(f, tied=i in tied, used=i == used) for i, f in enumerate(fitted))


def _is_tied(worse: Array) -> bool:
    """Whether scores of runs are worse by no more than their scatter explains."""
    error = np.std(worse, ddof=1) / np.sqrt(len(worse)) if len(worse) > 1 else np.inf
    return bool(worse.mean() <= stats.t.ppf(0.95, max(len(worse) - 1, 1)) * error)


def _member(f: Fitted, *, tied: bool, used: bool) -> Member:
    free = len(f.model.parameters.free)
    if f.made is None:
        return Member(f.variant.name, free, None, None, tied=False, chosen=used, note=f.note)
    heading, position = f.scores.mean(axis=0)
    return Member(f.variant.name, free, float(heading), float(position), tied, used)


def chosen(
    found: Identified,
    fitted: Sequence[Fitted],
    rows: Sequence[Member],
    records: Sequence[Record],
    sessions: Sequence[str],
    length: float,
    settings: Settings,
    progress: Progress | None = None,
) -> Identified:
    """The fit of the member that is used: fitted again by the decision table unless it is the trial's own.

    Raises:
        InputError: what `identified` raises.
    """
    used = next(f for f, row in zip(fitted, rows, strict=True) if row.chosen)
    if used is fitted[0]:
        return found
    own = settings
    if used.variant.segment != 1.0:
        seconds = settings.segment_seconds or _segment_seconds(found.shooting)
        own = replace(settings, segment_seconds=seconds * used.variant.segment)
    return identified(used.model, records, sessions, length, own, progress)


def tied_models(fitted: Sequence[Fitted], rows: Sequence[Member]) -> tuple[Tied, ...]:
    """The tied members but the one that is used."""
    made = []
    for f, row in zip(fitted, rows, strict=True):
        if row.tied and not row.chosen and f.made is not None:
            values: Mapping[str, float] = dict(zip(f.made.problem.free, f.made.shared, strict=False))
            made.append(Tied(f.made, f.model.with_values(values)))
    return tuple(made)


def with_ensemble(found: Identified, tied: Sequence[Tied]) -> Identified:
    """The fit with the scatter of tied models about it added to the covariance of its coefficients."""
    if not tied:
        return found
    free, interval = found.made.problem.free, found.interval
    here = found.made.shared[: len(free)]
    away = np.array([[t.model.parameters[n].value for n in free] for t in tied]) - here
    covariance = interval.covariance.copy()
    covariance[: len(free), : len(free)] += away.T @ away / len(tied)
    meaning = f"{interval.meaning}, with the spread of {len(tied)} tied model{'s' * (len(tied) != 1)}"
    widened = replace(interval, covariance=covariance, meaning=meaning)
    return replace(found, uncertainty=replace(found.uncertainty, interval=widened))
