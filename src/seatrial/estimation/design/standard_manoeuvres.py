"""The standard manoeuvres a design is measured by: equal duration, the same inputs, ranges, rates and ships."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator, leaves_limits
from seatrial.estimation.design.orders import actuator_response, input_series, sample_count
from seatrial.estimation.design.task import FEWEST_ORDERS, DesignTask
from seatrial.physics.manoeuvres.programme import binary_sequence, programme
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import RUDDER
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre

# switching times as shares of the designed one's hold; amplitudes as shares of the range, the first that keeps within
SWITCHING_SHARES = (1.0 / 3.0, 2.0 / 3.0, 1.0, 4.0 / 3.0)
# shares of the actuators' range that binary sequences are tried with, largest first, ours
AMPLITUDES = (1.0, 0.85, 0.7, 0.55, 0.4, 0.25, 0.1)
# of the binary sequences
SEQUENCE_SEEDS = (0, 1)
# deg; 10/10 and 20/20 by IMO MSC.137(76), 30/30 ours
_ZIGZAG_ANGLES = (10.0, 20.0, 30.0)
# of angles and of counts of holds
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class StandardManoeuvre:
    """A standard manoeuvre; `inputs_for` gives its inputs for ships and step of an evaluator, in the model's signs.

    One course (rows, nu) for all ships, or one each (ships, rows, nu) where a helmsman steers them.
    """

    name: str
    inputs_for: Callable[[ManoeuvreEvaluator], Array]
    is_random: bool = False


def standard_manoeuvres(evaluator: ManoeuvreEvaluator) -> list[StandardManoeuvre]:
    """Return random binary sequences and, by the model, zigzags and turning circles, steps, or steps and a sweep."""
    task = evaluator.task
    drawn = (_largest_within_limits(evaluator, share, seed) for share in SWITCHING_SHARES for seed in SEQUENCE_SEEDS)
    sequences = list({one.name: one for one in drawn}.values())  # a short trial shortens all holds to one
    if task.model.equations.layout:
        return [*sequences, StandardManoeuvre("steps one by one", _single_step_inputs)]
    if not _is_steered(task):
        return [*sequences, StandardManoeuvre("sine sweep", _sweep_inputs), StandardManoeuvre("steps", _step_inputs)]
    steered = [StandardManoeuvre(text, partial(_steered_inputs, text)) for text in _programmes(task)]
    return [*sequences, *(r for r in steered if _can_be_steered(evaluator, r))]


def binary_sequence_inputs(hold: float, amplitude: float, seed: int, evaluator: ManoeuvreEvaluator) -> Array:
    """Every actuator between its ends, or `amplitude` of the way to them, by maximum length sequences of their own."""
    task, orders = evaluator.task, list[Array]()
    switched = replace(task, request=task.request.with_hold(hold))
    for j, actuator in enumerate(task.request.actuators):
        count = int(np.ceil(task.request.duration / hold - _ROUNDING))
        signs = np.sign(np.resize(binary_sequence(1.0, seed + 10 * j), count))
        orders.append(_mid_range(actuator) + signs * amplitude * 0.5 * (actuator.upper - actuator.lower))
    return input_series(switched, orders, evaluator.dt)


def _largest_within_limits(evaluator: ManoeuvreEvaluator, switching: float, seed: int) -> StandardManoeuvre:
    """Return the largest amplitude whose drift and distance keep within the limits; else the smallest tried."""
    task = evaluator.task
    hold = max(switching * task.shortest_hold, 2.0 / task.request.rate)
    hold = min(hold, task.request.duration / FEWEST_ORDERS)
    standard = StandardManoeuvre("", _step_inputs)
    for share in AMPLITUDES:
        standard = StandardManoeuvre(
            f"prbs:{100 * share:.0f}%:{hold:.3g} s:{seed}",
            partial(binary_sequence_inputs, hold, share, seed),
            is_random=True,
        )
        precision = evaluator.evaluate(standard.inputs_for(evaluator))
        if not leaves_limits(task, precision) and np.isfinite(precision.relative_errors).all():
            break
    return standard


def _mid_range(actuator: Actuator) -> float:
    return 0.5 * (actuator.lower + actuator.upper)


def _is_steered(task: DesignTask) -> bool:
    return "psi" in task.model.states and any(a.name == RUDDER for a in task.request.actuators)


def _programmes(task: DesignTask) -> list[str]:
    """Return zigzags that the rudder's range allows, compressed ones as long as fits, the hardest turning circle."""
    (rudder,) = [a for a in task.request.actuators if a.name == RUDDER]
    most = float(np.degrees(min(rudder.upper, -rudder.lower)))
    angles = [a for a in _ZIGZAG_ANGLES if a <= most + _ROUNDING]
    texts = [f"zigzag:{a:g}/{a:g}" for a in angles]
    if most >= _ZIGZAG_ANGLES[-1] - _ROUNDING:
        texts += ["consecutive-zigzags:1", "consecutive-zigzags:2"]
    return [*texts, f"turning-circle:{most:.4g}"] if most > 0.0 else texts


