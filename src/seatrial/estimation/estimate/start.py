"""Where a search begins: without a guess, by the weak form of the equations; else at the model's own values."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.estimate.integration_steps import with_steps_of_start
from seatrial.estimation.estimate.point_estimate import residual_spread
from seatrial.estimation.estimate.time_scale import dominant_period, is_pure_roll
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.regress.weak import WeakForm
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.candidate_structures import course_unstable
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import hidden_states, measured_states

RESTORING = "c_1"
"""Of a model of roll: the square of its natural frequency at small angles."""


@dataclass(frozen=True, eq=False)
class SearchStart:
    """Unknowns from which to search, the problem with the noise they leave, and where they come from in words."""

    problem: OutputError
    common_parameters: Array
    initial_states: Array
    origin: str


def find_start(problem: OutputError, records: Sequence[Record], seconds: float) -> SearchStart:
    """Coefficients by the weak form with windows of half width `seconds`, initial states as measured.

    The model's own values take their place where a state is hidden, or where the weak form's diverge; the period of the
    records does where it explains more of a roll.
    """
    local = problem.measured_initial_states()
    hidden, origin = hidden_states(problem.model, records), "weak form of the equations, no guess"
    if hidden:
        origin = f"the model's own values: nobody measures {', '.join(hidden)}, a state of the weak form"
    shared = _with_coefficients(problem, weak_form_start(problem.model, records, seconds))
    problem = with_steps_of_start(problem, shared, local)
    simulated = problem.simulated_outputs(shared, local)
    if not np.all(np.isfinite(simulated)):
        shared, origin = problem.start(), "the model's own values: those of the weak form diverge"
        problem = with_steps_of_start(problem, shared, local)
        simulated = problem.simulated_outputs(shared, local)
    if is_pure_roll(problem.model):
        swinging = _with_period(problem, records)
        if not problem.cost(swinging, local) >= problem.cost(shared, local):
            shared, origin = swinging, "the period of the records, as the weak form explains less"
            simulated = problem.simulated_outputs(shared, local)
    if np.all(np.isfinite(simulated)):
        left = simulated - problem.data.measured
        problem = replace(problem, noise=residual_spread(replace(problem, huber=1.0), left))
    return SearchStart(problem, shared, local, origin)


def _with_coefficients(problem: OutputError, point: Array) -> Array:
    shared = problem.start()
    names = problem.model.parameters.free_names
    shared[: len(problem.free)] = [point[names.index(n)] for n in problem.free]
    return shared


def _with_period(problem: OutputError, records: Sequence[Record]) -> Array:
    """Return the model's own values with the restoring of the records' median period, (2 pi / T)^2."""
    shared, roll = problem.start(), problem.model.states[0]
    if RESTORING in problem.free:
        period = float(np.median([dominant_period(record[roll], record.dt) for record in records]))
        shared[problem.free.index(RESTORING)] = (2.0 * np.pi / period) ** 2
    return shared


def weak_form_start(model: Model, records: Sequence[Record], seconds: float, rounds: int = 3) -> Array:
    """Free parameters from the weak form over all records, shape (free,); priors pull as far as the data leave room.

    Equations of states that stay constant in a record (positions nobody measured) are left out. A model with hidden
    states starts at its own values.
    """
    point = np.array([p.value for p in model.parameters.free])
    if hidden_states(model, records):
        return point
    states = tuple(measured_states(model, r) for r in records)
    inputs = tuple(inputs_of(model, r) for r in records)
    problem = WeakForm(model, states, inputs, records[0].dt, seconds, np.ones(len(model.states)))
    found, misfit = _solved(problem, point, rounds)
    if (unstable := course_unstable(model)) is not model:
        # a search does not pass through the infinite time constant between a stable and an unstable ship
        other, left = _solved(problem, np.array([p.value for p in unstable.parameters.free]), rounds)
        found = other if left < misfit else found
    return found


def _solved(problem: WeakForm, point: Array, rounds: int) -> tuple[Array, float]:
    """Return the weak form's solution from a point, and the sum of the logarithms of what it leaves of each rate."""
    states, point = problem.states, np.clip(point, problem.lower, problem.upper)
    is_varying = np.all([np.ptp(x, axis=0) > 0 for x in states], axis=0)
    floor = 1e-9 * np.max(np.abs(np.concatenate(states)), axis=0)  # share of the largest value that is rounding; chosen

    def spread(values: Array) -> Array:
        return np.maximum(np.sqrt(np.mean(problem.linearised(values)[0] ** 2, axis=0)), floor)

    for _ in range(rounds):
        problem = replace(problem, residual_sd=np.where(is_varying, spread(point), np.inf))
        # of the weak form, at most; chosen
        point = levenberg_marquardt(problem, point, np.zeros((0, 0)), evaluations=30).solution.point
    return point, float(np.sum(np.log(spread(point)[is_varying])))
