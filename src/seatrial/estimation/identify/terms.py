"""Terms of a model that the records ask for, and terms that they do without."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.results.fit import Stability
from seatrial.core.text.numbers import percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Parameter, Record, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.point_estimate import NEGLIGIBLE_IN_ROUND, PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.identify.score_test import (
    Candidate,
    added_input,
    holdout_scores,
    output_error_estimate,
    own_criterion,
    score_test,
)
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.windows import HoldoutProtocol, split_windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.models.candidate_structures import structural_terms, with_candidate_terms, with_terms
from seatrial.physics.models.thruster_layout import layout_of
from seatrial.physics.simulate.replay import inputs_of

# Terms of a fitted model without which the runs that were held out would be predicted better.

COMPARED_ERRORS = {"psi_deg": ("heading", " deg"), "position_m": ("position", " m")}
"""Errors that are compared -> their name and unit; where a run has neither, nothing is."""
LEAST_GAIN = 0.7
"""Mean error without a term over that with it, from which on it is named: 30 % are beyond what one run scatters by
chance between models that predict alike; chosen."""
_DAMPING = frozenset({"X_u", "Y_v", "N_r", "R_0", "K_p"})
"""Resistance and linear damping on the diagonal, which every craft has: water takes energy from motion."""


def needless_term_findings(
    estimation: Estimation, predictions: Sequence[Prediction], course: Stability | None = None
) -> tuple[Finding, ...]:
    """Return a warning `term-worsens-prediction` for the term whose removal helps the held-out runs most; else nothing.

    A term is removed by setting its coefficient to 0 and moving the others with it, as the information has them at
    the least cost (Seber & Wild 1989, Nonlinear Regression, section 5.4: to first order, not fitted again). Terms with
    a prior, those whose bounds exclude 0, and the resistance and damping that every craft has stay.

    course: of a craft that is course unstable, nothing is said: its runs leave any model. So do those of which the
    disturbance that was estimated leaves most of the errors by itself.
    """
    if course is not None and course.is_unstable:
        return ()
    held = [p for p in judged_runs(predictions) if not (estimation.has_process_noise and _is_carried(p))]
    if not held:
        return ()
    names, parameters = estimation.estimate.problem.free, estimation.model.parameters
    removable = [n for n in names if n not in _DAMPING
                 and parameters[n].prior is None and parameters[n].lower <= 0.0 <= parameters[n].upper]  # fmt: skip
    ratios = {name: error_ratio(estimation, _without(estimation, name), held) for name in removable}
    best = min(ratios, key=lambda name: ratios[name], default="")
    if not best or ratios[best] > LEAST_GAIN:
        return ()
    without = _errors(estimation, _without(estimation, best), held)
    texts = [
        f"{label} {significant(max(p.rms[key] for p in held if key in p.rms), 2)}{unit} with it, "
        f"{significant(max(errors[key] for errors in without if key in errors), 2)}{unit} without"
        for key, (label, unit) in COMPARED_ERRORS.items()
        if any(key in p.rms for p in held) and any(key in errors for errors in without)
    ]
    runs = enumeration([p.record for p in held], 3)  # names that a message holds, chosen
    return (Finding(
        Severity.WARNING, "term-worsens-prediction", f"{runs} would be predicted better with {best} at 0",
        f"{'; '.join(texts)}; the other coefficients moved with it to first order",
        _advice(is_needed=_is_needed(estimation, best)),
    ),)  # fmt: skip


def judged_runs(predictions: Sequence[Prediction]) -> list[Prediction]:
    """Return the held-out runs by which models are compared: those that the fit follows, heading or position known."""
    return [
        p for p in predictions if p.role == "validation" and p.divergence is None and set(COMPARED_ERRORS) & set(p.rms)
    ]


def _is_carried(p: Prediction) -> bool:
    """Whether the disturbance leaves most of every error that is compared."""
    return all(p.is_left_by_disturbance(key, p.rms[key]) for key in COMPARED_ERRORS if key in p.rms)


def in_windows(estimation: Estimation, held: Sequence[Prediction]) -> list[Prediction]:
    """Return each held-out run cut into its longest windows, with the fit's errors there; runs that have none whole."""
    pieces = list[Prediction]()
    for p in held:
        length = max((w.seconds for w in p.windows), default=0.0)
        cut = split_windows(p.measured, HoldoutProtocol(window_s=length)) if length else []
        pieces += [replace(p, measured=piece) for piece in cut or [p.measured]]
    errors = _errors(estimation, estimation.model, pieces)
    return [replace(p, rms=e) for p, e in zip(pieces, errors, strict=True) if np.all(np.isfinite(list(e.values())))]


