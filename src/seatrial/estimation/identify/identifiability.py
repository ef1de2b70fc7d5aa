"""What the records determine of a fitted model and what they do not, put together for the report."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Consequence, Identifiability, Sensitivity, Symmetry
from seatrial.core.values import Array, Prior
from seatrial.data.trial.model_table import COMMON_PARTICULARS
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.identify.box_scale import box_scale
from seatrial.estimation.identify.course_stability import course_stability
from seatrial.estimation.information.collinearity import collinearity, condition_number
from seatrial.estimation.information.consequences import consequence_text, estimate_shifts
from seatrial.estimation.information.directions import directions, effective_parameters, relative_information
from seatrial.estimation.problem.output_error import OutputError

# change of a value whose consequences are shown, ours
RELATIVE_CHANGE = 0.1
# shown in a report, ours
_MAX_CONSEQUENCES = 8
_ASSUMED_PARTICULARS = ("I_z", "x_G")
# what defines the coefficients, chosen with the equations: nothing that could be wrong
_CONVENTIONS = ("prime", "U_n", "U_0")
# information of a value over the largest that counts as none, ours
_MIN_INFLUENCE = 1e-9


def identifiability(
    estimation: Estimation,
    symmetries: Sequence[Symmetry],
    approach: Mapping[str, float],
    length: float,
    is_on_box: bool = False,
) -> Identifiability:
    """Return everything a report shows about identifiability.

    symmetries: found before the fit; approach: steady speed u and inputs of the trials, SI, notation signs; length: m;
    is_on_box: whether the wave forces are those of a box with the stated stiffness.
    """
    problem = estimation.estimate.problem
    names, sizes = problem.free, _signed_scales(estimation)
    data, precision = data_information(estimation)
    scaled = relative_information(data, sizes)
    covariance = estimation.interval.covariance[: len(names), : len(names)]
    along = directions(data, names, sizes, precision, covariance)
    return Identifiability(
        structural=tuple(symmetries),
        directions=along,
        effective_parameters=effective_parameters(scaled, relative_information(precision, sizes), along),
        condition=condition_number(data),
        collinearity=collinearity(data, names),
        sensitivities=sensitivities(estimation),
        consequences=consequences(estimation, is_on_box),
        stability=course_stability(
            estimation.model, covariance, estimation.interval.degrees_of_freedom, approach, length,
        ),
    )  # fmt: skip


def _signed_scales(estimation: Estimation) -> Array:
    """Sizes of the free coefficients at their estimates, with their signs: changes over them are relative changes."""
    parameters = [estimation.model.parameters[n] for n in estimation.estimate.problem.free]
    return np.array([np.copysign(p.characteristic_scale, p.value) for p in parameters])


def _output_error_estimate(estimation: Estimation) -> PointEstimate:
    """The estimate whose outputs are simulated from initial states: under prediction error that over segments."""
    return estimation.shooting if estimation.has_process_noise else estimation.estimate


def data_information(estimation: Estimation) -> tuple[Array, Array]:
    """Information of the records on the free coefficients, and that of priors and force points, both (n, n).

    Everything else (initial states, offsets with their own priors) is eliminated at its optimum.
    """
    problem = estimation.estimate.problem
    count, hessian = len(problem.free), estimation.information.copy()
    known = problem.prior_precision(estimation.estimate.common_parameters)
    hessian[:count, :count] -= known[:count, :count]
    return _eliminate_nuisances(hessian, count), known[:count, :count]


def _eliminate_nuisances(hessian: Array, count: int) -> Array:
    if len(hessian) == count:
        return hessian
    cross = hessian[:count, count:]
    return hessian[:count, :count] - cross @ np.linalg.solve(hessian[count:, count:], cross.T)


def sensitivities(estimation: Estimation) -> tuple[Sensitivity, ...]:
    """What a change of 10 % of each coefficient does to each output, initial states held."""
    estimate = _output_error_estimate(estimation)
    problem = estimate.problem
    slopes = (
        problem.sensitivities(estimate.common_parameters, estimate.optimum.local)
        * RELATIVE_CHANGE
        * np.abs(_signed_scales(estimation))
    )
    total = np.sqrt(np.sum(slopes**2, axis=0))
    outputs = problem.data.outputs
    return tuple(
        Sensitivity(name, float(total[j]), {o: float(slopes[i, j]) for i, o in enumerate(outputs)})
        for j, name in enumerate(problem.free)
    )


def consequences(estimation: Estimation, is_on_box: bool = False) -> tuple[Consequence, ...]:
    """What the estimates would do were an assumed value 10 % off, by one Gauss-Newton step; the worst first.

    is_on_box: whether the wave forces are those of a box, which change with the stated stiffness.
    """
    estimate, model = _output_error_estimate(estimation), estimation.model
    scaled_by_box = box_scale(model) if is_on_box else None
    inertia = scaled_by_box.held if scaled_by_box else ()
    problem, names = _with_assumed_free(estimate.problem, model, inertia)
    free, size = estimate.problem.free, len(problem.free)
    place = {n: i for i, n in enumerate(problem.free)}
    fitted = [place[n] for n in free]
    shared = np.concatenate([problem.start()[:size], estimate.common_parameters[len(free) :]])
    shared[fitted] = estimate.common_parameters[: len(free)]
    information = problem.normal(shared, estimate.optimum.local).without_local()[1]
    moving = np.array([*fitted, *range(size, len(shared))])
    deviation = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    sizes = _signed_scales(estimation)
    felt = _MIN_INFLUENCE * np.max(np.diag(information)[fitted] * sizes**2)
    chi_squared = 2.0 * problem.cost(shared, estimate.optimum.local)
    ranked: list[tuple[float, Consequence]] = []
    changes = {n: _unit(len(shared), place[n]) * RELATIVE_CHANGE * model.parameters[n].value for n in names}
    if scaled_by_box:
        changes = scaled_by_box.changes(changes, place, _with_final_values(shared, place, model, free), RELATIVE_CHANGE)
    for name, change in changes.items():
        if change @ information @ change < felt * RELATIVE_CHANGE**2:
            continue
        moves, misfit = estimate_shifts(information, moving, change)
        worst = float(np.max(np.abs(moves[: len(free)]) / deviation))
        ranked.append((worst, _consequence(name, moves[: len(free)] / sizes, free, misfit, chi_squared)))
    ranked.sort(key=lambda pair: -pair[0])
    return tuple(one for _, one in ranked[:_MAX_CONSEQUENCES])


def _with_final_values(values: Array, place: Mapping[str, int], model: Model, free: Sequence[str]) -> Array:
    """The values with the free coefficients of the fit, over which relative changes are taken."""
    final = values.copy()
    for name in free:
        final[place[name]] = model.parameters[name].value
    return final


def _unit(size: int, place: int) -> Array:
    return np.eye(1, size, place)[0]


def _with_assumed_free(
    problem: OutputError, model: Model, held: Sequence[str] = ()
) -> tuple[OutputError, list[str]]:  # fmt: skip
    """The problem with the assumed values free too, their priors put aside, and which they are; held: further ones."""
    own = {n for n, _ in problem.session_parameters}
    known = {*_CONVENTIONS, *own, *(n for n in COMMON_PARTICULARS if n not in _ASSUMED_PARTICULARS)}
    if problem.extra_terms:  # measured forces may have been corrected with it
        known.add("x_G")
    names = [p.name for p in model.parameters if not p.free and p.value and p.name not in known]
    loose = {n: Prior(0.0, np.inf) for n in {*names, *held}}
    freed = model.parameters.freed(*names, *(n for n in held if n not in names)).with_priors(loose)
    return replace(problem, model=model.with_parameters(freed)), names


def _consequence(
    name: str, estimate_changes: Array, free: Sequence[str], misfit: float, chi_squared: float
) -> Consequence:
    order = np.argsort(-np.abs(estimate_changes), kind="stable")
    ranked = {free[int(i)]: float(estimate_changes[i]) for i in order}
    return Consequence(
        name, RELATIVE_CHANGE, ranked, misfit, consequence_text(name, RELATIVE_CHANGE, ranked, misfit, chi_squared)
    )