def _can_be_steered(evaluator: ManoeuvreEvaluator, standard: StandardManoeuvre) -> bool:
    """Return whether no ship is lost under the helmsman."""
    try:
        standard.inputs_for(evaluator)
    except InputError:
        return False
    return True


def _steered_inputs(text: str, evaluator: ManoeuvreEvaluator) -> Array:
    """Return each ship under the helmsman; after the last execute the rudder stays."""
    return np.stack([_simulate_steered(evaluator, row, text) for row in evaluator.ships.parameters])


def _simulate_steered(evaluator: ManoeuvreEvaluator, parameters: Array, text: str) -> Array:
    task, model = evaluator.task, evaluator.task.model
    ship = model.with_parameters(
        model.parameters.with_values(dict(zip(model.parameters.names, parameters, strict=True)))
    )
    (rudder,) = [a for a in task.request.actuators if a.name == RUDDER]
    step = 1.0 / task.request.rate
    other_inputs = {a.name: task.neutral_positions[a.name] for a in task.request.actuators if a.name != RUDDER}
    record = manoeuvre(
        ship,
        programme(text),
        dt=step,
        duration=task.request.duration,
        speed=float(task.initial_state[model.states.index("u")]) if "u" in model.states else task.request.speed,
        inputs={**task.request.held, **other_inputs},
        slew_rate=rudder.rate if np.isfinite(rudder.rate) else SOLAS_SLEW_RATE,
    )
    held = inputs_of(model, record)[:: round(evaluator.dt / step)]
    count = sample_count(task, evaluator.dt)
    return np.concatenate([held, np.repeat(held[-1:], max(0, count - len(held)), axis=0)])[:count]


def _sweep_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """All actuators swing between their ends, from one swing in the trial to one in four holds, evenly faster."""
    task, time = evaluator.task, evaluator.dt * np.arange(sample_count(evaluator.task, evaluator.dt))
    first, last = 1.0 / task.request.duration, 0.25 / task.shortest_hold
    return _drive_all(
        evaluator, np.sin(2.0 * np.pi * (first * time + 0.5 * (last - first) * time**2 / task.request.duration))
    )


def _step_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """Return steps from end to end, eight times."""
    time = evaluator.dt * np.arange(sample_count(evaluator.task, evaluator.dt))
    # eight steps, as said above
    return _drive_all(evaluator, np.where((8.0 * time / evaluator.task.request.duration).astype(int) % 2, 1.0, -1.0))


def _single_step_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """Return each actuator to its upper, then each to its lower end for a part of the trial, the rest in the middle."""
    count = len(evaluator.task.request.actuators)
    rows = sample_count(evaluator.task, evaluator.dt)
    step = (2 * count * np.arange(rows)) // rows
    return _drive(
        evaluator, np.where(step[:, None] % count == np.arange(count), np.where(step < count, 1.0, -1.0)[:, None], 0.0)
    )


def _drive_all(evaluator: ManoeuvreEvaluator, course: Array) -> Array:
    """Return every actuator along a course (rows,) between -1 and 1, at its own rate."""
    return _drive(evaluator, np.tile(course[:, None], (1, len(evaluator.task.request.actuators))))


def _drive(evaluator: ManoeuvreEvaluator, courses: Array) -> Array:
    """Return each actuator along its course between -1 and 1, (rows, actuators), at its own rate."""
    task, dt = evaluator.task, evaluator.dt
    inputs = np.tile(task.neutral_inputs, (len(courses), 1))
    for a, course in zip(task.request.actuators, courses.T, strict=True):
        j = task.model.input_names.index(a.name)
        free = replace(a, hold=dt)
        wanted = actuator_response(
            free, _mid_range(a) + 0.5 * (a.upper - a.lower) * course, task.neutral_positions[a.name], dt, len(course)
        )
        inputs[:, j] = -wanted if task.model.inputs[j].is_reversed else wanted
    return inputs
