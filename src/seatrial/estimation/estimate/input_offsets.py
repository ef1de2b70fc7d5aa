"""A constant error of every steering angle, estimated with the disturbance: unmodelled it passes for one."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Prior
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.problem.output_error import Nuisance
from seatrial.physics.simulate.batch import InputCorrection

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
