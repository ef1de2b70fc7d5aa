"""What the likelihood of the true disturbance admits on a record: Cramer-Rao bound, and an efficient estimate."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations.augment import gust_name, with_gusts
from seatrial.core.values import Array, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.input_offsets import with_input_offsets
from seatrial.estimation.estimate.newton_refinement import newton_step
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise, initial_problem
from seatrial.estimation.estimate.runs import Runs
from seatrial.numerics.optimise import Optimum, Solution, Status
from seatrial.problems.disturbed_craft import SAMPLE_S, Disturbance, DisturbedCraft

NONE = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class DisturbanceLimit:
    """Standard errors that a likelihood admits on a record, and the errors of an efficient estimate, both (k,)."""

    standard_error: Array
    efficient: Array


def limit_of(craft: DisturbedCraft, disturbance: Disturbance, record: Record) -> DisturbanceLimit:
    """Return what the likelihood of the true disturbance admits on this record."""
    model = craft.model
    settings = EstimateSettings().with_known_timing(model.input_names)  # the records were simulated sample by sample
    problem = output_error_problem(model, Runs.one_session_each([record], craft.length), np.inf, settings, 1)
    problem = replace(problem, noise=np.array([craft.sensors[o] for o in problem.data.outputs]))
    local = np.array([[craft.start.get(s, 0.0) for s in problem.starts]])
    optimum = Optimum(
        Solution(problem.start(), 0.0, Status.CONVERGED, 1), local, problem.normal(problem.start(), local)
    )
    estimate = PointEstimate(problem, optimum)
    if disturbance.size or disturbance.offset:
        estimate = with_input_offsets(estimate)
    driven = tuple(craft.driven) if disturbance.size else ()
    white = initial_problem(estimate, {}, tuple(craft.driven))
    white = replace(white, process=driven)
    squared = np.array([(disturbance.size * craft.driven[s]) ** 2 for s in driven])
    constants: list[float] = []
    if disturbance.memory > 0.0 and driven:
        augmented = with_gusts(model, dict.fromkeys(driven, disturbance.memory))
        spread = np.tile(squared, (1, 1))
        white = replace(white, runs=replace(white.runs, model=augmented), process=tuple(map(gust_name, driven)),
                        start=np.column_stack([white.start, np.zeros((1, len(driven)))]),
                        start_variance=np.hstack([white.start_variance, spread]))  # fmt: skip
        squared, constants = 2.0 * squared / disturbance.memory, [disturbance.memory] * len(driven)
    else:
        squared = squared * SAMPLE_S
    common, free = estimate.common_parameters, len(problem.free)
    session_values = common[free:].copy()
    session_values[-1:] = disturbance.offset
    variances = [craft.sensors[o] ** 2 for o in problem.data.outputs]
    point = np.concatenate([common[:free], constants, session_values, squared, variances])
    normal = white.normal(point, NONE)
    exact = replace(white, steps=white.difference_steps(point, normal.hessian))
    at = Optimum(Solution(point, 0.0, Status.CONVERGED, 1), NONE, exact.normal(point, NONE))
    noise = ProcessNoise(exact, at, 0.0, None, estimate.problem)  # type: ignore[arg-type]
    return DisturbanceLimit(noise.interval.standard_error[:free], (newton_step(exact, point) - point)[:free])
