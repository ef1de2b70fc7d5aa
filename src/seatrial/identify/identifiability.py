"""What the records can tell of a fitted model and what they cannot, put together for the report."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.estimate.estimate import Estimate
from seatrial.estimate.fit import Identified
from seatrial.information.collinearity import collinearity, condition
from seatrial.information.directions import directions, effective_parameters, relative
from seatrial.information.stability import stability
from seatrial.results import Consequence, Identifiability, Sensitivity, Stability, Symmetry
from seatrial.trial.model_choice import COMMON_PARTICULARS
from seatrial.values import Array

CHANGE = 0.1
_SHOWN, _MOVES = 8, 4
_ASSUMED = ("I_z", "x_G")
_FELT = 1e-9
_SEEN = 5.0


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
        directions=directions(data, names, sizes),
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
    count, hessian = len(problem.free), found.made.optimum.normal.reduced()[1].copy()
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
    """What the estimates would do were an assumed value 10 % off, by one Gauss-Newton step; the worst first.

    d theta = -H_ff^-1 H_fp dp; chi squared grows by dp (H_pp - H_pf H_ff^-1 H_fp) dp (implicit function theorem).
    """
    estimate, model = _simulated(found), found.model
    assumed = [
        p.name
        for p in model.parameters
        if not p.free and p.value and (p.name in _ASSUMED or p.name not in COMMON_PARTICULARS)
    ]
    own = {n for n, _ in estimate.problem.session_parameters}
    freed = model.parameters.freed(*(n for n in assumed if n not in own))
    problem = replace(estimate.problem, model=model.with_parameters(freed), others=())
    shared = np.concatenate([problem.start()[: len(problem.free)], estimate.shared[len(estimate.problem.free) :]])
    place = {n: i for i, n in enumerate(problem.free)}
    fitted = [place[n] for n in estimate.problem.free]
    shared[fitted] = estimate.shared[: len(fitted)]
    hessian = problem.normal(shared, estimate.optimum.local).reduced()[1]
    moving = [*fitted, *range(len(problem.free), len(shared))]
    deviation = np.maximum(found.interval.standard_error[: len(fitted)], 1e-300)
    sizes = _sizes(found)
    felt = _FELT * np.max(np.diag(hessian)[fitted] * sizes**2)
    left = 2.0 * float(problem.cost(shared, estimate.optimum.local))
    made: list[tuple[float, Consequence]] = []
    for name in assumed:
        p = place.get(name)
        if p is None or hessian[p, p] * model.parameters[name].value ** 2 < felt:
            continue
        step = CHANGE * model.parameters[name].value
        answer = -np.linalg.solve(hessian[np.ix_(moving, moving)], hessian[moving, p]) * step
        misfit = float(step * (hessian[p, p] * step + hessian[p, moving] @ answer))
        move = answer[: len(fitted)]
        told = _consequence(name, move / sizes, estimate.problem.free, max(misfit, 0.0), left)
        made.append((float(np.max(np.abs(move) / deviation)), told))
    made.sort(key=lambda pair: -pair[0])
    return tuple(one for _, one in made[:_SHOWN])


def _consequence(name: str, moves: Array, free: Sequence[str], misfit: float, left: float) -> Consequence:
    """In words; misfit is compared with the sum of squares that is left anyhow."""
    order = np.argsort(-np.abs(moves), kind="stable")
    ranked = {free[int(i)]: float(moves[i]) for i in order}
    listed = [f"{n} {float(f'{100 * m:.2g}'):+g} %" for n, m in list(ranked.items())[:_MOVES] if abs(m) >= 0.005]
    grown = 100.0 * (np.sqrt(1.0 + misfit / left) - 1.0) if left > 0 else np.inf
    text = (
        f"were {name} {100 * CHANGE:.0f} % larger, {', '.join(listed) or 'no estimate'} would move, "
        f"while the residuals would grow by {grown:.2g} %" + (" only" if grown < _SEEN else "")
    )
    return Consequence(name, CHANGE, ranked, misfit, text)


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