def _is_needed(estimation: Estimation, name: str) -> bool:
    """Whether the training runs determine the term: its 95 % interval does not contain 0."""
    place = estimation.estimate.problem.free.index(name)
    return abs(estimation.estimate.common_parameters[place]) > float(estimation.interval.half_width[place])


def _advice(*, is_needed: bool) -> str:
    if is_needed:
        return (
            "do not fix it: the training runs determine it; held-out and training runs ask for different models, so "
            "look for what differs between them (a larger angle, another speed, the other side), and for terms that "
            "grow with it"
        )
    return (
        "fix it at 0 and compare; so that the held-out runs stay a test, let training runs left out decide: "
        "seatrial identify TRIAL.toml --choose"
    )


def _without(estimation: Estimation, name: str) -> Model:
    """The model with a coefficient at 0 and the others where the cost is then least, to second order of the cost."""
    free = estimation.estimate.problem.free
    covariance = inverse(estimation.information)[: len(free), : len(free)]
    place = free.index(name)
    values = estimation.estimate.common_parameters[: len(free)]
    moved = values - covariance[:, place] / covariance[place, place] * values[place]
    parameters = estimation.model.parameters
    limits = [(parameters[n].lower, parameters[n].upper) for n in free]
    kept = [float(np.clip(value, *ends)) for value, ends in zip(moved, limits, strict=True)]
    return estimation.model.with_values(dict(zip(free, kept, strict=True)) | {name: 0.0})


def _errors(estimation: Estimation, model: Model, held: Sequence[Prediction]) -> list[dict[str, float]]:
    """Errors of each held-out run as the fit predicts it, by another model; infinite where it diverges."""
    problem, errors = estimation.estimate.problem, list[dict[str, float]]()
    for p in held:
        offsets = np.array([p.offsets[name] for name in problem.session_unknowns])
        try:
            run = simulate_open_loop(problem, model, p.measured, offsets, p.initial_seconds)
        except InputError:
            errors.append(dict.fromkeys(p.rms, np.inf))
        else:
            errors.append(rms_errors(p.measured, run.record))
    return errors


def error_ratio(estimation: Estimation, model: Model, held: Sequence[Prediction]) -> float:
    """Return the geometric mean over runs and quantities of the error by another model over that by the fit."""
    ratios = [
        errors.get(key, np.inf) / p.rms[key]
        for p, errors in zip(held, _errors(estimation, model, held), strict=True)
        for key in COMPARED_ERRORS
        if p.rms.get(key, 0.0) > 0.0
    ]
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else np.inf


# Terms of a craft that are held at zero although the training runs speak against it: a score test of each.

_CHANCE = 1.0 / 60.0  # that a term is named where all are 0 in truth; chosen
_MOVES = 2.0  # standard errors of a free coefficient by which it would move, from which on it is named; chosen
_STEP = 1e-5  # of a coefficient's scale, of differences by it: small against the curve of outputs; chosen
_EVALUATIONS = 12  # of the search with a term free, which begins at the optimum without it; chosen
_MOST_NAMED = 3  # coefficients that a message names; chosen


