"""Nothing outside physics is handed on as an estimate: a search that left its basin is begun anew, or refused."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.point_estimate import PointEstimate

ABSURD_FACTOR = 1e3
"""Times its characteristic size that a free coefficient without a prior may reach; chosen."""

_LOST_FACTOR = 30.0
"""The same from which a search begins anew: further out the likelihood hardly depends on it; chosen."""


def refuse_implausible(estimate: PointEstimate, standard_error: Array) -> None:
    """Refuse an estimate that is no number, or so far outside the size of its coefficients that the search got lost.

    A model that diverges at the estimate is not judged here: the run that it cannot repeat is named later.

    Raises:
        InputError: which coefficients, their values, and what to try.
    """
    free = estimate.problem.free
    if not np.isfinite(estimate.optimum.solution.value):
        return
    values, errors = estimate.common_parameters[: len(free)], standard_error[: len(free)]
    lost = np.flatnonzero(_is_beyond(estimate, ABSURD_FACTOR) | np.isnan(errors))
    if len(lost):
        text = ", ".join(f"{free[i]} {values[i]:.3g}" for i in lost)
        raise InputError(
            f"the search ended outside physics: {text}, standard error "
            f"{', '.join(f'{errors[i]:.2g}' for i in lost)}; give start values nearer the ship's under [model.start], "
            "bounds under [model.bounds] or priors under [model.priors], or a record with harder manoeuvres"
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


def _is_beyond(estimate: PointEstimate, factor: float) -> NDArray[np.bool_]:
    """Return whether each free coefficient is no number or above so many times its size, (free,)."""
    parameters = [estimate.problem.model.parameters[name] for name in estimate.problem.free]
    values = estimate.common_parameters[: len(parameters)]
    sizes = [max(p.scale, abs(p.value), abs(p.prior.mean) if p.prior else 0.0) for p in parameters]
    has_limit = [p.prior is None and size > 0.0 for p, size in zip(parameters, sizes, strict=True)]
    return ~np.isfinite(values) | (np.array(has_limit) & (np.abs(values) > factor * np.array(sizes)))
