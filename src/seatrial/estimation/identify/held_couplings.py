"""Terms of a craft that are held at zero although the training runs speak against it: a score test of each.

Standard errors are as wide as those of the fit, which hold what correlated residuals and model error add to the
information: else a term is named that, once free, has an interval around 0.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, InputError, Parameter, Record, Severity
from seatrial.estimation.estimate import Estimation
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.identify.assumed_information import output_error_estimate
from seatrial.estimation.identify.left_out_scores import holdout_scores
from seatrial.estimation.identify.needless_terms import error_ratio, in_windows, judged_runs
from seatrial.estimation.identify.score_test import Candidate, own_criterion, score_test
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.models.candidate_structures import structural_terms, with_candidate_terms, with_terms
from seatrial.physics.models.thruster_layout import ThrusterLayout

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
    model, has_thrusters = estimation.model, bool(estimation.model.equations.layout)
    wide = model if has_thrusters else with_candidate_terms(model)
    terms = _terms_of_thrusters(model) if has_thrusters else structural_terms(model.name)
    held = (p for p in wide.parameters if p.name in terms and p.name not in model.parameters.free_names)
    candidates = tuple(p.name for p in held if p.value == 0.0)
    if not candidates:
        return ()
    test = score_test(own_criterion(estimation), [_coefficient(wide.parameters[n], candidates) for n in candidates])
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
            "intervals of the coefficients that stand in for it do not hold their true values",
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

    layout = ThrusterLayout.from_text(model.equations.layout)
    return frozenset((*COUPLINGS, *(f"dead{layout.suffix(leader)}" for leader in layout.leaders)))


def _error_ratio_of_freeing(
    estimation: Estimation, name: str, predictions: Sequence[Prediction], records: Sequence[Record], window_s: float
) -> float:
    """The geometric mean of errors in windows with a term free over those without: held-out runs, else left-out ones.

    NaN where there are neither.
    """
    held_out = in_windows(estimation, judged_runs(predictions))
    if held_out:
        runs, optimum = _freed(own_criterion(estimation), name)
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


def _freed(estimate: PointEstimate | ProcessNoise, name: str) -> tuple[OutputError, Optimum]:
    """The runs with a term free, and the end of a search of the estimate's criterion from its optimum."""
    is_filter = isinstance(estimate, ProcessNoise)
    runs = estimate.problem.runs if is_filter else estimate.problem
    wide = with_terms(runs.model, (name,))
    freed = replace(runs, model=wide.with_parameters(wide.parameters.freed(name)))
    point = np.insert(estimate.optimum.solution.point, freed.free.index(name), wide.parameters[name].value)
    problem = replace(estimate.problem, runs=freed, steps=None) if is_filter else freed
    local = np.zeros((0, 0)) if is_filter else estimate.optimum.local  # a filter eliminates initial states
    return freed, levenberg_marquardt(problem, point, local, evaluations=_EVALUATIONS)


def _coefficient(parameter: Parameter, couplings: tuple[str, ...]) -> Candidate:
    """A coefficient that is held, as a candidate; the model has all couplings."""

    def problem_with(problem: OutputError, size: float) -> OutputError:
        model = with_terms(problem.model, couplings)
        return replace(problem, model=model.with_values({parameter.name: parameter.value + size}))

    inwards = 1.0 if parameter.value < parameter.upper else -1.0
    return Candidate(parameter.name, problem_with, inwards * _STEP * parameter.characteristic_scale)