def held_couplings(
    estimation: Estimation,
    predictions: Sequence[Prediction] = (),
    records: Sequence[Record] = (),
    window_s: float = 0.0,
) -> tuple[Finding, ...]:
    """Return a warning for each term that is held at 0 and should not be, the strongest first.

    None where the strongest, once free, predicts held-out runs worse, or training runs left out where none are held.

    Of a craft with thrusters its couplings and dead bands are examined. Of a ship these are the terms of its family and
    candidates that its model does not have; the strongest alone is named, as one of these terms stands in for another.

    Args:
        predictions, records: of all runs, and training runs in the order of the estimate.
        window_s: length of the windows in which training runs left out are predicted [s].
    """
    model, has_thrusters = estimation.model, estimation.model.has_thrusters
    wide = model if has_thrusters else with_candidate_terms(model)
    terms = _terms_of_thrusters(model) if has_thrusters else structural_terms(model.name)
    held = (p for p in wide.parameters if p.name in terms and p.name not in model.parameters.free_names)
    candidates = tuple(p.name for p in held if p.value == 0.0)
    if not candidates:
        return ()
    estimate = _estimate_for(estimation, candidates)
    test = score_test(estimate, [_coefficient(wide.parameters[n], candidates) for n in candidates])
    free = estimation.estimate.problem.free
    moves = dict(zip(candidates, np.abs(test.by_candidates[: len(free)] * test.sizes).T, strict=True))
    errors = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    scores = dict(zip(candidates, (test.scores / standard_error_ratio(estimation)).tolist(), strict=True))
    sizes = {n: abs(s) for n, s in scores.items() if _is_within_bounds(wide.parameters[n], s)}
    enough = float(-ndtri(0.5 * _CHANCE / len(candidates)))  # of a normal error, by Bonferroni's inequality
    contradicted = (name for name in candidates if sizes.get(name, 0.0) > enough)
    named = sorted(contradicted, key=lambda name: -sizes[name])[: None if has_thrusters else 1]
    if named and _error_ratio_of_freeing(estimation, named[0], predictions, records, window_s) > 1.0:
        return ()
    wider = "" if set(named) <= set(model.parameters.names) else f'name = "{wide.name}", '
    advised = ", ".join(f'"{n}"' for n in (*free, *named[:1]))
    held_as = {n: "held at 0" if n in model.parameters else "no term of the model" for n in named}
    findings = list[Finding]()
    for name in named:
        moved = dict(zip(free, moves[name] / errors, strict=True))
        largest = sorted((n for n in moved if moved[n] > _MOVES), key=lambda n: -moved[n])[:_MOST_NAMED]
        text = enumeration([f"{n} by {moved[n]:.0f} standard errors" for n in largest])
        findings.append(Finding(
            Severity.WARNING, "held-coupling", f"{name} is {held_as[name]} and the training runs speak against it, by "
            f"{sizes[name]:.0f} standard errors", f"in one step it would move {text}" if text else "",
            f"free {named[0]}{', the strongest, first' if len(named) > 1 else ''} and compare the held-out runs: under "
            f"[model] write {wider}free = [{advised}]",
        ))  # fmt: skip
    return tuple(findings)


def standard_error_ratio(estimation: Estimation) -> float:
    """Return the standard errors of the fit over those that its information alone gives: the median coefficient's."""
    count = len(estimation.estimate.problem.free)
    by_information = np.sqrt(np.diag(inverse(estimation.information))[:count])
    return float(np.median(estimation.interval.standard_error[:count] / by_information))


def _is_within_bounds(parameter: Parameter, step: float) -> bool:
    """Return whether a step of this sign from a value at rest stays a possible one."""
    return parameter.lower < parameter.value if step < 0.0 else parameter.value < parameter.upper


def _terms_of_thrusters(model: Model) -> frozenset[str]:
    """The couplings of the hull, and the dead bands of the thrusters."""
    from seatrial.physics.models.thrusters import COUPLINGS  # here, as it imports SymPy

    layout = layout_of(model)
    return frozenset((*COUPLINGS, *(f"dead{layout.suffix(leader)}" for leader in layout.leaders)))


def _error_ratio_of_freeing(
    estimation: Estimation, name: str, predictions: Sequence[Prediction], records: Sequence[Record], window_s: float
) -> float:
    """The geometric mean of errors in windows with a term free over those without: held-out runs, else left-out ones.

    NaN where there are neither.
    """
    held_out = in_windows(estimation, judged_runs(predictions))
    if held_out:
        runs, optimum = _freed(_estimate_for(estimation, (name,)), name)
        model, point = with_terms(estimation.model, (name,)), optimum.solution.point.tolist()
        values = {n: v for n, v in zip(runs.free, point, strict=False) if n in model.parameters}
        return error_ratio(estimation, model.with_values(values), held_out)
    if len(records) < RUNS_FOR_JACKKNIFE:
        return np.nan
    estimate = output_error_estimate(estimation)
    both = (estimate, PointEstimate(*_freed(estimate, name)))
    try:
        without, freed = (holdout_scores(one, one.problem.model, records, window_s) for one in both)
    except InputError:
        return np.nan
    return float(np.exp(np.mean(np.log(freed / without))))


