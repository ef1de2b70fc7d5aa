"""A design tried on simulated trials: noisy records of ships the prior allows, fitted by output error."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Confirmation
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.ships import PriorShips
from seatrial.estimation.design.task import DesignTask
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Solution, levenberg_marquardt
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.replay import replay

# half width of the windows of the weak form over the shortest hold, ours
WINDOW_PER_HOLD = 1.5
# of the criterion: a move of some 1e-4 standard errors
NEGLIGIBLE_DECREASE = 1e-8
# standard deviations above the mean of chi squared, beyond which a fit is taken to be a wrong one; chosen
NOISE_DEVIATIONS = 5.0


def confirm_design(
    task: DesignTask,
    model_inputs: Array,
    planned: Record,
    ships: PriorShips,
    seed: int,
    report_progress: Callable[[str], None],
) -> Confirmation:
    """Return one noisy record and one fit for every ship; `model_inputs` are the plan's inputs at the sensors' rate."""
    predicted = ManoeuvreEvaluator(task, ships, 1.0 / task.request.rate).evaluate(model_inputs).relative_errors
    streams = np.random.SeedSequence(seed).spawn(ships.count)

    def fitted(number: int) -> Solution | None:
        ship = _model_with_values(task.model, ships.parameters[number])
        record = _simulate_trial(task, ship, planned, np.random.default_rng(streams[number]))
        return None if record is None else _fit_record(task, record)

    report_progress(f"confirming: {ships.count} simulated trials")
    results = map_in_threads(fitted, list(range(ships.count)))
    places = [task.model.parameters.index(n) for n in task.model.parameters.free_names]
    scale = np.array([p.characteristic_scale for p in task.model.parameters.free])
    errors, bounds = [], []
    for number, result in enumerate(results):
        if result is not None and result.status.is_success:
            true = ships.parameters[number, places]
            # smaller values count by their scale; chosen
            errors.append((result.point - true) / np.where(np.abs(true) > 1e-3 * scale, np.abs(true), scale))
            bounds.append(predicted[number])
    none = np.full((1, len(places)), np.nan)
    return Confirmation(ships.count, len(errors), _rms(errors or none), _rms(bounds or none))


def _fit_record(task: DesignTask, record: Record) -> Solution:
    """Return the fit from the weak form's start; where it leaves more than noise, the better of it and another start.

    The other start is the model's own values.
    """
    outputs = tuple(task.sensors)
    problem = OutputError(
        task.model, cut_segments(task.model, [record], outputs, None), np.array(list(task.sensors.values())), workers=1
    )
    local = np.array([[task.initial_state[task.model.states.index(s)] for s in problem.starts]])
    count = len(record) * len(outputs)
    # half of chi squared, whose mean is its degrees of freedom, and its variance twice these
    noise = 0.5 * (count + NOISE_DEVIATIONS * math.sqrt(2.0 * count))
    solutions: list[Solution] = []
    for shared in (*_weak_form_start(task, problem, record), problem.start()):
        solutions.append(levenberg_marquardt(problem, shared, local, negligible=NEGLIGIBLE_DECREASE).solution)
        if solutions[-1].status.is_success and solutions[-1].value <= noise:
            break
    return min(solutions, key=lambda solution: solution.value)


def _weak_form_start(task: DesignTask, problem: OutputError, record: Record) -> list[Array]:
    """Return the weak form's start; none where the sensors do not show every state."""
    try:
        return [find_start(problem, [record], WINDOW_PER_HOLD * task.shortest_hold).common_parameters]
    except InputError:
        return []


def _model_with_values(model: Model, values: Array) -> Model:
    return model.with_values(dict(zip(model.parameters.names, values.tolist(), strict=True)))


def _simulate_trial(task: DesignTask, ship: Model, planned: Record, generator: np.random.Generator) -> Record | None:
    """Return sensors and inputs of a ship that follows the plan; None where the simulation diverges."""
    start = dict(zip(ship.states, task.initial_state.tolist(), strict=True))
    try:
        simulated = replay(ship, planned, start)
    except InputError:
        return None
    channels = {name: simulated.channel(name) for name in ship.input_names}
    for name, deviation in task.sensors.items():
        channel = simulated.channel(name)
        channels[name] = channel.with_values(channel.values + deviation * generator.standard_normal(len(simulated)))
    return replace(simulated, channels=channels)


def _rms(values: "list[Array] | Array") -> Array:
    return np.sqrt(np.mean(np.square(values), axis=0))
