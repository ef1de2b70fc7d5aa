"""Information of a manoeuvre: orders, Cramer-Rao bounds of the coefficients for many ships at once."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.results import Actuator, ManoeuvrePrecision, TimedOrder
from seatrial.core.values import Array, Index, Record, RecordKind, frozen
from seatrial.estimation.design.task import DesignTask, PriorShips, coefficient_magnitudes
from seatrial.physics.simulate.batch import SegmentBatch, batch_class
from seatrial.physics.simulate.replay import record_of, replay

# Orders: what the helmsman is to do every few seconds, and how the inputs respond.

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
        remaining = order - now
        now += step if remaining > step else -step if remaining < -step else remaining
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


# Information of a manoeuvre: Cramer-Rao bounds of the coefficients for many ships at once, and their tracks.

_TRACK_CHANNELS = ("u", "v", "x0", "y0")
# ridge on the information matrix of unit diagonal: the size of rounding
_REGULARISATION = 1e-13
# slopes that are worked out at a time, 1 MB of float64, so that they stay in the processor's cache; chosen
_CACHED_NUMBERS = 2**17


@dataclass(frozen=True, eq=False)
class ManoeuvreInformation:
    """Relative standard errors (ships, k), NaN rows where a simulation diverges; largest drift [rad] and distance [m].

    drift, distance: shape (ships,); zero for models without sway or position, the drift of craft with thrusters NaN:
    they turn on the spot and go astern.
    """

    relative_errors: Array
    drift: Array
    distance: Array


@dataclass(frozen=True, eq=False)
class ManoeuvreEvaluator:
    """Ships under test at a step `dt` [s]; information is that of the sensors' own rate."""

    task: DesignTask
    ships: PriorShips
    dt: float

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """The sensors first, then what drift and distance need besides."""
        model = self.task.model
        return (*self.task.sensors, *(n for n in _TRACK_CHANNELS if n in model.states and n not in self.task.sensors))

    @cached_property
    def _offsets(self) -> Index:
        return np.arange(self.ships.count + 1, dtype=np.int64) * sample_count(self.task, self.dt)

    @cached_property
    def _initial_states(self) -> Array:
        return np.tile(self.task.initial_state, (self.ships.count, 1))

    @cached_property
    def _magnitudes(self) -> Array:
        return coefficient_magnitudes(self.task, self.ships.parameters)

    @cached_property
    def _weights(self) -> Array:
        """1 / standard deviation of each sensor's noise, once for each column of its slopes."""
        return np.repeat(1.0 / np.array(list(self.task.sensors.values())), self._batch_without_inputs.column_count)

    @cached_property
    def _batch_without_inputs(self) -> SegmentBatch:
        model = self.task.model
        nothing = np.zeros((int(self._offsets[-1]), len(model.inputs)))
        batch = batch_class(model)(
            model, nothing, self._offsets, self.dt, self.outputs, model.parameters.free_names, (), ()
        )
        offsets = batch.offset_states()
        return replace(batch, initial_states=tuple(s for s in batch.influential_states() if s not in offsets))

    @cached_property
    def _offset_sensors(self) -> list[int]:
        """Places of the sensors of states whose unknown initial value is an offset of that sensor and no more."""
        offsets = self._batch_without_inputs.offset_states()
        return [place for place, name in enumerate(self.task.sensors) if name in offsets]

    def evaluate(self, model_inputs: Array) -> ManoeuvreInformation:
        """Return the precision from inputs (rows, nu), or (ships, rows, nu) for one each, in the model's signs."""
        count, width = self.ships.count, len(self.task.model.inputs)
        each = np.broadcast_to(model_inputs, (count, *model_inputs.shape[-2:])).reshape(-1, width)
        batch = replace(self._batch_without_inputs, inputs=np.array(each))
        slopes = len(each) // count * len(self.outputs) * batch.column_count
        width = max(1, _CACHED_NUMBERS // slopes)
        blocks = [self._of_ships(batch, first, min(first + width, count)) for first in range(0, count, width)]
        y, information = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
        lost = np.any(~np.isfinite(y), axis=(1, 2))
        errors = _standard_errors(information)[:, : len(self.task.model.parameters.free)] / self._magnitudes
        relative = np.where(lost[:, None], np.nan, errors)
        return ManoeuvreInformation(relative, *self._drift_and_distance(np.where(lost[:, None, None], 0.0, y)))

    def _of_ships(self, batch: SegmentBatch, first: int, last: int) -> tuple[Array, Array]:
        """Return outputs (ships, rows, ny), not finite where one is lost, and the information of the sensors' records.

        As many ships at a time as leave their slopes in the processor's cache.
        """
        y, slopes, failed = batch.differentiate(
            first, last, self._initial_states, self.ships.parameters, np.zeros((self.ships.count, 0))
        )
        y, slopes = (part.reshape(last - first, -1, *part.shape[1:]) for part in (y, slopes))
        lost = (failed >= 0) | ~np.isfinite(y).all(axis=(1, 2))
        y[lost], slopes[lost] = np.nan, 0.0
        return y, self._information(slopes[:, :, : len(self.task.sensors)])

    def _information(self, slopes: Array) -> Array:
        """Return the information (ships, n, n) of slopes (ships, rows, sensors, n), which may be overwritten."""
        (ships, rows, seen, n), k = slopes.shape, len(self.ships.precision)
        scaled = slopes.reshape(ships, rows, seen * n)
        scaled *= self._weights
        # an unknown offset takes from a sensor's slopes their mean (Frisch & Waugh 1933, Econometrica 1(4), 387-401)
        sums = (np.ones(rows) @ scaled).reshape(ships, seen, n)[:, self._offset_sensors]
        information = _products(scaled.reshape(ships, rows * seen, n)) - _products(sums) / rows
        information *= self.task.request.rate * self.dt
        information[:, range(k), range(k)] += self.ships.precision
        return information

    def _drift_and_distance(self, y: Array) -> tuple[Array, Array]:
        at = {name: y[:, :, self.outputs.index(name)] for name in _TRACK_CHANNELS if name in self.outputs}
        none = np.zeros(len(y))
        drift = np.abs(np.arctan2(at["v"], at["u"])).max(axis=1) if {"u", "v"} <= set(at) else none
        if self.task.model.has_thrusters:
            drift = np.full(len(y), np.nan)
        room = np.hypot(at["x0"], at["y0"]).max(axis=1) if {"x0", "y0"} <= set(at) else none
        return drift, room


def limit_excess(task: DesignTask, information: ManoeuvreInformation, margin: float = 0.0) -> Array:
    """Return how far drift and distance of each ship leave the limits less a margin, in parts of these, (ships,)."""
    allowed = 1.0 - margin
    over = [
        np.nan_to_num(information.drift) / (allowed * task.request.limits.drift) - 1.0,
        information.distance / (allowed * task.request.limits.sea_room) - 1.0,
    ]
    return np.maximum(over, 0.0).sum(axis=0)


def leaves_limits(task: DesignTask, information: ManoeuvreInformation) -> bool:
    """Return whether a ship that the limits bind leaves them; the first ship is the one assumed."""
    over = limit_excess(task, information)
    return bool(over.max() > 0.0 if task.request.limits.for_every_ship else over[0] > 0.0)


def assess_manoeuvre(
    name: str, evaluator: ManoeuvreEvaluator, model_inputs: Array, executed: Record
) -> ManoeuvrePrecision:
    """Return a manoeuvre's worth for all ships of the bench, the model itself first."""
    precision = evaluator.evaluate(model_inputs)
    nominal = float(precision.drift[0]), float(precision.distance[0])
    return ManoeuvrePrecision(
        name,
        precision.relative_errors[0],
        precision.relative_errors[1:],
        *nominal,
        precision.drift[1:],
        precision.distance[1:],
        executed,
    )


def simulate_plan(task: DesignTask, planned: Record, name: str) -> Record:
    """Return the model driven by a planned record from the task's start."""
    start = dict(zip(task.model.states, task.initial_state.tolist(), strict=True))
    return replay(task.model, planned, start).renamed(name)


def _products(slopes: Array) -> Array:
    """Return J^T J of each ship's slopes J (ships, rows, n)."""
    return np.matmul(slopes.transpose(0, 2, 1), slopes)


def _standard_errors(information: Array) -> Array:
    """Return standard errors (ships, n) of all unknowns; huge for those that nothing determines."""
    scale = np.sqrt(np.diagonal(information, axis1=1, axis2=2))
    is_informative = scale > 0.0
    size, unity = np.where(is_informative, scale, 1.0), np.eye(scale.shape[1])
    unit = information / (size[:, :, None] * size[:, None, :]) + unity * (~is_informative)[:, None, :]
    inverse = np.linalg.inv(unit + _REGULARISATION * unity)
    variance = np.where(is_informative, np.abs(np.diagonal(inverse, axis1=1, axis2=2)) / size**2, np.inf)
    return np.sqrt(np.minimum(variance, 1e30))  # a finite number for what is not identified; chosen
