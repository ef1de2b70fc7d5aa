"""Orders: what is told the helmsman every few seconds, and what the inputs then do."""

import numpy as np

from seatrial.core.results import Actuator, Order
from seatrial.core.values import Array, Kind, Record, frozen
from seatrial.estimation.design.task import Task
from seatrial.physics.simulate.channels import record_of

_SAME = 1e-9
# of a hold: what rounding may take from a time
_LATE = 1e-6


def counts(task: Task) -> tuple[int, ...]:
    """How many orders each actuator gets in the trial."""
    return tuple(int(np.ceil(task.duration / a.hold - _SAME)) for a in task.actuators)


def rows(task: Task, dt: float) -> int:
    """Samples of the trial at a step `dt` [s]."""
    return round(task.duration / dt) + 1


def followed(actuator: Actuator, orders: Array, neutral: float, dt: float, count: int) -> Array:
    """What the actuator does, shape (count,): from neutral towards each order at its rate, held once there."""
    which = np.minimum((np.arange(count) * dt / actuator.hold + _SAME).astype(int), len(orders) - 1)
    wanted = orders[which]
    if np.isinf(actuator.rate):
        return wanted
    step, now, made = actuator.rate * dt, neutral, []
    for order in wanted.tolist():
        made.append(now)
        now += min(max(order - now, -step), step)
    return np.array(made)


def split(task: Task, point: Array) -> list[Array]:
    """A point as orders of each actuator, SI in the record's signs: 0 the lower end of its range, 1 the upper one.

    What lies beyond an end means that end.
    """
    pieces = np.split(np.clip(point, 0.0, 1.0), np.cumsum(counts(task))[:-1])
    return [a.lower + (a.upper - a.lower) * piece for a, piece in zip(task.actuators, pieces, strict=True)]


def inputs(task: Task, orders: list[Array], dt: float) -> Array:
    """All inputs in the model's signs at a step `dt` [s], shape (rows, nu)."""
    count, neutral = rows(task, dt), task.neutral
    made = np.tile(task.quiet, (count, 1))
    for actuator, wanted in zip(task.actuators, orders, strict=True):
        j = task.model.input_names.index(actuator.name)
        sign = -1.0 if task.model.inputs[j].is_turned else 1.0
        made[:, j] = sign * followed(actuator, wanted, neutral[actuator.name], dt, count)
    return made


def table(task: Task, orders: list[Array]) -> tuple[Order, ...]:
    """The helmsman's table: a line whenever an order changes, all actuators in it."""
    times = sorted({round(k * a.hold, 9) for a, n in zip(task.actuators, counts(task), strict=True) for k in range(n)})
    lines: list[Order] = []
    for time in times:
        values = {
            a.name: float(wanted[min(int(time / a.hold + _LATE), len(wanted) - 1)])
            for a, wanted in zip(task.actuators, orders, strict=True)
        }
        if not lines or any(abs(values[n] - lines[-1].values[n]) > _SAME for n in values):
            lines.append(Order(time, values))
    return tuple(lines)


def plan(task: Task, made: Array, dt: float) -> Record:
    time = frozen(dt * np.arange(len(made)))
    model = task.model
    empty = np.zeros((len(made), len(model.states)))
    whole = record_of(model, "plan", time, empty, np.zeros((len(made), len(model.outputs))), made, Kind.PLANNED)
    return whole.without(*model.states, *model.outputs)