def _estimate_for(estimation: Estimation, names: tuple[str, ...]) -> PointEstimate | ProcessNoise:
    """The estimate by its own criterion where its model can take these terms, else by output error.

    A model with gusts or biases among its states has no wider one.
    """
    estimate = own_criterion(estimation)
    runs = estimate.problem.runs if isinstance(estimate, ProcessNoise) else estimate.problem
    can_take = set(names) <= set(with_terms(runs.model, names).parameters.names)
    return estimate if can_take else output_error_estimate(estimation)


def _freed(estimate: PointEstimate | ProcessNoise, name: str) -> tuple[OutputError, Optimum]:
    """The runs with a term free, and the end of a search of the estimate's criterion from its optimum."""
    is_filter = isinstance(estimate, ProcessNoise)
    runs = estimate.problem.runs if is_filter else estimate.problem
    wide = with_terms(runs.model, (name,))
    freed = replace(runs, model=wide.with_parameters(wide.parameters.freed(name)))
    point = np.insert(estimate.optimum.solution.point, freed.free.index(name), wide.parameters[name].value)
    problem = replace(estimate.problem, runs=freed, steps=None) if is_filter else freed
    local = np.zeros((0, 0)) if is_filter else estimate.optimum.local  # a filter eliminates initial states
    return freed, levenberg_marquardt(problem, point, local, negligible=NEGLIGIBLE_IN_ROUND, evaluations=_EVALUATIONS)


def _coefficient(parameter: Parameter, couplings: tuple[str, ...]) -> Candidate:
    """A coefficient that is held, as a candidate; the model has all couplings."""

    def problem_with(problem: OutputError, size: float) -> OutputError:
        model = with_terms(problem.model, couplings)
        return replace(problem, model=model.with_values({parameter.name: parameter.value + size}))

    inwards = 1.0 if parameter.value < parameter.upper else -1.0
    return Candidate(parameter.name, problem_with, inwards * _STEP * parameter.characteristic_scale)


# Thrust that falls or rises over a run at one order, as by a battery: a score test of one slope for all runs.

_STANDARDCOMPARED_ERRORS = (
    3.0  # of the slope, from which on it is named; of a normal error one in 370 by chance; chosen
)
_LEAST = 0.03  # change of the order over a run that matters, as of a battery's voltage over some minutes; chosen
_ORDER_STEP = 0.02  # share of the order by which it is changed for the slope, small against its curve; chosen


def drifting_thrust_finding(estimation: Estimation, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `thrust-drifts` where all thrusters seem to be ordered less, or more, towards the end of runs.

    records: the training runs, in the order of the estimate. The order is taken as changed by a share that goes
    straight from half of it at the start to less half of it at the end.
    """
    model = estimation.model
    if not model.has_thrusters:
        return ()
    layout = layout_of(model)
    zeros = {model.input_names.index(t.command.channel): t.command.zero for t in layout.thrusters}
    estimate = output_error_estimate(estimation)
    slopes, free = [_slope_of_orders(inputs_of(model, r), zeros) for r in records], estimate.problem.free
    test = score_test(estimate, [added_input("order", slopes, _ORDER_STEP)])
    (slope,), (score,) = test.sizes, test.scores / standard_error_ratio(estimation)
    if abs(score) < _STANDARDCOMPARED_ERRORS or abs(slope) < _LEAST:
        return ()
    errors = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    moved = np.abs(test.by_candidates[: len(free), 0] * slope) / errors
    most = [free[int(i)] for i in np.argsort(-moved)[:3]]
    powers = [f"p_f{layout.suffix(leader)}" for leader in layout.leaders]
    power = float(np.mean([model.parameters.value_of(p, 1.0) for p in powers]))
    change, way = (1.0 + slope) ** power - 1.0, "falls" if slope < 0.0 else "rises"
    return (Finding(
        Severity.WARNING, "thrust-drifts", f"the thrust at one order {way} from the start of the runs to their end, by "
        f"{percent(abs(change))} %", f"{abs(score):.0f} standard errors; it moves most {enumeration(most)}",
    ),)  # fmt: skip


def _slope_of_orders(inputs: Array, zeros: Mapping[int, float]) -> Array:
    """Return the orders times a share from -1/2 to 1/2 over the run, other inputs unchanged, (rows, nu).

    zeros: column of each order -> what orders nothing, in its unit.
    """
    added = np.zeros_like(inputs)
    for column, zero in zeros.items():
        added[:, column] = (inputs[:, column] - zero) * np.linspace(-0.5, 0.5, len(inputs))
    return added
