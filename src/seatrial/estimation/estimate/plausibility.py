"""Nothing outside physics is handed on as an estimate: a search that left its basin is begun anew, or refused."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.problem.output_error import OutputError

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
            f"the search ended outside physics: {lost}; either the runs do not show these apart: fix some under "
            "[model.fixed] or give priors under [model.priors]; or no values repeat all runs: leave out those that "
            f"differ most in speed or orders, or take a model with what they differ by{_without_velocity(estimate)}"
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
    if not np.any(_is_beyond(estimate, _LOST_FACTOR)):
        return estimate
    problem, solution = estimate.problem, estimate.optimum.solution
    point = solution.point.copy()
    point[: len(problem.free)] = [problem.model.parameters[name].value for name in problem.free]
    return replace(estimate, optimum=replace(estimate.optimum, solution=replace(solution, point=point)))


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
