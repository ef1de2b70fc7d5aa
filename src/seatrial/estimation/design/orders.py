"""Orders: what the helmsman is to do every few seconds, and how the inputs respond."""

import numpy as np

from seatrial.core.results import Actuator, TimedOrder
from seatrial.core.values import Array, Record, RecordKind, frozen
from seatrial.estimation.design.task import DesignTask
from seatrial.physics.simulate.replay import record_of

# rounding of orders and of their times
_ORDER_TOLERANCE = 1e-9
# of a hold: what rounding may take from a time
_TIME_TOLERANCE = 1e-6


def order_counts(task: DesignTask) -> tuple[int, ...]:
    """Return how many orders each actuator gets in the trial."""
    return tuple(int(np.ceil(task.request.duration / a.hold - _ORDER_TOLERANCE)) for a in task.request.actuators)


def sample_count(task: DesignTask, dt: float) -> int:
    """Return samples of the trial at a step `dt` [s]."""
    return round(task.request.duration / dt) + 1


def actuator_response(actuator: Actuator, orders: Array, neutral: float, dt: float, count: int) -> Array:
    """Return what the actuator does, shape (count,): from neutral towards each order at its rate, held once there."""
    which = np.minimum((np.arange(count) * dt / actuator.hold + _ORDER_TOLERANCE).astype(int), len(orders) - 1)
    wanted = orders[which]
    if np.isinf(actuator.rate):
        return wanted
    step, now, positions = actuator.rate * dt, neutral, []
    for order in wanted.tolist():
        positions.append(now)
        now += min(max(order - now, -step), step)
    return np.array(positions)


def orders_at(task: DesignTask, point: Array) -> list[Array]:
    """A point as orders of each actuator, SI in the record's signs: 0 the lower end of its range, 1 the upper one.

    What lies beyond an end means that end.
    """
    pieces = np.split(np.clip(point, 0.0, 1.0), np.cumsum(order_counts(task))[:-1])
    return [a.lower + (a.upper - a.lower) * piece for a, piece in zip(task.request.actuators, pieces, strict=True)]


def input_series(task: DesignTask, orders: list[Array], dt: float) -> Array:
    """Return all inputs in the model's signs at a step `dt` [s], shape (rows, nu)."""
    count, neutral = sample_count(task, dt), task.neutral_positions
    inputs = np.tile(task.neutral_inputs, (count, 1))
    for actuator, wanted in zip(task.request.actuators, orders, strict=True):
        j = task.model.input_names.index(actuator.name)
        sign = -1.0 if task.model.inputs[j].is_reversed else 1.0
        inputs[:, j] = sign * actuator_response(actuator, wanted, neutral[actuator.name], dt, count)
    return inputs


def order_table(task: DesignTask, orders: list[Array]) -> tuple[TimedOrder, ...]:
    """Return the helmsman's table: a line whenever an order changes, all actuators in it."""
    actuators = task.request.actuators
    # digits of s, against rounding; chosen
    times = sorted({round(k * a.hold, 9) for a, n in zip(actuators, order_counts(task), strict=True) for k in range(n)})
    lines: list[TimedOrder] = []
    for time in times:
        values = {
            a.name: float(wanted[min(int(time / a.hold + _TIME_TOLERANCE), len(wanted) - 1)])
            for a, wanted in zip(task.request.actuators, orders, strict=True)
        }
        if not lines or any(abs(values[n] - lines[-1].values[n]) > _ORDER_TOLERANCE for n in values):
            lines.append(TimedOrder(time, values))
    return tuple(lines)


def planned_record(task: DesignTask, model_inputs: Array, dt: float) -> Record:
    time = frozen(dt * np.arange(len(model_inputs)))
    model = task.model
    empty = np.zeros((len(model_inputs), len(model.states)))
    whole = record_of(
        model, "plan", time, empty, np.zeros((len(model_inputs), len(model.outputs))), model_inputs, RecordKind.PLANNED
    )
    return whole.without(*model.states, *model.outputs)
