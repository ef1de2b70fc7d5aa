"""What the records can tell of a fitted model and what they cannot, put together for the report."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Consequence, Identifiability, Sensitivity, Stability, Symmetry
from seatrial.core.values import Array, Prior
from seatrial.data.trial.model_choice import COMMON_PARTICULARS
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.estimate.fit import Identified
from seatrial.estimation.information.collinearity import collinearity, condition
from seatrial.estimation.information.consequences import answer, words
from seatrial.estimation.information.directions import directions, effective_parameters, relative
from seatrial.estimation.information.stability import stability
from seatrial.estimation.problem.output_error import OutputError

CHANGE = 0.1
_SHOWN = 8
_ASSUMED = ("I_z", "x_G")
# what defines the coefficients, chosen with the equations: nothing that could be wrong
_CONVENTIONS = ("prime", "U_n", "U_0")
_FELT = 1e-9


def identifiability(
    found: Identified, structural: Sequence[Symmetry], approach: Mapping[str, float], length: float
) -> Identifiability:
    """Everything a report tells about it.

    structural: found before the fit; approach: steady speed u and inputs of the trials, SI, notation signs; length: m.
    """
    problem = found.made.problem
    names, sizes = problem.free, _sizes(found)
    data, precision = of_data(found)
    scaled = relative(data, sizes)
    return Identifiability(
        structural=tuple(structural),
        directions=directions(data, names, sizes, precision),
        effective_parameters=effective_parameters(scaled, relative(precision, sizes)),
        condition=condition(data),
        collinearity=collinearity(data, names),
        sensitivities=sensitivities(found),
        consequences=consequences(found),
        stability=_stability(found, approach, length),
    )


def _sizes(found: Identified) -> Array:
    """Sizes of the free coefficients at their estimates, with their signs: changes over them are relative changes."""
    parameters = [found.model.parameters[n] for n in found.made.problem.free]
    return np.array([np.copysign(p.characteristic_scale, p.value) for p in parameters])


def _simulated(found: Identified) -> Estimate:
    """The estimate whose outputs are simulated from initial states: under prediction error that over segments."""
    return found.shooting if found.has_process_noise else found.made


def of_data(found: Identified) -> tuple[Array, Array]:
    """Information of the records on the free coefficients, and that of priors and force points, both (n, n).

    Everything else (initial states, offsets with their own priors) is eliminated at its optimum.
    """
    problem = found.made.problem
    count, hessian = len(problem.free), found.information.copy()
    known = problem.known_precision(found.made.shared)
    hessian[:count, :count] -= known[:count, :count]
    return _eliminated(hessian, count), known[:count, :count]


def _eliminated(hessian: Array, count: int) -> Array:
    if len(hessian) == count:
        return hessian
    cross = hessian[:count, count:]
    return hessian[:count, :count] - cross @ np.linalg.solve(hessian[count:, count:], cross.T)


def sensitivities(found: Identified) -> tuple[Sensitivity, ...]:
    """What a change of 10 % of each coefficient does to each output, initial states held."""
    estimate = _simulated(found)
    problem = estimate.problem
    slopes = problem.sensitivities(estimate.shared, estimate.optimum.local) * CHANGE * np.abs(_sizes(found))
    total = np.sqrt(np.sum(slopes**2, axis=0))
    outputs = problem.data.outputs
    return tuple(
        Sensitivity(name, float(total[j]), {o: float(slopes[i, j]) for i, o in enumerate(outputs)})
        for j, name in enumerate(problem.free)
    )


def consequences(found: Identified) -> tuple[Consequence, ...]:
    """What the estimates would do were an assumed value 10 % off, by one Gauss-Newton step; the worst first."""
    estimate, model = _simulated(found), found.model
    problem, names = _with_assumed_free(estimate.problem, model)
    own, size = estimate.problem.free, len(problem.free)
    place = {n: i for i, n in enumerate(problem.free)}
    fitted = [place[n] for n in own]
    shared = np.concatenate([problem.start()[:size], estimate.shared[len(own) :]])
    shared[fitted] = estimate.shared[: len(own)]
    information = problem.normal(shared, estimate.optimum.local).reduced()[1]
    moving = np.array([*fitted, *range(size, len(shared))])
    deviation = np.maximum(found.interval.standard_error[: len(own)], 1e-300)
    sizes = _sizes(found)
    felt = _FELT * np.max(np.diag(information)[fitted] * sizes**2)
    left = 2.0 * problem.cost(shared, estimate.optimum.local)
    made: list[tuple[float, Consequence]] = []
    for name in names:
        p, value = place[name], model.parameters[name].value
        if information[p, p] * value**2 < felt:
            continue
        moves, misfit = answer(information, moving, p, CHANGE * value)
        worst = float(np.max(np.abs(moves[: len(own)]) / deviation))
        made.append((worst, _consequence(name, moves[: len(own)] / sizes, own, misfit, left)))
    made.sort(key=lambda pair: -pair[0])
    return tuple(one for _, one in made[:_SHOWN])


def _with_assumed_free(problem: OutputError, model: Model) -> tuple[OutputError, list[str]]:
    """The problem with the assumed values free too, their priors put aside, and which they are."""
    own = {n for n, _ in problem.session_parameters}
    known = {*_CONVENTIONS, *own, *(n for n in COMMON_PARTICULARS if n not in _ASSUMED)}
    if problem.others:  # measured forces may have been corrected with it
        known.add("x_G")
    names = [p.name for p in model.parameters if not p.free and p.value and p.name not in known]
    loose = {n: Prior(0.0, np.inf) for n in names}
    return replace(problem, model=model.with_parameters(model.parameters.freed(*names).with_priors(loose))), names


def _consequence(name: str, moves: Array, free: Sequence[str], misfit: float, left: float) -> Consequence:
    order = np.argsort(-np.abs(moves), kind="stable")
    ranked = {free[int(i)]: float(moves[i]) for i in order}
    return Consequence(name, CHANGE, ranked, misfit, words(name, CHANGE, ranked, misfit, left))


def _stability(found: Identified, approach: Mapping[str, float], length: float) -> Stability | None:
    model, count = found.model, len(found.made.problem.free)
    speed = approach.get("u", 0.0)
    if speed <= 0.0:
        return None
    inputs = np.array(
        [0.0 if i.name == "delta" else (-1.0 if i.is_turned else 1.0) * approach.get(i.name, 0.0) for i in model.inputs]
    )
    covariance = found.interval.covariance[:count, :count]
    return stability(model, covariance, found.interval.degrees_of_freedom, speed, inputs, length)
