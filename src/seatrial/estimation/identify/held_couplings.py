"""Terms of a craft that are held at zero although the training runs speak against it: a score test of each.

One Newton step from the optimum with one more coefficient free says how far it would move, over its standard error, and
what it would move with it (Rao 1948, Proc. Cambridge Phil. Soc. 44, 50-57: the score statistic is the square of the
first). Standard errors are as wide as those of the fit, which hold what correlated residuals and model error add to the
information: else a term is named that, once free, has an interval around 0.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from seatrial.core.equations import Model
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, Parameter, Severity
from seatrial.estimation.estimate import Estimation
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.models.candidate_structures import structural_terms
from seatrial.physics.models.candidate_terms import with_candidate_terms, with_terms
from seatrial.physics.models.thruster_layout import ThrusterLayout

_CHANCE = 1.0 / 60.0  # that a term is named where all are 0 in truth; chosen
_MOVES = 2.0  # standard errors of a free coefficient by which it would move, from which on it is named; chosen
_MOST_NAMED = 3  # coefficients that a message names; chosen


@dataclass(frozen=True, eq=False)
class _Score:
    """Gradient and Hessian of the cost with the couplings free, and the names of the unknowns that are coefficients."""

    names: tuple[str, ...]
    gradient: Array
    hessian: Array

    def step(self, name: str, couplings: tuple[str, ...]) -> tuple[float, dict[str, float]]:
        """Return the step of one coupling over its standard error, and the steps of the free coefficients with it."""
        rest = [self.names.index(one) for one in couplings if one != name]
        kept = np.setdiff1d(np.arange(len(self.gradient)), rest)
        inverse = np.linalg.pinv(self.hessian[np.ix_(kept, kept)], hermitian=True)
        step = dict(zip(kept.tolist(), (-inverse @ self.gradient[kept]).tolist(), strict=True))
        place = self.names.index(name)
        error = float(np.sqrt(max(np.diag(inverse)[np.flatnonzero(kept == place)[0]], 0.0)))
        own = {one: step[k] for k, one in enumerate(self.names) if one not in couplings}
        return step[place] / error if error > 0.0 else 0.0, own


def held_couplings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning for each term that is held at 0 and should not be, the strongest first.

    Of a craft with thrusters its couplings and dead bands are examined. Of a ship these are the terms of its family and
    candidates that its model does not have; the strongest alone is named, as one of these terms stands in for another.
    """
    model, has_thrusters = estimation.model, bool(estimation.model.equations.layout)
    wide = model if has_thrusters else with_candidate_terms(model)
    terms = _terms_of_thrusters(model) if has_thrusters else structural_terms(model.name)
    held = (p for p in wide.parameters if p.name in terms and p.name not in model.parameters.free_names)
    candidates = tuple(p.name for p in held if p.value == 0.0)
    if not candidates:
        return ()
    score = _score(estimation, candidates)
    errors = dict(zip(estimation.estimate.problem.free, estimation.interval.standard_error, strict=False))
    steps_of = {name: score.step(name, candidates) for name in candidates}
    widening = standard_error_ratio(estimation)
    sizes = {n: abs(s) / widening for n, (s, _) in steps_of.items() if _is_within_bounds(wide.parameters[n], s)}
    enough = float(-ndtri(0.5 * _CHANCE / len(candidates)))  # of a normal error, by Bonferroni's inequality
    contradicted = (name for name in candidates if sizes.get(name, 0.0) > enough)
    named = sorted(contradicted, key=lambda name: -sizes[name])[: None if has_thrusters else 1]
    wider = "" if set(named) <= set(model.parameters.names) else f'name = "{wide.name}", '
    free = ", ".join(f'"{n}"' for n in (*estimation.estimate.problem.free, *named[:1]))
    held_as = {n: "held at 0" if n in model.parameters else "no term of the model" for n in named}
    findings = list[Finding]()
    for name in named:
        _, steps = steps_of[name]
        moved = {n: abs(step) / errors[n] for n, step in steps.items() if errors.get(n, 0.0) > 0.0}
        largest = sorted((n for n in moved if moved[n] > _MOVES), key=lambda n: -moved[n])[:_MOST_NAMED]
        text = enumeration([f"{n} by {moved[n]:.0f} standard errors" for n in largest])
        findings.append(Finding(
            Severity.WARNING, "held-coupling", f"{name} is {held_as[name]} and the training runs speak against it, by "
            f"{sizes[name]:.0f} standard errors", f"in one step it would move {text}" if text else "",
            f"free {named[0]}{', the strongest, first' if len(named) > 1 else ''} and compare the held-out runs: under "
            f"[model] write {wider}free = [{free}]",
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


def _score(estimation: Estimation, couplings: tuple[str, ...]) -> _Score:
    noise = estimation.process_noise
    if noise is None or not estimation.has_process_noise:
        problem, solution = estimation.estimate.problem, estimation.estimate.optimum.solution
        freed = _freed(problem, couplings)
        normal = freed.normal(_point(problem, freed, solution.point), estimation.estimate.optimum.local)
        return _Score(freed.free, *normal.without_local())
    problem, point = noise.problem, noise.optimum.solution.point
    runs = _freed(problem.runs, couplings)
    wider, start = replace(problem, runs=runs, steps=None), _point(problem.runs, runs, point)
    nothing_local = np.zeros((0, 0))  # the filter eliminates initial states
    steps = wider.difference_steps(start, wider.normal(start, nothing_local).hessian)
    normal = replace(wider, steps=steps).normal(start, nothing_local)
    return _Score(runs.free, normal.gradient, normal.hessian)


def _freed(runs: OutputError, couplings: tuple[str, ...]) -> OutputError:
    model = with_terms(runs.model, couplings)
    return replace(runs, model=model.with_parameters(model.parameters.freed(*couplings)))


def _point(runs: OutputError, freed: OutputError, point: Array) -> Array:
    """The optimum as an unknown of the wider problem, the couplings at zero."""
    values = dict(zip(runs.free, point, strict=False))
    return np.concatenate([[values.get(name, 0.0) for name in freed.free], point[len(runs.free) :]])
