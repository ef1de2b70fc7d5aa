"""An estimate read in the field's terms: coefficients, offsets, noise, residuals; and what two fits differ in."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Coefficient, Fit, Method, Noise, Offset, OffsetPopulation, Residuals
from seatrial.core.results.comparison import ComparedFit, Difference, JointTest
from seatrial.core.results.fit import NOT_CONVERGED, SIGN_OPEN
from seatrial.core.text.numbers import exact
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOTATION, Array, Finding, InputError, Parameter, Parameters, Record, Severity
from seatrial.data.trial.records import approach_condition
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import split_segments
from seatrial.estimation.information.covariance import Interval, QuantityInterval, differences, joint_test
from seatrial.physics.models import MODELS, model_named

# An estimate read in the field's terms: coefficients, offsets, noise, residuals, method, and what to warn of.

Limits = Mapping[str, tuple[float | None, float | None]]
_SLIGHT_GAIN = 0.5
"""Gain of negative log-likelihood beyond a bound that records hardly show: a move of one standard error; chosen."""


def coefficients(
    estimation: Estimation, truth: Mapping[str, float], limits: Limits = MappingProxyType({})
) -> tuple[Coefficient, ...]:
    """Return every parameter with its interval, prior and, if known, true value.

    What ends on a bound is where the search was stopped, not where the records have it: without limits of its own it
    has no interval.

    limits: ends of intervals that no standard error gives, of profiles or draws.
    """
    problem, stopped = estimation.estimate.problem, set(at_bounds(estimation)) - set(limits)
    table = coefficient_table(
        problem.model.parameters,
        problem.free,
        estimation.estimate.common_parameters,
        estimation.interval,
        truth,
        limits,
    )
    return tuple(replace(c, standard_error=None, lower=None, upper=None) if c.name in stopped else c for c in table)


def coefficient_table(
    parameters: Parameters,
    free: Sequence[str],
    point: Array,
    interval: Interval,
    truth: Mapping[str, float],
    limits: Limits = MappingProxyType({}),
) -> tuple[Coefficient, ...]:
    """All parameters as coefficients; those named `free` stand first in `point` and `interval`, in that order."""
    place = {name: i for i, name in enumerate(free)}
    half, error = interval.half_width, interval.standard_error

    def one(p: Parameter) -> Coefficient:
        prior = p.prior if p.free else None
        common = {
            "name": p.name, "unit": p.unit, "truth": truth.get(p.name), "source": p.source, "meaning": p.meaning,
            "latex": p.latex, "prior_mean": prior.mean if prior else None,
            "prior_standard_deviation": prior.standard_deviation if prior else None,
        }  # fmt: skip
        if p.name not in place:
            return Coefficient(estimate=p.value, standard_error=None, lower=None, upper=None, fixed=True, **common)
        i = place[p.name]
        value = float(point[i])
        lower, upper = limits.get(p.name, (value - float(half[i]), value + float(half[i])))
        return Coefficient(
            estimate=value, standard_error=float(error[i]), lower=lower, upper=upper, fixed=False, **common
        )

    return tuple(one(p) for p in parameters)


def offsets(estimation: Estimation) -> tuple[Offset, ...]:
    """What each session has of its own."""
    problem, error = estimation.estimate.problem, estimation.interval.standard_error
    names = [(name, problem.model.parameters[name].unit) for name, _ in problem.session_parameters]
    names += [(n.correction.name, n.unit) for n in problem.nuisances]
    table = []
    for k, session in enumerate(problem.data.sessions):
        for j, (name, unit) in enumerate(names):
            i = len(problem.free) + k * problem.unknowns_per_session + j
            table.append(Offset(name, session, unit, float(estimation.estimate.common_parameters[i]), float(error[i])))
    return tuple(table)


def offset_populations(estimation: Estimation) -> tuple[OffsetPopulation, ...]:
    """What each kind of offset is over sessions, and how it follows its covariate."""
    problem, population = estimation.estimate.problem, estimation.estimate.population
    count = len(problem.session_unknowns)
    errors = np.sqrt(np.maximum(np.diag(population.trend_covariance), 0.0)).reshape(2, count)
    units = [problem.model.parameters[name].unit for name, _ in problem.session_parameters]
    units += [n.unit for n in problem.nuisances]
    covariates = ["" for _ in problem.session_parameters] + [n.covariate for n in problem.nuisances]
    return tuple(
        OffsetPopulation(
            name, unit, float(population.mean[i]), float(errors[0, i]), float(population.deviation[i]), covariate,
            float(population.slope[i]) if covariate else None, float(errors[1, i]) if covariate else None,
        )
        for i, (name, unit, covariate) in enumerate(zip(problem.session_unknowns, units, covariates, strict=True))
    )  # fmt: skip


def noise(estimation: Estimation) -> tuple[Noise, ...]:
    """Noise of each compared channel and the colour of its residuals."""
    problem, whiteness = estimation.estimate.problem, estimation.whiteness
    return tuple(
        Noise(
            channel,
            NOTATION[channel].unit if channel in NOTATION else "1",
            float(problem.noise[i]),
            float(0.5 * (estimation.inflation[i] - 1.0) * problem.data.dt),
            float(whiteness.p_values[i]),
            bool(whiteness.p_values[i] >= whiteness.level),
        )
        for i, channel in enumerate(problem.data.outputs)
    )


def residuals(estimation: Estimation) -> tuple[Residuals, ...]:
    """Residuals of each compared channel, segments one after another."""
    problem, values = estimation.estimate.problem, estimation.residuals
    return tuple(
        Residuals(
            channel, 1.0 / problem.data.dt, np.concatenate(split_segments(problem, values[:, i])), estimation.rho[i]
        )
        for i, channel in enumerate(problem.data.outputs)
    )


def method(estimation: Estimation, *, has_profiles: bool) -> Method:
    """What was used and why; has_profiles: whether limits of intervals come from profile likelihoods."""
    problem, meaning = estimation.estimate.problem, estimation.interval.meaning
    settings: dict[str, float | str] = {
        "samples per second": 1.0 / problem.data.dt,
        "segments": problem.data.count,
        "free coefficients": len(problem.free),
        "Huber limit (standard deviations)": problem.huber if np.isfinite(problem.huber) else "none",
    }
    return Method(
        estimation.criterion,
        estimation.start_method,
        f"profile likelihood; standard errors: {meaning}" if has_profiles else meaning,
        tuple(dict.fromkeys(estimation.reasons)),
        settings,
    )


def at_bounds(estimation: Estimation) -> tuple[str, ...]:
    """Return the free coefficients that end on a bound."""
    problem, shared = estimation.estimate.problem, estimation.estimate.common_parameters
    on_bound = (shared <= problem.lower) | (shared >= problem.upper)
    return tuple(name for name, is_on in zip(problem.free, on_bound, strict=False) if is_on)


def bounds_hit(estimation: Estimation) -> list[Finding]:
    """A warning for every coefficient that ends on a bound: which one, and how much the records gain beyond it."""
    problem, shared = estimation.estimate.problem, estimation.estimate.common_parameters
    gradient, hessian = estimation.estimate.optimum.normal.without_local()
    findings = []
    for i in map(problem.free.index, at_bounds(estimation)):
        side = "lower" if shared[i] <= problem.lower[i] else "upper"
        curvature = float(hessian[i, i])
        # minimum of the parabola of Gauss and Newton in this coefficient alone
        gain = 0.5 * float(gradient[i]) ** 2 / curvature if curvature > 0.0 else 0.0
        findings.append(Finding(
            Severity.WARNING, "bound-hit",
            f"coefficient {problem.free[i]} is not determined by these records: it ends on its {side} bound",
            f"{shared[i]:g}; beyond it, this coefficient alone would lower the negative log-likelihood by {gain:.2g}",
            _advice_at_bound(gain, is_own=_is_models_own(problem.model, problem.free[i], float(shared[i]))),
        ))  # fmt: skip
    return findings


def _is_models_own(model: Model, name: str, bound: float) -> bool:
    """Whether a bound is that of the model as it is built in, and not one of the trial file."""
    if model.name not in MODELS:
        return False
    own = model_named(model.name, model.equations.layout).parameters
    return name in own and bound in (own[name].lower, own[name].upper)


def _advice_at_bound(gain: float, *, is_own: bool) -> str:
    if gain < _SLIGHT_GAIN:
        return "the records hardly show where beyond the bound it is; fix it there, or give a prior"
    if is_own:
        return (
            "the bound is the model's own: beyond it the term no longer is what it stands for; leave it, and look for "
            "a term that the model lacks or a coefficient that is fixed at 0"
        )
    return "widen the bound under [model.bounds] if physics allows it, else look for what the model lacks"


def refuse_unidentified(estimation: Estimation, contradicting: Sequence[Finding] = ()) -> None:
    """Refuse an estimate in which no free coefficient is known better than to its own size.

    contradicting: findings on runs that the model cannot have together; these are then the reason.

    Raises:
        InputError: every standard error exceeds the value.
    """
    problem, names = estimation.estimate.problem, _unidentified_names(estimation)
    if names and len(names) == len(problem.free):
        for finding in contradicting:
            raise InputError(f"{finding.text}, which determines none of {', '.join(names)}; {finding.advice}")
        noise = ", ".join(f"{c} {s:.2g}" for c, s in zip(problem.data.outputs, problem.noise, strict=True))
        raise InputError(
            f"the records determine none of the free coefficients {', '.join(names)}: every standard error exceeds the "
            f"value (what the model leaves unexplained, SI: {noise}); take better sensors, longer or harder "
            "manoeuvres, or give priors under [model.priors]"
        )


def open_signs(model: Model, table: Sequence[Coefficient]) -> list[Finding]:
    """Return a warning with the free coefficients whose interval contains 0, though no prior holds them."""
    names = [c.name for c in table if c.is_sign_open and not c.fixed and c.prior_mean is None]
    if not names:
        return []
    advice = "do not use them alone; fix them at 0 if the others predict as well, or give a prior"
    if model.has_course:
        advice += "; a manoeuvre that identifies them: seatrial design TRIAL.toml --out plan, with a table [design]"
    return [Finding(Severity.WARNING, SIGN_OPEN, f"the 95 % {'intervals' if len(names) > 1 else 'interval'} of "
                    f"{enumeration(names)} {'contain' if len(names) > 1 else 'contains'} 0", "", advice)]  # fmt: skip


def _unidentified_names(estimation: Estimation) -> list[str]:
    problem = estimation.estimate.problem
    estimates, errors = estimation.estimate.common_parameters, estimation.interval.standard_error
    without_prior = [i for i, name in enumerate(problem.free) if problem.model.parameters[name].prior is None]
    return [problem.free[i] for i in without_prior if errors[i] > abs(estimates[i])]


def unconverged(estimation: Estimation) -> list[Finding]:
    """Return a warning where the search did not converge, and where noise levels and residuals do not agree."""
    status, findings = estimation.estimate.optimum.solution.status, []
    if not status.is_success:
        how = status.value.partition(";")[0]  # what an optimiser's user may do follows
        findings.append(Finding(Severity.WARNING, NOT_CONVERGED, "the search did not converge", how))  # fmt: skip
    if not estimation.estimate.is_settled:
        findings.append(Finding(Severity.WARNING, "noise-not-settled", "the noise levels still change from round to "
                        "round, and with them the weights of the channels"
                        ))  # fmt: skip
    return findings


# What two fits differ in: coefficients, and the conditions that they were made under.

_ROUNDING, _ALIKE = 1e-6, 5e-3
"""Relative differences up to which two stated values, and two measured approaches, count as the same; chosen."""


_MOST_NAMES = 4
"""Training runs that are named; more are counted; chosen."""


def compared_fit(fit: Fit, name: str) -> ComparedFit:
    """Return what a fit is, in words."""
    records = tuple(r.name for r in _training_records(fit))
    return ComparedFit(name, fit.ship.name, fit.model.name, fit.method.criterion, fit.intervals, records)


def coefficient_differences(first: Fit, second: Fit) -> tuple[tuple[Difference, ...], JointTest | None]:
    """Return differences of the coefficients that are free in both fits of one model, and the test of all together."""
    if first.model.name != second.model.name:
        return (), None
    free = [{c.name: c for c in fit.coefficients if not c.fixed} for fit in (first, second)]
    names = [name for name, c in free[0].items() if name in free[1] and free[1][name].unit == c.unit]
    first_values, second_values = (
        [QuantityInterval(n, one[n].unit, one[n].estimate, one[n].lower, one[n].upper) for n in names] for one in free
    )
    covariances = [_covariance(fit, names) for fit in (first, second)]
    apart = np.array([free[1][n].estimate - free[0][n].estimate for n in names])
    both = [c for c in covariances if c is not None]
    test = joint_test(apart, both[0] + both[1]) if len(both) == len(covariances) else None
    return differences(first_values, second_values), test


def _covariance(fit: Fit, names: Sequence[str]) -> np.ndarray | None:
    """Covariance of some free coefficients; None where the fit has none."""
    free = list(fit.model.parameters.free_names)
    if fit.covariance.shape != (len(free), len(free)):
        return None
    rows = [free.index(n) for n in names]
    return fit.covariance[np.ix_(rows, rows)]


def changes(first: Fit, second: Fit) -> tuple[str, ...]:
    """Return what else differs between two fits: ship, approach, model, records, criterion; a sentence each."""
    particulars = _changed(first.ship.particulars, second.ship.particulars, _ROUNDING)
    approaches = [approach_condition(_training_records(f), f.model) for f in (first, second)]
    approach = _changed(approaches[0], approaches[1], _ALIKE)
    free = [set(f.model.parameters.free_names) for f in (first, second)]
    pairs = {
        "ship": (first.ship.name, second.ship.name),
        "model": (first.model.name, second.model.name),
        "criterion": (first.method.criterion, second.method.criterion),
        "intervals": (first.intervals, second.intervals),
    }
    texts = [f"{name}: {a} → {b}" for name, (a, b) in pairs.items() if a != b]
    texts += [f"particulars: {', '.join(particulars)}"] if particulars else []
    texts += [f"approach: {', '.join(approach)}"] if approach else []
    for text, names in (("only in the first", free[0] - free[1]), ("only in the second", free[1] - free[0])):
        texts += [f"free {text}: {', '.join(sorted(names))}"] if names else []
    runs = [[r.name for r in _training_records(f)] for f in (first, second)]
    if runs[0] != runs[1]:
        texts.append(f"training runs: {_listed(runs[0])} → {_listed(runs[1])}")
    return tuple(texts)


def _listed(names: Sequence[str]) -> str:
    """The names, or how many there are."""
    return ", ".join(names) if len(names) <= _MOST_NAMES else f"{len(names)} runs"


def _changed(first: Mapping[str, float], second: Mapping[str, float], tolerance: float) -> list[str]:
    """Name with both values, of those that differ by more than a share of them; a dash where one is not stated."""
    texts = []
    for name in dict.fromkeys([*first, *second]):
        a, b = first.get(name), second.get(name)
        if a is None or b is None or abs(a - b) > tolerance * max(abs(a), abs(b)):
            texts.append(f"{name} {exact(a, 4)} → {exact(b, 4)}")
    return texts


def findings(first: Fit, second: Fit) -> tuple[Finding, ...]:
    """Return a warning where fits share records, and where their models cannot be compared by coefficients."""
    warnings = []
    contents = {_content(r) for r in _training_records(first)}
    shared = [r.name for r in _training_records(second) if _content(r) in contents]
    if shared:
        warnings.append(Finding(
            Severity.WARNING, "shared-records", "both fits use the same records, so that their errors are not "
            "independent: intervals of the differences hold for independent ones and are mostly too wide here",
            f"{len(shared)} of {len(_training_records(second))} training runs",
        ))  # fmt: skip
    if first.model.name != second.model.name:
        warnings.append(Finding(
            Severity.INFO, "other-model", f"a {first.model.name} and a {second.model.name} model have no coefficients "
            "in common; manoeuvres are compared alone",
        ))  # fmt: skip
    return tuple(warnings)


def _content(record: Record) -> bytes:
    """What makes a record the same under any name."""
    return b"".join(record[c].tobytes() for c in sorted(record.channels))


def _training_records(fit: Fit) -> list[Record]:
    held_out = {p.record for p in fit.validation}
    return [r for r in fit.records if r.name not in held_out]
