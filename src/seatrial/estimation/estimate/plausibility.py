"""Nothing outside physics is handed on as an estimate, and nothing that the records do not determine."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, InputError, Prior
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.covariance import signed_terms
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.physics.models.candidate_structures import course_unstable
from seatrial.physics.simulate.batch import InputCorrection

# Directions in parameter space that the records do not determine, named before any number is printed for them.

# curvature over the largest, unit diagonal, that counts as zero: rounding of the normal equations
_SINGULAR = 1e-11
# least component of a direction that is named, and most that are, ours
_MIN_INFLUENCE, _MAX_NAMED = 0.1, 8


def weakest_direction(hessian: Array, names: tuple[str, ...], values: Array) -> tuple[float, str]:
    """Relative curvature along the weakest direction and the direction in words, e.g. ``1 N_v +1 N_r +1.9 J_z``.

    The numbers are relative changes of the parameters, in units of the median one; those that move the outputs most
    come first. The Hessian is scaled to unit diagonal; a parameter without any influence gives curvature 0 and is
    named alone.
    """
    diagonal = np.diag(hessian)
    size = np.maximum(np.abs(values), 1e-3)  # of coefficients that are nearly zero, in their unit; chosen
    # rounding of double precision; chosen
    silent = np.flatnonzero(diagonal * size**2 <= 1e-14 * np.max(diagonal * size**2))
    if len(silent):
        return 0.0, names[int(silent[0])]
    scale = 1.0 / np.sqrt(diagonal)
    curvature, vectors = np.linalg.eigh(hessian * scale[:, None] * scale[None, :])
    influence = vectors[:, 0]
    order = [i for i in np.argsort(-np.abs(influence)) if abs(influence[i]) > _MIN_INFLUENCE][:_MAX_NAMED]
    change = influence[order] * scale[order] / np.copysign(size, values)[order]
    change = change / (np.sign(change[0]) * np.median(np.abs(change)))
    terms = signed_terms({names[i]: float(c) for i, c in zip(order, change, strict=True)}, "+.2g")
    return float(curvature[0] / curvature[-1]), terms.removeprefix("+")


def refuse_singular(hessian: Array, names: tuple[str, ...], values: Array) -> None:
    """Refuse a problem with an exactly free direction.

    Raises:
        InputError: the direction that is not determined, and what to do.
    """
    curvature, direction = weakest_direction(hessian, names, values)
    if curvature < _SINGULAR:
        raise InputError(
            f"the records do not determine the direction {direction} (relative change of each parameter): moving along "
            "it changes no output; fix one of these parameters under [model.fixed], or give it a prior"
        )


# A constant error of every steering angle, estimated with the disturbance: unmodelled it passes for one.

OFFSET_DEVIATION = float(np.radians(10.0))
"""Prior standard deviation of an angle's zero [rad] while disturbances are estimated: 10 deg, chosen."""

_NOT_STEERED = ("alpha_w", "wind_direction")
"""Inputs that are angles and nobody steers by: the slope of waves, and where the wind comes from."""


def steering_angles(model: Model) -> tuple[str, ...]:
    """Return the inputs that are angles of rudders, nozzles, fins or thrusters."""
    return tuple(n for n in model.input_names if n in NOTATION and NOTATION[n].unit == "rad" and n not in _NOT_STEERED)


def with_input_offsets(estimate: PointEstimate) -> PointEstimate:
    """Return the estimate with a zero of each steering angle as further unknowns of each session, starting at none.

    An angle whose zero is estimated already, as a correction or as the model's parameter `<input>_0`, gets no other,
    and one that is zero at every sample none: it was not recorded, as that of fins which a ship does not have.
    """
    problem = estimate.problem
    moves = dict(zip(problem.model.input_names, np.any(problem.data.inputs != 0.0, axis=0).tolist(), strict=True))
    known = {n.correction.input for n in problem.nuisances if n.correction.kind == "zero"}
    known |= {name.removesuffix("_0") for name in problem.free if name.endswith("_0")}
    added = tuple(
        Nuisance(InputCorrection(name, "zero"), Prior(0.0, OFFSET_DEVIATION, "as good as none"), "rad", is_stated=False)
        for name in steering_angles(problem.model)
        if name not in known and moves[name]
    )
    if not added:
        return estimate
    free, width = len(problem.free), problem.unknowns_per_session
    edges = [free + width * k for k in range(len(problem.data.sessions) + 1)]
    parts = [estimate.common_parameters[:free]]
    for a, b in pairwise(edges):
        parts += [estimate.common_parameters[a:b], np.zeros(len(added))]
    solution = replace(estimate.optimum.solution, point=np.concatenate(parts))
    population = problem.population and problem.population.with_kinds([n.prior for n in added])
    wider = replace(problem, nuisances=(*problem.nuisances, *added), population=population)
    return PointEstimate(wider, replace(estimate.optimum, solution=solution))


