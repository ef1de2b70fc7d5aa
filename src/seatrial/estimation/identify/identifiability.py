"""What the records determine of a fitted model and what they do not, put together for the report."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Consequence, Identifiability, Sensitivity, Symmetry
from seatrial.core.values import Array
from seatrial.data.trial.model_table import COMMON_PARTICULARS
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.assumed_information import assumed_information, output_error_estimate
from seatrial.estimation.identify.box_scale import box_scale
from seatrial.estimation.identify.course_stability import course_stability
from seatrial.estimation.information.collinearity import collinearity, condition_number
from seatrial.estimation.information.consequences import consequence_text
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
    fastest: float = math.inf,
) -> Identifiability:
    """Return everything a report shows about identifiability.

    symmetries: found before the fit; approach: steady speed u and inputs of the trials, SI, notation signs; length: m;
    is_on_box: whether the wave forces are those of a box with the stated stiffness; fastest: of the training runs, m/s.
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
            estimation.model, covariance, estimation.interval.degrees_of_freedom, approach, length, fastest=fastest
        ),
    )  # fmt: skip


def _signed_scales(estimation: Estimation) -> Array:
    """Sizes of the free coefficients at their estimates, with their signs: changes over them are relative changes."""
    parameters = [estimation.model.parameters[n] for n in estimation.estimate.problem.free]
    return np.array([np.copysign(p.characteristic_scale, p.value) for p in parameters])


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
    estimate = output_error_estimate(estimation)
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
    problem, model = output_error_estimate(estimation).problem, estimation.model
    scaled_by_box = box_scale(model) if is_on_box else None
    free, names = problem.free, _assumed_names(problem, model)
    known = assumed_information(estimation, names, scaled_by_box.held if scaled_by_box else ())
    deviation = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    sizes, fitted = _signed_scales(estimation), known.moving[: len(free)]
    felt = _MIN_INFLUENCE * np.max(np.diag(known.information)[fitted] * sizes**2)
    ranked: list[tuple[float, Consequence]] = []
    changes = {n: known.unit(n) * RELATIVE_CHANGE * model.parameters[n].value for n in names}
    if scaled_by_box:
        final = _with_final_values(known.point, known.place, model, free)
        changes = scaled_by_box.changes(changes, known.place, final, RELATIVE_CHANGE)
    for name, change in changes.items():
        if change @ known.information @ change < felt * RELATIVE_CHANGE**2:
            continue
        moves, misfit = known.shifts(change)
        worst = float(np.max(np.abs(moves) / deviation))
        ranked.append((worst, _consequence(name, moves / sizes, free, misfit, known.chi_squared)))
    ranked.sort(key=lambda pair: -pair[0])
    return tuple(one for _, one in ranked[:_MAX_CONSEQUENCES])


def _with_final_values(values: Array, place: Mapping[str, int], model: Model, free: Sequence[str]) -> Array:
    """The values with the free coefficients of the fit, over which relative changes are taken."""
    final = values.copy()
    for name in free:
        final[place[name]] = model.parameters[name].value
    return final


def _assumed_names(problem: OutputError, model: Model) -> list[str]:
    """Fixed parameters that were assumed: no conventions, no dimensions, and not zero."""
    own = {n for n, _ in problem.session_parameters}
    known = {*_CONVENTIONS, *own, *(n for n in COMMON_PARTICULARS if n not in _ASSUMED_PARTICULARS)}
    if problem.extra_terms:  # measured forces may have been corrected with it
        known.add("x_G")
    return [p.name for p in model.parameters if not p.free and p.value and p.name not in known]


def _consequence(
    name: str, estimate_changes: Array, free: Sequence[str], misfit: float, chi_squared: float
) -> Consequence:
    order = np.argsort(-np.abs(estimate_changes), kind="stable")
    ranked = {free[int(i)]: float(estimate_changes[i]) for i in order}
    return Consequence(
        name, RELATIVE_CHANGE, ranked, misfit, consequence_text(name, RELATIVE_CHANGE, ranked, misfit, chi_squared)
    )
