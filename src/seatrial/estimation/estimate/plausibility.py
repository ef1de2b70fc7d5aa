"""Nothing outside physics is handed on as an estimate: a search that left its basin ends in a sentence."""

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.point_estimate import PointEstimate

ABSURD_FACTOR = 1e3
"""Times its characteristic size that a free coefficient without a prior may reach; chosen."""


def refuse_implausible(estimate: PointEstimate, standard_error: Array) -> None:
    """Refuse an estimate that is no number, or so far outside the size of its coefficients that the search got lost.

    A model that diverges at the estimate is not judged here: the run that it cannot repeat is named later.

    Raises:
        InputError: which coefficients, their values, and what to try.
    """
    problem, free = estimate.problem, estimate.problem.free
    if not np.isfinite(estimate.optimum.solution.value):
        return
    values, errors = estimate.common_parameters[: len(free)], standard_error[: len(free)]
    lost = []
    for i, name in enumerate(free):
        parameter = problem.model.parameters[name]
        size = max(parameter.scale, abs(parameter.value), abs(parameter.prior.mean) if parameter.prior else 0.0)
        is_absurd = size > 0.0 and parameter.prior is None and abs(values[i]) > ABSURD_FACTOR * size
        if not np.isfinite(values[i]) or np.isnan(errors[i]) or is_absurd:
            lost.append(i)
    if lost:
        text = ", ".join(f"{free[i]} {values[i]:.3g}" for i in lost)
        raise InputError(
            f"the search ended outside physics: {text}, standard error "
            f"{', '.join(f'{errors[i]:.2g}' for i in lost)}; give start values nearer the ship's under [model.start], "
            "bounds under [model.bounds] or priors under [model.priors], or a record with harder manoeuvres"
        )