# Nothing outside physics is handed on as an estimate: a search that left its basin is begun anew, or refused.

ABSURD_FACTOR, IMPOSSIBLE_FACTOR = 1e3, 1e6
"""Times its characteristic size that a free coefficient without a prior may reach undetermined, and at all; chosen."""
_DETERMINED = 2.0  # standard errors from which on a large value is the record's and not the search's; chosen

_LOST_FACTOR = 30.0
"""The same from which a search begins anew: further out the likelihood hardly depends on it; chosen."""


class OutsidePhysicsError(InputError):
    """States which coefficients a search got lost with."""


def implausible_coefficients(estimate: PointEstimate, standard_error: Array) -> str:
    """Return the coefficients with which the search got lost, with their standard errors; empty where it did not.

    Lost is what is no number, or so far outside the size of a coefficient that only an error much smaller than the
    value would make it the record's. A model that diverges at the estimate is not judged here: the run that it cannot
    repeat is named later.
    """
    free = estimate.problem.free
    if not np.isfinite(estimate.optimum.solution.value):
        return ""
    values, errors = estimate.common_parameters[: len(free)], standard_error[: len(free)]
    is_vague = ~(np.abs(values) >= _DETERMINED * errors)
    is_absurd = (_is_beyond(estimate, ABSURD_FACTOR) & is_vague) | _is_beyond(estimate, IMPOSSIBLE_FACTOR)
    lost = np.flatnonzero(is_absurd | np.isnan(errors))
    if not len(lost):
        return ""
    named = ", ".join(f"{free[i]} {values[i]:.3g}" for i in lost)
    return f"{named}, standard error {', '.join(f'{errors[i]:.2g}' for i in lost)}"


def refuse_implausible(estimate: PointEstimate, standard_error: Array) -> None:
    """Refuse an estimate that is no number, or so far outside the size of its coefficients that the search got lost.

    Raises:
        OutsidePhysicsError: which coefficients, their values, and what to try.
    """
    lost = implausible_coefficients(estimate, standard_error)
    if lost:
        raise OutsidePhysicsError(
            f"the search ended outside physics: {lost}; fix some of these under [model.fixed], give priors under "
            "[model.priors], or leave out the runs that differ most in speed or orders"
            f"{_without_velocity(estimate)}"
        )


def _without_velocity(estimate: PointEstimate) -> str:
    """What to do where the model has a sway that no record shows: positions alone leave its forces open."""
    if "v" not in estimate.problem.model.states or "v" in estimate.problem.data.outputs:
        return ""
    return (
        "; no run has a sway velocity, and positions alone hardly show the forces in sway: declare channels.u and "
        'channels.v, or channels.sog and channels.cog, or write name = "nomoto" under [model]'
    )


def with_plausible_start(estimate: PointEstimate) -> PointEstimate:
    """Return the estimate, its free coefficients at the model's own values if any of them got lost.

    Output error takes a disturbance for a ship without damping where a record is short; from there no other criterion
    finds back, as the likelihood is flat.
    """
    return estimate if not np.any(_is_beyond(estimate, _LOST_FACTOR)) else own_starts(estimate)[0]


def own_starts(estimate: PointEstimate) -> list[PointEstimate]:
    """Return the estimate at the model's own values and, of a steering model, at those of the other course stability.

    Gusts that a helmsman or an autopilot answers lead every estimate without a disturbance into the basin of a ship of
    the other stability, and no search passes through the infinite time constant between the two.
    """
    problem, solution = estimate.problem, estimate.optimum.solution
    starts = []
    for model in dict.fromkeys((problem.model, course_unstable(problem.model))):
        point = solution.point.copy()
        point[: len(problem.free)] = [model.parameters[name].value for name in problem.free]
        starts.append(replace(estimate, optimum=replace(estimate.optimum, solution=replace(solution, point=point))))
    return starts


def is_lost(problem: OutputError, common_parameters: Array) -> bool:
    """Return whether a search has left physics: no optimum there counts, and no other search begins there."""
    return bool(np.any(_beyond(problem, common_parameters, _LOST_FACTOR)))


def _is_beyond(estimate: PointEstimate, factor: float) -> NDArray[np.bool_]:
    return _beyond(estimate.problem, estimate.common_parameters, factor)


def _beyond(problem: OutputError, common_parameters: Array, factor: float) -> NDArray[np.bool_]:
    """Return whether each free coefficient is no number or above so many times its size, (free,)."""
    parameters = [problem.model.parameters[name] for name in problem.free]
    values = common_parameters[: len(parameters)]
    sizes = [max(p.scale, abs(p.value), abs(p.prior.mean) if p.prior else 0.0) for p in parameters]
    has_limit = [p.prior is None and size > 0.0 for p, size in zip(parameters, sizes, strict=True)]
    return ~np.isfinite(values) | (np.array(has_limit) & (np.abs(values) > factor * np.array(sizes)))
